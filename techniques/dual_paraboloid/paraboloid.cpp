#include "paraboloid.h"

#include "visibility/light_view.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::dual_paraboloid {

namespace {

/// Keeps a texel's size finite and above 0 at the light's own place.
constexpr double kLeast_m = 1e-12;

/// Least part of a layer's side that is no margin, of maps of very few texels.
constexpr double kLeastUsed = 0.25;

double turned(Side side) {
    return side == Side::along ? 1.0 : -1.0;
}

}  // namespace

glm::dvec2 place_of(DVec3 d) {
    return glm::dvec2(d) / (1.0 + d.z);
}

DVec3 direction_at(glm::dvec2 place) {
    const double square = glm::dot(place, place);
    return DVec3(2.0 * place, 1.0 - square) / (1.0 + square);
}

double ParaboloidView::rim() const {
    return (1.0 - reach * reach) / (1.0 + reach * reach);
}

glm::dmat4 ParaboloidView::ls_from_world() const {
    const glm::dmat3 axes = glm::transpose(glm::dmat3(right_ws, up_ws, forward_ws));
    glm::dmat4 result(axes);
    result[3] = glm::dvec4(-(axes * position_ws), 1.0);
    return result;
}

glm::dvec4 ParaboloidView::half_space(Side side) const {
    const DVec3 inwards = turned(side) * forward_ws;
    return {inwards, -glm::dot(inwards, position_ws)};
}

bool ParaboloidView::sees(Side side, const Box3& box_ws) const {
    if (layers == 1 && side == Side::against) return false;
    const DVec3 low = DVec3(box_ws.min) - position_ws, high = DVec3(box_ws.max) - position_ws;
    const double farthest_m = glm::length(glm::max(glm::abs(low), glm::abs(high)));
    // Directions in a layer are those of z > rim |p|.
    return gnomon::reach(half_space(side), box_ws) >= std::min(rim(), 0.0) * farthest_m;
}

float ParaboloidView::texel_size_m(Vec3 p_ws) const {
    const DVec3 p = DVec3(p_ws) - position_ws;
    const double distance_m = std::max(glm::length(p), kLeast_m);
    // Of unit directions a step in the paraboloid's plane is 1 + z long.
    const double scale = 1.0 + std::abs(glm::dot(p, forward_ws)) / distance_m;
    return static_cast<float>(distance_m * scale * 2.0 * reach / size_texels);
}

ParaboloidView paraboloid_view(const Light& light, const Box3& bounds, unsigned size_texels,
                               double margin_texels) {
    ParaboloidView view{.size_texels = size_texels, .near_m = near_light_m(bounds)};
    if (const auto* spot = std::get_if<SpotLight>(&light)) {
        view.layers = 1;
        view.position_ws = DVec3(spot->position_ws);
        view.forward_ws = glm::normalize(DVec3(spot->direction_ws));
        view.cone = std::tan(0.5 * static_cast<double>(spot->outer_angle_rad));
    } else {
        view.position_ws = DVec3(std::get<PointLight>(light).position_ws);
        view.forward_ws = DVec3(0, -1, 0);
    }
    const bool vertical = std::abs(view.forward_ws.y) > 0.99;
    const DVec3 aside = vertical ? DVec3(0, 0, 1) : DVec3(0, 1, 0);
    view.right_ws = glm::normalize(glm::cross(aside, view.forward_ws));
    view.up_ws = glm::cross(view.forward_ws, view.right_ws);
    view.reach = view.cone / std::max(1.0 - 2.0 * margin_texels / size_texels, kLeastUsed);
    return view;
}

// A chord c of a circle of radius 1 is off by c² / 8 in its middle; half a texel is reach / size.
double segments_per_rad(double reach, unsigned size_texels) {
    return std::sqrt(size_texels / (8.0 * reach));
}

}  // namespace gnomon::dual_paraboloid
