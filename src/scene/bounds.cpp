#include "scene/bounds.h"

namespace gnomon::scene {

Box3 placed_bounds(const Mat4& world_from_local, const Box3& local) {
    Box3 bounds;
    if (local.empty()) return bounds;
    for (unsigned i = 0; i < 8; ++i) {
        const Vec3 corner((i & 1) != 0 ? local.max.x : local.min.x,
                          (i & 2) != 0 ? local.max.y : local.min.y,
                          (i & 4) != 0 ? local.max.z : local.min.z);
        bounds.include(Vec3(world_from_local * Vec4(corner, 1.0f)));
    }
    return bounds;
}

}  // namespace gnomon::scene
