// How much of a depth map's filter is lit. Each texel is compared with the receiver's own plane at that
// texel's centre, where the plane's stored depth is just that, so that a plane needs no bias however wide
// the filter. G. King, "Shadow Mapping Algorithms", NVIDIA 2004; J. Isidoro, "Shadow Mapping: GPU-based Tips
// and Techniques", GDC 2006, for receiver planes; here at texel centres, from the exact normal.

#ifndef GNOMON_VISIBILITY_MAP_FILTER_GLSL
#define GNOMON_VISIBILITY_MAP_FILTER_GLSL

#include "visibility/map_lookup.shared.h"

// A plane's depths are kept between what is no caster and what is clamped to the near plane: neither hides
// nor lights a receiver for being extended or biased beyond.
const float kNearest = 1.0 - 1.0 / 1048576.0;

// What is looked up, in texels of a layer.
struct MapPoint {
    vec2 texel;     // texel i reaches from i to i + 1
    float depth;    // reversed; a texel that is nearer to the light hides it
    vec2 gradient;  // of the receiver's plane, depth per texel
    float layer;
};

// Which texels of the square with the corner (i, j) are lit: (i, j+1), (i+1, j+1), (i+1, j), (i, j), the
// order of a gather.
vec4 lit_quad(sampler2DArray map, float size, MapPoint point, vec2 corner) {
    vec4 depths = textureGather(map, vec3((corner + 1.0) / size, point.layer));
    float first = point.depth + dot(point.gradient, corner + 0.5 - point.texel);
    vec4 planes = first + vec4(point.gradient.y, point.gradient.x + point.gradient.y,
                               point.gradient.x, 0.0);
    return vec4(greaterThanEqual(clamp(planes, 0.0, kNearest), depths));
}

float lit_nearest(sampler2DArray map, float size, MapPoint point) {
    vec2 texel = clamp(floor(point.texel), 0.0, size - 1.0);
    float depth = texelFetch(map, ivec3(vec3(texel, point.layer)), 0).x;
    float plane = point.depth + dot(point.gradient, texel + 0.5 - point.texel);
    return clamp(plane, 0.0, kNearest) >= depth ? 1.0 : 0.0;
}

float lit_bilinear(sampler2DArray map, float size, MapPoint point, vec2 at) {
    vec2 corner = floor(at - 0.5);
    vec2 f = at - 0.5 - corner;
    vec4 lit = lit_quad(map, size, point, corner);
    return mix(mix(lit.w, lit.z, f.x), mix(lit.x, lit.y, f.x), f.y);
}

// Four bilinear comparisons side by side, which are the 3x3 nearest ones with weights 1-f, 1, f.
float lit_box_3x3(sampler2DArray map, float size, MapPoint point) {
    vec2 corner = floor(point.texel) - 1.0;
    vec2 f = point.texel - corner - 1.0;
    vec4 a = lit_quad(map, size, point, corner);
    vec4 b = lit_quad(map, size, point, corner + vec2(2.0, 0.0));
    vec4 c = lit_quad(map, size, point, corner + vec2(0.0, 2.0));
    vec4 d = lit_quad(map, size, point, corner + 2.0);
    vec3 wx = vec3(1.0 - f.x, 1.0, f.x);
    float row0 = dot(wx, vec3(a.w, a.z, b.w));
    float row1 = dot(wx, vec3(a.x, a.y, b.x));
    float row2 = dot(wx, vec3(c.w, c.z, d.w));
    return ((1.0 - f.y) * row0 + row1 + f.y * row2) / 4.0;
}

// Nine bilinear comparisons side by side, which are the 4x4 nearest ones with weights 1-f, 1, 1, f, without a
// step where the receiver moves to the next texel.
float lit_box_4x4(sampler2DArray map, float size, MapPoint point) {
    vec2 corner = floor(point.texel - 0.5) - 1.0;
    vec2 f = point.texel - corner - 1.5;
    vec4 a = lit_quad(map, size, point, corner);
    vec4 b = lit_quad(map, size, point, corner + vec2(2.0, 0.0));
    vec4 c = lit_quad(map, size, point, corner + vec2(0.0, 2.0));
    vec4 d = lit_quad(map, size, point, corner + 2.0);
    vec4 wx = vec4(1.0 - f.x, 1.0, 1.0, f.x);
    float row0 = dot(wx, vec4(a.w, a.z, b.w, b.z));
    float row1 = dot(wx, vec4(a.x, a.y, b.x, b.y));
    float row2 = dot(wx, vec4(c.w, c.z, d.w, d.z));
    float row3 = dot(wx, vec4(c.x, c.y, d.x, d.y));
    return ((1.0 - f.y) * row0 + row1 + row2 + f.y * row3) / 9.0;
}

// Four of the sixteen taps, the others by turns in squares of four pixels, so that the eye averages them.
// M. Bunnell, F. Pellacini, "Shadow Map Antialiasing", GPU Gems 2004, chapter 11.
float lit_dithered_4(sampler2DArray map, float size, MapPoint point, uvec2 pixel) {
    uvec2 turn = pixel & 1u;
    turn.y ^= turn.x;
    vec2 first = point.texel + vec2(turn) - 1.5;
    float lit = lit_bilinear(map, size, point, first);
    lit += lit_bilinear(map, size, point, first + vec2(2.0, 0.0));
    lit += lit_bilinear(map, size, point, first + vec2(0.0, 2.0));
    lit += lit_bilinear(map, size, point, first + 2.0);
    return 0.25 * lit;
}

#endif
