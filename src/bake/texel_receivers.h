#pragma once

#include <gnomon/scene.h>

#include "lightmap/texels.h"
#include "trace/receiver.h"

#include <vector>

namespace gnomon::bake {

/// The points of a light map's texels as receivers of light, in the order of the texels, which is
/// chart by chart and tile by tile: neighbours in the list are neighbours in the scene.
std::vector<trace::Receiver> texel_receivers(const lightmap::Atlas& atlas,
                                             const lightmap::Texels& texels);

}  // namespace gnomon::bake
