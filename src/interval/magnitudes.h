#pragma once

#include <gnomon/math.h>

#include <cmath>

namespace gnomon::interval {

// Not glm::abs(): of doubles it takes a branch on each sign, which no processor foresees.

inline DVec3 magnitudes(DVec3 v) {
    return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}

inline double sum_of_magnitudes(DVec3 v) {
    return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

}  // namespace gnomon::interval
