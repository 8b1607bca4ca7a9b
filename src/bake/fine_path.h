#pragma once

#include <gnomon/math.h>

#include <span>
#include <vector>

namespace gnomon::bake {

/// A path's direction `at_step` steps from its begin, 0 to their number: a unit vector. The path
/// goes through what is given in the middle of each step; the first and the last half of a step are
/// beyond these, where it goes on as it came.
DVec3 direction_at(std::span<const DVec3> to_light_ws, double at_step);

/// A path's directions at the middles of `parts` equal parts of each step: unit vectors, for each
/// step one after the other.
std::vector<DVec3> fine_path(std::span<const DVec3> to_light_ws, int parts);

}  // namespace gnomon::bake
