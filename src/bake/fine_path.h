#pragma once

#include <gnomon/math.h>

#include <span>
#include <vector>

namespace gnomon::bake {

/// A path's directions at the middles of `parts` equal parts of each step: unit vectors, for each
/// step one after the other. The first and the last half of a step are beyond the middles that are
/// given, where the path goes on as it came.
std::vector<DVec3> fine_path(std::span<const DVec3> to_light_ws, int parts);

}  // namespace gnomon::bake
