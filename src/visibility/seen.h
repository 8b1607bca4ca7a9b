#pragma once

#include "visibility/light_fit.h"

#include <span>

namespace gnomon {

/// What the camera sees of a scene, at most: where receivers can be.
struct Seen {
    Box3 bounds;       ///< of the parts that it sees; empty when it sees none
    DepthRange range;  ///< distances along its axis of the nearest and farthest receiver
};

/// `boxes_ws` hold the scene's parts.
Seen seen_part(const Camera& camera, Extent size, std::span<const Box3> boxes_ws);

}  // namespace gnomon
