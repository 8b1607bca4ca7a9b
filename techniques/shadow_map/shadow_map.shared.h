#ifndef GNOMON_SHADOW_MAP_SHARED_H
#define GNOMON_SHADOW_MAP_SHARED_H

#include "visibility/light_shape.shared.h"

#ifdef __cplusplus
namespace gnomon::shared {
#endif

// The specialization constant kFilter
const uint kFilterNearest = 0u;
const uint kFilterHardware2x2 = 1u;
const uint kFilterBox4x4 = 2u;

struct ShadowMapFrame {
    mat4 clip_from_world;  // of the light, reversed Z
    vec3 eye_ws;           // perspective maps
    float texel_m;         // side of a texel; of perspective maps at 1 m along the axis
    vec3 axis_ws;          // perspective maps
    float perspective;     // 1 or 0
    float reach_texels;    // farthest texel centre that decides, from the receiver
    float bias_constant;   // texels, towards the light
    float bias_slope;      // times the depth that a plane gains over the filter's reach
    float normal_offset;   // times the offset that frees a plane from the filter's reach
};

#ifdef __cplusplus
}  // namespace gnomon::shared
#endif

#endif
