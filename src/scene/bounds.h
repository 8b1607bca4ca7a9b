#pragma once

#include <gnomon/math.h>

namespace gnomon::scene {

/// Around a box that an affine matrix moves; empty when the box is.
Box3 placed_bounds(const Mat4& world_from_local, const Box3& local);

}  // namespace gnomon::scene
