// Four bilinear comparisons side by side, which are the 3x3 nearest ones with weights 1-f, 1, f.

#ifndef GNOMON_VISIBILITY_FILTERS_BOX_3X3_GLSL
#define GNOMON_VISIBILITY_FILTERS_BOX_3X3_GLSL

#include "visibility/map_filter.glsl"

float lit_box_3x3(sampler2DArray map, float size, MapBias bias, MapPoint point) {
    vec2 corner = floor(point.texel) - 1.0;
    vec2 f = point.texel - corner - 1.0;
    vec4 a = stored_quad(map, size, point, corner);
    vec4 b = stored_quad(map, size, point, corner + vec2(2.0, 0.0));
    vec4 c = stored_quad(map, size, point, corner + vec2(0.0, 2.0));
    vec4 d = stored_quad(map, size, point, corner + 2.0);
    vec2 fallen = fallen_texel(point) - corner;
    bvec2 last = greaterThan(fallen, vec2(1.5));
    vec4 quad = last.y ? (last.x ? d : c) : (last.x ? b : a);
    point = ended(point, size, chosen(quad, equal(fallen, vec2(1.0))));
    a = lit_quad(a, size, bias, point, corner);
    b = lit_quad(b, size, bias, point, corner + vec2(2.0, 0.0));
    c = lit_quad(c, size, bias, point, corner + vec2(0.0, 2.0));
    d = lit_quad(d, size, bias, point, corner + 2.0);
    vec3 wx = vec3(1.0 - f.x, 1.0, f.x);
    float row0 = dot(wx, vec3(a.w, a.z, b.w));
    float row1 = dot(wx, vec3(a.x, a.y, b.x));
    float row2 = dot(wx, vec3(c.w, c.z, d.w));
    return ((1.0 - f.y) * row0 + row1 + f.y * row2) / 4.0;
}

#endif
