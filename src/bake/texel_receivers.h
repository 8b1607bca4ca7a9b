#pragma once

#include <gnomon/scene.h>

#include "lightmap/texels.h"
#include "trace/receiver.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gnomon::bake {

/// The points of a light map's texels as receivers of light, in the order of the texels, which is
/// chart by chart and tile by tile: neighbours in the list are neighbours in the scene.
std::vector<trace::Receiver> texel_receivers(const lightmap::Atlas& atlas,
                                             const lightmap::Texels& texels);

/// A point of a triangle of the atlas, by the weights of its corners.
trace::Receiver receiver_on(const Scene& scene, const lightmap::Atlas& atlas,
                            std::uint32_t triangle, const std::array<double, 3>& weights);

}  // namespace gnomon::bake
