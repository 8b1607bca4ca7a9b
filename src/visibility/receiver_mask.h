#pragma once

#include "visibility/light_fit.h"

#include <span>
#include <vector>

namespace gnomon {

/// Where in a map receivers are looked up, and how far from the light they reach there: a caster
/// that no receiver is behind casts no shadow that is seen. J. Bittner, O. Mattausch, A.
/// Silvennoinen, M. Wimmer, "Shadow Caster Culling for Efficient Shadow Mapping", I3D 2011.
/// Departure: the mask is made by the host, of boxes around receivers, and asked for boxes around
/// casters, so that nothing is drawn and no occlusion query waited for.
class ReceiverMask {
public:
    /// Receivers may be anywhere.
    ReceiverMask() = default;

    /// Of a map whose texels are all alike; filters and bias reach `margin_texels` beyond the
    /// receivers.
    ReceiverMask(const LightFit& fit, std::span<const Box3> receivers_ws, double margin_texels);

    /// False only when no receiver is behind anything in the box, as the light sees it.
    bool is_before_any(const Box3& box_ws) const;

private:
    /// Depths and cells of the map that a box can touch.
    struct Touched {
        int x0, x1, y0, y1;
        double farthest, nearest;  ///< reversed depths
    };
    Touched touched_by(const Box3& box_ws, double grown_cells) const;

    glm::dmat4 cells_from_world_{1.0};  ///< of the map's depth too
    std::vector<double> farthest_;      ///< of each cell's receivers; above all depths: none
};

}  // namespace gnomon
