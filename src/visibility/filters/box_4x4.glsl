// Nine bilinear comparisons side by side, which are the 4x4 nearest ones with weights 1-f, 1, 1, f, without a
// step where the receiver moves to the next texel.

#ifndef GNOMON_VISIBILITY_FILTERS_BOX_4X4_GLSL
#define GNOMON_VISIBILITY_FILTERS_BOX_4X4_GLSL

#include "visibility/map_filter.glsl"

float lit_box_4x4(sampler2DArray map, float size, MapBias bias, MapPoint point) {
    vec2 corner = floor(point.texel - 0.5) - 1.0;
    vec2 f = point.texel - corner - 1.5;
    vec4 a = stored_quad(map, size, point, corner);
    vec4 b = stored_quad(map, size, point, corner + vec2(2.0, 0.0));
    vec4 c = stored_quad(map, size, point, corner + vec2(0.0, 2.0));
    vec4 d = stored_quad(map, size, point, corner + 2.0);
    vec4 middle = vec4(c.z, d.w, b.x, a.y);
    point = ended(point, size, chosen(middle, lessThan(point.gradient, vec2(0.0))));
    a = lit_quad(a, size, bias, point, corner);
    b = lit_quad(b, size, bias, point, corner + vec2(2.0, 0.0));
    c = lit_quad(c, size, bias, point, corner + vec2(0.0, 2.0));
    d = lit_quad(d, size, bias, point, corner + 2.0);
    vec4 wx = vec4(1.0 - f.x, 1.0, 1.0, f.x);
    float row0 = dot(wx, vec4(a.w, a.z, b.w, b.z));
    float row1 = dot(wx, vec4(a.x, a.y, b.x, b.y));
    float row2 = dot(wx, vec4(c.w, c.z, d.w, d.z));
    float row3 = dot(wx, vec4(c.x, c.y, d.x, d.y));
    return ((1.0 - f.y) * row0 + row1 + row2 + f.y * row3) / 9.0;
}

#endif
