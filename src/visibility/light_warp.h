#pragma once

#include "visibility/light_fit.h"

#include <span>

namespace gnomon {

/// How the texels of a map for a light at infinity are spread along the view.
enum class Warp {
    none,    ///< evenly
    lispsm,  ///< M. Wimmer, D. Scherzer, W. Purgathofer, "Light Space Perspective Shadow Maps",
             ///< EGSR 2004
    trapezoidal,  ///< T. Martin, T.-S. Tan, "Anti-aliasing and Continuity with Trapezoidal Shadow
                  ///< Maps", EGSR 2004
};

/// Of the depth of the view, from the nearest receiver on: the trapezoid's focus.
inline constexpr double kDefaultFocus = 0.4;

/// How far in front of the nearest receivers the eye of the warp is, along the view as the light
/// sees it: the nearer, the more texels the near receivers get. `near_m` and `far_m`: distances of
/// receivers from the camera along its axis; `sine`: of the angle between its axis and the light;
/// `length_m`: of the receivers along the view as the light sees it. Infinite where nothing can be
/// gained. `focus`, in (0, 1): how much of the depth of the view is the trapezoid's focus.
double warp_near_m(Warp warp, double focus, double near_m, double far_m, double sine,
                   double length_m);

/// A map around `receivers_ws` whose texels are smaller near the camera, by the warp or a weaker
/// one; as fit_directional() where none makes the mean texel smaller.
LightFit fit_warped(Warp warp, double focus, const DirectionalLight& light, const Camera& camera,
                    std::span<const DVec3> receivers_ws, const Box3& bounds, unsigned size_texels,
                    float margin_texels);

}  // namespace gnomon
