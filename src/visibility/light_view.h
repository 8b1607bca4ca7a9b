#pragma once

#include "visibility/light_fit.h"

#include <glm/ext/vector_double2.hpp>
#include <glm/ext/vector_double4.hpp>

#include <array>
#include <span>
#include <vector>

namespace gnomon {

/// A pyramid that a light within the world looks into. x and y of a point are how far to the right
/// and up of its axis the light sees it, over its distance along the axis.
struct LightView {
    DVec3 position_ws{0.0};
    DVec3 right_ws{1, 0, 0}, up_ws{0, 1, 0}, forward_ws{0, 0, -1};  ///< unit vectors
    glm::dvec2 low{-1.0}, high{1.0};                                ///< of x and y

    /// Planes (unit normal inwards, offset) of its four sides.
    std::array<glm::dvec4, 4> planes() const;
};

/// Half of the widest cone that one map holds.
inline constexpr float kWidestSpotRad = radians(80.0f);

/// Around a spot's cone. Throws Error{input} when the cone is wider than twice kWidestSpotRad.
LightView spot_view(const SpotLight& light);

/// The faces of a cube around the light: +x, -x, +y, -y, +z, -z.
std::vector<LightView> cube_views(DVec3 position_ws);

/// The faces of a tetrahedron around it: fewer maps than a cube's, with texels that differ more in
/// size. H.-C. Liao, "Shadow Mapping for Omnidirectional Light Using Tetrahedron Mapping", GPU
/// Pro, 2010.
std::vector<LightView> tetrahedron_views(DVec3 position_ws);

/// The view cut to the smallest rectangle in which the light sees the receivers, which lie within
/// it.
LightView fitted(const LightView& view, std::span<const DVec3> receivers_ws);

/// From a point to the farthest of the scene of these bounds; 1 where that is empty.
double farthest_m(const Box3& bounds, const DVec3& p_ws);

/// What is nearer to the light than this is taken to touch it, and casts no shadow.
double near_light_m(const Box3& bounds);

/// The view's map, with `margin_texels` around it.
LightFit fit_view(const LightView& view, const Box3& bounds, unsigned size_texels,
                  float margin_texels);

}  // namespace gnomon
