#pragma once

#include <gnomon/light.h>
#include <gnomon/scene.h>

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/ext/vector_double2.hpp>
#include <glm/ext/vector_double4.hpp>

namespace gnomon::dual_paraboloid {

// Unit directions `d` around a light and where a paraboloid mirror shows them: the half-space z > 0
// is the inside of the unit circle. W. Heidrich, H.-P. Seidel, "View-independent Environment Maps",
// 1998. The same as the stereographic projection, so that circles stay circles and angles angles.

/// Anywhere but at (0, 0, -1).
glm::dvec2 place_of(DVec3 d);
DVec3 direction_at(glm::dvec2 place);

/// Which layer of a map: along the axis, or against it, where z is turned round.
enum class Side { along, against };

/// A light's surroundings in one or two square layers.
struct ParaboloidView {
    DVec3 position_ws{0.0};
    DVec3 right_ws{1, 0, 0}, up_ws{0, 1, 0}, forward_ws{0, 0, 1};  ///< unit, at right angles
    double cone = 1.0;   ///< distance from the middle of what is to be shown; 1: a half-space
    double reach = 1.0;  ///< and of a layer's sides, which margins lie between
    int layers = 2;      ///< 1: nothing against the axis
    unsigned size_texels = 1;
    double near_m = 0.0;  ///< what is nearer to the light touches it

    /// z of the directions that are `reach` from the middle: a layer shows no others.
    double rim() const;
    /// The light as origin, z along the axis.
    glm::dmat4 ls_from_world() const;
    /// Plane (unit normal inwards, offset) that the receivers of a layer are on the inner side of.
    glm::dvec4 half_space(Side side) const;
    /// False only when nothing in the box is in the layer.
    bool sees(Side side, const Box3& box_ws) const;
    /// Side of a texel at a point of the world, in metres, across the light.
    float texel_size_m(Vec3 p_ws) const;
};

/// Of a point light, whose axis is vertical, so that texels are finest where its floor and walls
/// are farthest; or of a spot, whose axis is its own.
ParaboloidView paraboloid_view(const Light& light, const Box3& bounds, unsigned size_texels,
                               double margin_texels);

/// How many pieces an edge needs for each radian that it subtends at the light, if it is to be off
/// by no more than half a texel: of edges that bend most, where a layer's scale is 1, at its rim.
double segments_per_rad(double reach, unsigned size_texels);

}  // namespace gnomon::dual_paraboloid
