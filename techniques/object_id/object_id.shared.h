#ifndef GNOMON_OBJECT_ID_SHARED_H
#define GNOMON_OBJECT_ID_SHARED_H

#include "visibility/light_shape.shared.h"

#ifdef __cplusplus
namespace gnomon::object_id::shared {
using namespace gpu::shared;
#endif

// Specialization constant 1 of object_id.comp.glsl
const uint kCompareIds = 0u;
const uint kCompareIdsAndDepths = 1u;

struct MapFrame {
    mat4 clip_from_es;  // of the light's map, from the axes of the world with the eye as origin
    float size_texels;
};

#ifdef __cplusplus
}  // namespace gnomon::object_id::shared
#endif

#endif
