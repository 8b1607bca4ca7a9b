#ifndef GNOMON_SHADOW_VOLUMES_SHARED_H
#define GNOMON_SHADOW_VOLUMES_SHARED_H

#ifdef __cplusplus
#include "gpu/shared_types.h"
namespace gnomon::shadow_volumes::shared {
using namespace gpu::shared;
#endif

/// A triangle of the caps: where it is placed, and its corners in the scene's vertex buffer.
struct VolumeTriangle {
    uint slot;
    uint a;
    uint b;
    uint c;
};

/// An edge that is extruded away from the light.
struct VolumeSide {
    uint slot;
    uint a;
    uint b;
};

// VolumePush::part
const uint kNearCaps = 0u;
const uint kFarCaps = 1u;
const uint kSides = 2u;

struct VolumePush {
    mat4 clip_from_world;
    vec4 light_ws;  // position, 1 or direction to the light, 0
    uint part;
};

#ifdef __cplusplus
}  // namespace gnomon::shadow_volumes::shared
#endif

#endif
