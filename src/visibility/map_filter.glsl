// How much of a depth map's filter is lit. `size`: texels of a side; `uvz`: place in the map, [0, 1]², and
// reversed depth of what is looked up; it is lit by a texel that is not nearer to the light.

#ifndef GNOMON_VISIBILITY_MAP_FILTER_GLSL
#define GNOMON_VISIBILITY_MAP_FILTER_GLSL

#include "visibility/map_lookup.shared.h"

float lit_nearest(sampler2DArray map, float size, vec3 uvz, float layer) {
    vec2 texel = clamp(floor(uvz.xy * size), 0.0, size - 1.0);
    return uvz.z >= texelFetch(map, ivec3(vec3(texel, layer)), 0).x ? 1.0 : 0.0;
}

float lit_hardware_2x2(sampler2DArrayShadow map, vec3 uvz, float layer) {
    return texture(map, vec4(uvz.xy, layer, uvz.z));
}

// Four bilinear comparisons side by side, which are the 3x3 nearest ones with weights 1-f, 1, f.
float lit_box_3x3(sampler2DArrayShadow map, float size, vec3 uvz, float layer) {
    vec2 corner = uvz.xy * size;
    vec2 f = fract(corner);
    vec2 uv = floor(corner) / size;  // corner left above of the receiver's texel
    vec2 step_uv = vec2(1.0 / size);
    vec4 a = textureGather(map, vec3(uv, layer), uvz.z);
    vec4 b = textureGather(map, vec3(uv + vec2(step_uv.x, 0.0), layer), uvz.z);
    vec4 c = textureGather(map, vec3(uv + vec2(0.0, step_uv.y), layer), uvz.z);
    vec4 d = textureGather(map, vec3(uv + step_uv, layer), uvz.z);
    // A gather gives (left, below), (right, below), (right, above), (left, above).
    vec3 wx = vec3(1.0 - f.x, 1.0, f.x);
    float row0 = dot(wx, vec3(a.w, a.z, b.z));
    float row1 = dot(wx, vec3(a.x, a.y, b.y));
    float row2 = dot(wx, vec3(c.x, c.y, d.y));
    return ((1.0 - f.y) * row0 + row1 + f.y * row2) / 4.0;
}

// Nine bilinear comparisons side by side, which are the 4x4 nearest ones with weights 1-f, 1, 1, f:
// 16 taps in four gathers, without a step where the receiver moves to the next texel.
float lit_box_4x4(sampler2DArrayShadow map, float size, vec3 uvz, float layer) {
    vec2 corner = uvz.xy * size - 0.5;
    vec2 f = fract(corner);
    vec2 uv = (floor(corner) + 0.5) / size;  // centre of the texel left above of the receiver
    float step_uv = 1.0 / size;
    vec4 a = textureGather(map, vec3(uv + vec2(-0.5, -0.5) * step_uv, layer), uvz.z);
    vec4 b = textureGather(map, vec3(uv + vec2(1.5, -0.5) * step_uv, layer), uvz.z);
    vec4 c = textureGather(map, vec3(uv + vec2(-0.5, 1.5) * step_uv, layer), uvz.z);
    vec4 d = textureGather(map, vec3(uv + vec2(1.5, 1.5) * step_uv, layer), uvz.z);
    vec4 wx = vec4(1.0 - f.x, 1.0, 1.0, f.x);
    float row0 = dot(wx, vec4(a.w, a.z, b.w, b.z));
    float row1 = dot(wx, vec4(a.x, a.y, b.x, b.y));
    float row2 = dot(wx, vec4(c.w, c.z, d.w, d.z));
    float row3 = dot(wx, vec4(c.x, c.y, d.x, d.y));
    return ((1.0 - f.y) * row0 + row1 + row2 + f.y * row3) / 9.0;
}

// Four of the sixteen taps, the others by turns in squares of four pixels, so that the eye averages them.
// M. Bunnell, F. Pellacini, "Shadow Map Antialiasing", GPU Gems 2004, chapter 11.
float lit_dithered_4(sampler2DArrayShadow map, float size, vec3 uvz, float layer, uvec2 pixel) {
    uvec2 turn = pixel & 1u;
    turn.y ^= turn.x;
    vec2 first = uvz.xy + (vec2(turn) - 1.5) / size;
    float step_uv = 2.0 / size;
    float lit = texture(map, vec4(first, layer, uvz.z));
    lit += texture(map, vec4(first + vec2(step_uv, 0.0), layer, uvz.z));
    lit += texture(map, vec4(first + vec2(0.0, step_uv), layer, uvz.z));
    lit += texture(map, vec4(first + step_uv, layer, uvz.z));
    return 0.25 * lit;
}

#endif
