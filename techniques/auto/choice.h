#pragma once

#include <gnomon/technique.h>

#include "visibility/light_fit.h"

#include <string>

namespace gnomon::automatic {

/// A technique for a frame, and why.
struct Choice {
    std::string technique;
    Params params;
    std::string reason;  ///< one sentence
};

/// `software`: the device is no GPU. `seen`: distances from the camera between which receivers can
/// be; empty (far not beyond near) when there are none.
Choice choose(const Frame& frame, DepthRange seen, bool software);

/// "pssm, filter pcss, map_size 2048, splits 3: ..."
std::string explanation(const Choice& choice);

}  // namespace gnomon::automatic
