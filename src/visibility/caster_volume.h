#pragma once

#include "visibility/light_fit.h"
#include "visibility/map_scroll.h"
#include "visibility/receiver_mask.h"

#include <glm/ext/vector_double4.hpp>

#include <span>
#include <utility>
#include <vector>

namespace gnomon {

/// Where casters can be whose shadows meet a map's receivers: the receivers' convex polytope,
/// extruded towards the light, within the sides of the map. P.-P. J. Sloan et al. and many engines
/// cull so; the planes to keep are those of U. Assarsson and T. Möller, "Optimized View Frustum
/// Culling Algorithms for Bounding Boxes", JGT 5(1), 2000, that do not face the light.
class CasterVolume {
public:
    /// Everything is inside.
    CasterVolume() = default;

    /// Within the sides of the map, whatever its receivers are.
    explicit CasterVolume(const LightFit& fit);
    /// Of a light so far away that all rays to it are `to_light_ws`. `planes_ws` bound the
    /// receivers: (unit normal inwards, offset).
    CasterVolume(const LightFit& fit, DVec3 to_light_ws, std::span<const glm::dvec4> planes_ws,
                 double scene_size_m);
    /// Of a light within the world.
    CasterVolume(const LightFit& fit, std::span<const glm::dvec4> planes_ws, DVec3 light_ws);

    /// Leaves out what cannot be seen in a part of the map.
    void keep_within(const LightFit& fit, const TexelRect& texels);

    /// Leaves out what is wholly behind a plane: (unit normal to what is kept, offset).
    void keep_in_front(const glm::dvec4& plane_ws) { sides_.push_back({plane_ws}); }

    /// Leaves out what no receiver of the mask is behind.
    void keep_before(ReceiverMask receivers) { receivers_ = std::move(receivers); }

    /// False only when nothing in the box can cast a shadow into the map.
    bool holds(const Box3& box_ws) const;

private:
    struct Side {
        glm::dvec4 plane;
        double touching_m = 0.0;  ///< casters that reach no farther in than this only touch
    };
    std::vector<Side> sides_;
    ReceiverMask receivers_;
};

}  // namespace gnomon
