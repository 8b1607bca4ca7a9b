#include "visibility/caster_volume.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>

namespace gnomon {

namespace {

/// Of the scene's size: what touches the receivers' volume by no more lies in its boundary, as does
/// a flat ground under everything, and casts no shadow into it.
constexpr double kTouching = 1e-6;

}  // namespace

CasterVolume::CasterVolume(const LightFit& fit, DVec3 to_light_ws,
                           std::span<const glm::dvec4> planes_ws, double scene_size_m)
    : touching_m_(kTouching * scene_size_m) {
    for (const glm::dvec4& plane : planes_ws) {
        if (glm::dot(DVec3(plane), to_light_ws) >= 0.0) planes_.push_back(plane);
    }
    add_sides(fit);
}

CasterVolume::CasterVolume(const LightFit& fit, std::span<const glm::dvec4> planes_ws,
                           DVec3 light_ws) {
    for (const glm::dvec4& plane : planes_ws) {
        if (glm::dot(DVec3(plane), light_ws) + plane.w >= 0.0) planes_.push_back(plane);
    }
    add_sides(fit);
}

// |x| <= w and |y| <= w in the map's clip space, as planes of the world.
void CasterVolume::add_sides(const LightFit& fit) {
    const glm::dmat4 rows = glm::transpose(fit.clip_from_world);
    for (const glm::dvec4& plane :
         {rows[3] - rows[0], rows[3] + rows[0], rows[3] - rows[1], rows[3] + rows[1]}) {
        const double length = glm::length(DVec3(plane));
        if (length > 0.0) planes_.push_back(plane / length);
    }
}

bool CasterVolume::holds(const Box3& box_ws) const {
    return std::ranges::all_of(
        planes_, [&](const glm::dvec4& plane) { return reach(plane, box_ws) > touching_m_; });
}

}  // namespace gnomon
