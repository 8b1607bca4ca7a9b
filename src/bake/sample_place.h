#pragma once

#include "bake/lookup.shared.h"

#include <glm/common.hpp>
#include <glm/ext/vector_double2.hpp>

#include <cstdint>
#include <vector>

namespace gnomon::bake {

/// From a place of a page to where its texel asks when it sees the light, which is its centre, but
/// for texels at charts' borders and those that repeat others. In 1 / shared::kPlaceCodes of a
/// texel.
struct SamplePlace {
    std::int8_t x = 0, y = 0;
};
using SamplePlaces = std::vector<SamplePlace>;

inline SamplePlace coded_place(glm::dvec2 from_center_texels) {
    const glm::dvec2 codes =
        glm::clamp(glm::round(from_center_texels * double{shared::kPlaceCodes}), glm::dvec2(-127.0),
                   glm::dvec2(127.0));
    return {static_cast<std::int8_t>(codes.x), static_cast<std::int8_t>(codes.y)};
}

inline glm::dvec2 texels_of(SamplePlace place) {
    return glm::dvec2(place.x, place.y) / double{shared::kPlaceCodes};
}

}  // namespace gnomon::bake
