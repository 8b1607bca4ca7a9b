#ifndef GNOMON_VISIBILITY_LIGHT_SHAPE_SHARED_H
#define GNOMON_VISIBILITY_LIGHT_SHAPE_SHARED_H

#ifdef __cplusplus
#include "gpu/shared_types.h"
namespace gnomon::shared {
using namespace gpu::shared;
#endif

// LightShape::kind
const uint kLightDirectional =
    0u;                       // position = unit vector to the light, radius = sine of the disc's
const uint kLightPoint = 1u;  // spots too
const uint kLightSphere = 2u;
const uint kLightDisc = 3u;
const uint kLightRect = 4u;
const uint kLightOfAnyKind = 5u;  // of kLightKind in receiver.glsl: as LightShape::kind says

/// Where a light is and how far it reaches around its centre.
struct LightShape {
    vec3 position;
    uint kind;
    vec3 half_u;  // rect
    float radius;
    vec3 half_v;
    vec3 normal;  // disc, rect: the side that shines
};

/// Enough to find each receiver and to tell whether it faces the light. `_es`: the axes of the
/// world with the camera's eye as origin, where floats are finest however far away the world's own
/// origin is; the light is there as well.
struct ReceiverPush {
    mat4 es_from_clip;
    LightShape light;
    uvec2 size;
};

#ifdef __cplusplus
}  // namespace gnomon::shared
#endif

#endif
