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
