#ifndef GNOMON_VISIBILITY_OBJECT_MAP_SHARED_H
#define GNOMON_VISIBILITY_OBJECT_MAP_SHARED_H

#ifdef __cplusplus
#include "gpu/shared_types.h"
namespace gnomon::shared {
using namespace gpu::shared;
#endif

struct ObjectMapFrame {
    mat4 clip_from_es;  // of the light's map, from the axes of the world with the eye as origin
    float size_texels;
};

#ifdef __cplusplus
}  // namespace gnomon::shared
#endif

#endif
