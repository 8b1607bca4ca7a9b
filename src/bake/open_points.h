#pragma once

#include <gnomon/progress.h>

#include "bake/light_day.h"
#include "lightmap/texels.h"
#include "trace/receiver.h"

#include <vector>

namespace gnomon::bake {

/// A day of light at texels.
struct TexelDay {
    std::vector<trace::Receiver> receivers;  ///< where each texel asks
    std::vector<LitTimes> times;             ///< when it sees the light
    std::vector<bool> buried;                ///< it asks from inside of a solid: see are_buried()
};

/// Moves the points of buried texels, of which a part may be in the open, to the open place nearest
/// to their centres, and bakes them there; those that have none stay buried. Throws
/// Error{cancelled}.
void move_to_open(const lightmap::Atlas& atlas, const lightmap::Texels& texels,
                  const LightDay& light, TexelDay& day, Progress& progress);

}  // namespace gnomon::bake
