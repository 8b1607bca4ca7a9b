#ifndef GNOMON_LIGHTING_SHARED_H
#define GNOMON_LIGHTING_SHARED_H

#include "visibility/light_shape.shared.h"

#ifdef __cplusplus
namespace gnomon::shared {
#endif

/// One light on all receivers.
struct ShadeFrame {
    mat4 world_from_clip;
    vec3 eye_ws;        // perspective, or the direction to the viewer
    float perspective;  // 1 or 0
    LightShape light;
    vec3 strength;         // irradiance of directional lights, intensity of the others
    float emits_one_side;  // 1: falls off with the cosine to light.normal
    vec3 spot_axis;
    float spot_scale;  // spot factor = clamp(cos * scale + offset, 0, 1)²
    float spot_offset;
    uint first;  // 1: sums begin with this light
    uvec2 size;
};

/// What a receiver takes from the vertices around it.
struct VertexShade {
    vec3 irradiance;   // on the flat surface
    vec3 averaged_ws;  // unit vector
};

struct VertexPush {
    uvec2 size;
    float most_factor;  // by which bumps count; 0: they do not
};

struct ComposePush {
    vec3 ambient;
    float exposure;
    vec3 background_srgb;
    uint subtractive;
    uvec2 size;
};

#ifdef __cplusplus
}  // namespace gnomon::shared
#endif

#endif
