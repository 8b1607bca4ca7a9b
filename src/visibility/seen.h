#pragma once

#include <gnomon/visibility.h>

#include "visibility/light_fit.h"

#include <span>
#include <vector>

namespace gnomon {

/// A part of the picture.
struct SeenTile {
    Box3 bounds;  ///< of its receivers
    DepthRange range;
};

/// What the camera sees of a scene, at most: where receivers can be.
struct Seen {
    Box3 bounds;                  ///< of the parts that it sees; empty when it sees none
    DepthRange range;             ///< distances along its axis of the nearest and farthest receiver
    std::vector<SeenTile> tiles;  ///< of the picture, where that was surveyed; else none

    /// What of it is between two distances and reaches to the inner side of all planes.
    Seen within(DepthRange part, std::span<const glm::dvec4> planes = {}) const;
    /// Distances where there are receivers, apart and rising.
    std::vector<DepthRange> occupied() const;
};

/// `boxes_ws` hold the scene's parts.
Seen seen_part(const Camera& camera, Extent size, std::span<const Box3> boxes_ws);

/// All that is in the tiles.
Seen seen_in(std::vector<SeenTile> tiles);

/// The one map of the frame's light, a sun or a spot, around all receivers that are seen. Throws
/// Error{input} as spot_view() does.
LightFit fit_to_seen(const Frame& frame, const Seen& seen, unsigned size_texels,
                     float margin_texels);

}  // namespace gnomon
