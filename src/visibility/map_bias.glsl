// Where a receiver is looked up: moved off its surface and towards the light, by what the texels of its
// own plane demand over the filter's reach, so that they never hide it. D. Holbert, "Saying Goodbye to
// Shadow Acne", GDC 2011, for the normal offset; S. Kozlov, "Perspective Shadow Maps: Care and Feeding",
// GPU Gems 2004, chapter 14, for a bias in the world that follows the texel. Departure: what a plane
// demands is computed exactly from the map's matrix, for any projection.

#ifndef GNOMON_VISIBILITY_MAP_BIAS_GLSL
#define GNOMON_VISIBILITY_MAP_BIAS_GLSL

#include "visibility/map_lookup.shared.h"

// A surface at 84° to the light; steeper ones are biased as this one.
const float kMaxSlope = 10.0;

struct TexelAt {
    float side_m;    // across the light, the longer one
    float offset_m;  // along the normal, that gains the depth that the plane gains over one texel
};

// Of a map whose texels are all alike: going a step u across the light, a plane of normal n falls behind
// by n.u / cos a along the light, a the angle between light and normal, and moving by d along the normal
// gains d / cos a.
TexelAt affine_texel(vec3 u_ws, vec3 v_ws, float texel_m, vec3 normal_ws) {
    return TexelAt(texel_m, length(vec2(dot(normal_ws, u_ws), dot(normal_ws, v_ws))));
}

// Of any map, by the gradients of its texel coordinates u, v and its depth z at a point of the world:
// in (u, v, z) the plane of normal n has the normal m = (gradients)^-T n, and gains |m.uv / m.z| of depth
// over a texel, as much as moving by |m.uv| along n does.
TexelAt projective_texel(mat4 clip_from_world, float size_texels, vec3 p_ws, vec3 normal_ws) {
    mat4 rows = transpose(clip_from_world);
    vec4 p_cs = clip_from_world * vec4(p_ws, 1.0);
    // Far outside of the map nothing is looked up; towards a light's side gradients grow without bounds.
    if (any(greaterThan(abs(p_cs.xy), vec2(2.0 * p_cs.w)))) return TexelAt(0.0, 0.0);
    vec3 u = (0.5 * size_texels / p_cs.w) * (rows[0].xyz - p_cs.x / p_cs.w * rows[3].xyz);
    vec3 v = (0.5 * size_texels / p_cs.w) * (rows[1].xyz - p_cs.y / p_cs.w * rows[3].xyz);
    vec3 z = (1.0 / p_cs.w) * (rows[2].xyz - p_cs.z / p_cs.w * rows[3].xyz);
    vec3 along_light = cross(u, v);
    vec2 m = vec2(dot(normal_ws, cross(v, z)), dot(normal_ws, cross(z, u))) / dot(along_light, z);
    float mean = 0.5 * (dot(u, u) + dot(v, v));
    float difference = length(vec2(0.5 * (dot(u, u) - dot(v, v)), dot(u, v)));
    return TexelAt(sqrt((mean + difference) / dot(along_light, along_light)), length(m));
}

// `to_light` is a unit vector.
vec3 biased_position(vec3 p_ws, vec3 normal_ws, vec3 to_light, TexelAt texel, MapBias bias) {
    float offset_m = bias.reach_texels * texel.offset_m;
    float cosine = max(dot(normal_ws, to_light), 1.0 / kMaxSlope);
    return p_ws + normal_ws * (bias.normal_offset * offset_m) +
           to_light * (bias.constant * texel.side_m + bias.slope * offset_m / cosine);
}

#endif
