// Where a receiver is looked up, and the plane that its texels are compared with: it is moved off its
// surface and towards the light by what a plane would demand over some reach. D. Holbert, "Saying Goodbye to
// Shadow Acne", GDC 2011, for the normal offset; S. Kozlov, "Perspective Shadow Maps: Care and Feeding",
// GPU Gems 2004, chapter 14, for a bias in the world that follows the texel. Departure: what a plane
// demands is computed exactly from the map's matrix, for any projection.

#ifndef GNOMON_VISIBILITY_MAP_BIAS_GLSL
#define GNOMON_VISIBILITY_MAP_BIAS_GLSL

#include "visibility/map_lookup.shared.h"

// A surface at 84° to the light; steeper ones are moved as this one.
const float kMaxSlope = 10.0;

// A plane at 89.4°: steeper ones are extended as this one, since normals of 16 bits would tell too little.
const float kMaxGradientSlope = 100.0;

// Texels' sides that a receiver's plane is followed away from the light: as far as a filter of two texels
// follows a plane at 45°. Farther, the ground hides the foot of a wall that falls through it.
const float kMaxFall = 1.0;

struct TexelAt {
    float side_m;    // across the light, the longer one
    float offset_m;  // along the normal, that gains the depth that the plane gains over one texel
    vec2 gradient;   // the map's depth that the plane gains from a texel to the next
    vec3 u, v;       // texels of the map that a metre of the world is long
    vec3 z;          // and the map's depth
};

// Of a map whose texels are all alike: going a step u across the light, a plane of normal n falls behind
// by n.u / cos a along the light, a the angle between light and normal, and moving by d along the normal
// gains d / cos a.
TexelAt affine_texel(MapLayerFrame layer, float size_texels, vec3 normal_ws, vec3 to_light) {
    vec2 m = layer.steps.xy * vec2(dot(normal_ws, layer.u.xyz), dot(normal_ws, layer.v.xyz));
    float cosine = max(dot(normal_ws, to_light), 1.0 / kMaxGradientSlope);
    return TexelAt(layer.steps.z, length(m), -dot(layer.z.xyz, to_light) / cosine * m,
                   size_texels * layer.u.xyz, size_texels * layer.v.xyz, layer.z.xyz);
}

// Of any map, by the gradients of its texel coordinates u, v and its depth z at a point of the world:
// in (u, v, z) the plane of normal n has the normal m = (gradients)^-T n, and gains |m.uv / m.z| of depth
// over a texel, as much as moving by |m.uv| along n does.
TexelAt projective_texel(MapLayerFrame layer, float size_texels, vec3 p_es, vec3 normal_ws) {
    vec4 p = vec4(p_es, 1.0);
    float w = dot(layer.w, p);
    vec3 uvz = vec3(dot(layer.u, p), dot(layer.v, p), dot(layer.z, p)) / w;
    vec3 u = (size_texels / w) * (layer.u.xyz - uvz.x * layer.w.xyz);
    vec3 v = (size_texels / w) * (layer.v.xyz - uvz.y * layer.w.xyz);
    vec3 z = (1.0 / w) * (layer.z.xyz - uvz.z * layer.w.xyz);
    vec3 along_light = cross(u, v);
    vec2 m = vec2(dot(normal_ws, cross(v, z)), dot(normal_ws, cross(z, u))) / dot(along_light, z);
    float mean = 0.5 * (dot(u, u) + dot(v, v));
    float difference = length(vec2(0.5 * (dot(u, u) - dot(v, v)), dot(u, v)));
    // Far outside of the map nothing is looked up; towards a light's side gradients grow without bounds.
    bool near = w > 0.0 && all(lessThan(abs(uvz.xy - 0.5), vec2(1.0)));
    // m.z is the normal's part along the light, which has no depth where the plane is seen edge on.
    float along = dot(normal_ws, along_light) / dot(along_light, z);
    float least = length(along_light) / abs(dot(along_light, z)) / kMaxGradientSlope;
    vec2 gradient = -m / max(along, least);  // as a wall that part of the light's disc still meets
    return TexelAt(near ? sqrt((mean + difference) / dot(along_light, along_light)) : 0.0,
                   near ? length(m) : 0.0, near ? gradient : vec2(0.0), u, v, z);
}

// How far a receiver is moved off a plane that the light grazes, from 89.4° on, and all of it from 89.7° on.
// No texel shows such a wall; those around it show its roof or the ground before it, which is as lit as it is.
// Maps need no wider margin for it: what hides such a wall hides what is just before it.
float grazed_offset_m(vec3 normal_ws, float cosine, TexelAt texel, MapBias bias) {
    float grazed_texels = bias.grazed_texels * clamp(2.0 - 2.0 * kMaxGradientSlope * cosine, 0.0, 1.0);
    float texels_per_m = length(vec2(dot(texel.u, normal_ws), dot(texel.v, normal_ws)));
    return min(grazed_texels / max(texels_per_m, 1e-20), texel.side_m);
}

// `to_light` is a unit vector.
vec3 biased_position(vec3 p_es, vec3 normal_ws, vec3 to_light, TexelAt texel, MapBias bias) {
    float offset_m = bias.reach_texels * texel.offset_m;
    float cosine = dot(normal_ws, to_light);
    float off_plane_m = bias.normal_offset * offset_m +
                        grazed_offset_m(normal_ws, cosine, texel, bias);
    float to_light_m = bias.constant * texel.side_m +
                       bias.slope * offset_m / max(cosine, 1.0 / kMaxSlope);
    return p_es + off_plane_m * normal_ws + to_light_m * to_light;
}

#endif
