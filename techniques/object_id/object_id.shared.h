#ifndef GNOMON_OBJECT_ID_SHARED_H
#define GNOMON_OBJECT_ID_SHARED_H

#include "visibility/object_map.shared.h"

#ifdef __cplusplus
namespace gnomon::object_id::shared {
using namespace gpu::shared;
#endif

// Specialization constant 1 of object_id.comp.glsl
const uint kCompareIds = 0u;
const uint kCompareIdsAndDepths = 1u;

#ifdef __cplusplus
}  // namespace gnomon::object_id::shared
#endif

#endif
