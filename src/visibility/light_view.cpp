#include "visibility/light_view.h"

#include "base/check.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon {

namespace {

using DVec4 = glm::dvec4;

/// Least side of a fitted view, of the whole one's: what is thinner needs no finer texels.
constexpr double kLeastPart = 1e-3;

LightView view_along(DVec3 position_ws, DVec3 forward_ws, DVec3 up_ws) {
    LightView view;
    view.position_ws = position_ws;
    view.forward_ws = glm::normalize(forward_ws);
    view.right_ws = glm::normalize(glm::cross(view.forward_ws, up_ws));
    view.up_ws = glm::cross(view.right_ws, view.forward_ws);
    return view;
}

/// Any direction that is not `direction`'s.
DVec3 up_for(DVec3 direction) {
    return std::abs(direction.y) > 0.99 ? DVec3(0, 0, -1) : DVec3(0, 1, 0);
}

}  // namespace

double farthest_m(const Box3& bounds, const DVec3& p_ws) {
    if (bounds.empty()) return 1.0;
    const DVec3 away =
        glm::max(glm::abs(DVec3(bounds.min) - p_ws), glm::abs(DVec3(bounds.max) - p_ws));
    return std::max(glm::length(away), 1e-6);
}

std::array<DVec4, 4> LightView::planes() const {
    std::array<DVec4, 4> result;
    const std::array normals{right_ws - low.x * forward_ws, high.x * forward_ws - right_ws,
                             up_ws - low.y * forward_ws, high.y * forward_ws - up_ws};
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const DVec3 normal = glm::normalize(normals[i]);
        result[i] = DVec4(normal, -glm::dot(normal, position_ws));
    }
    return result;
}

LightView spot_view(const SpotLight& light) {
    if (light.outer_angle_rad > kWidestSpotRad) {
        fail_input("a spot of {:.4g}° does not fit one map; at most {:.4g}° do",
                   2.0f * degrees(light.outer_angle_rad), 2.0f * degrees(kWidestSpotRad));
    }
    const DVec3 forward(light.direction_ws);
    LightView view = view_along(DVec3(light.position_ws), forward, up_for(forward));
    view.high = glm::dvec2(std::tan(static_cast<double>(light.outer_angle_rad)));
    view.low = -view.high;
    return view;
}

std::vector<LightView> cube_views(DVec3 position_ws) {
    std::vector<LightView> views;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {1.0, -1.0}) {
            DVec3 forward(0.0);
            forward[axis] = sign;
            views.push_back(view_along(position_ws, forward, up_for(forward)));
        }
    }
    return views;
}

std::vector<LightView> tetrahedron_views(DVec3 position_ws) {
    // A face is the triangle around its axis whose corners are the axes of the others, mirrored.
    const std::array<DVec3, 4> axes{DVec3(1, 1, 1), DVec3(1, -1, -1), DVec3(-1, 1, -1),
                                    DVec3(-1, -1, 1)};
    std::vector<LightView> views;
    for (std::size_t face = 0; face < axes.size(); ++face) {
        LightView view = view_along(position_ws, axes[face], axes[(face + 1) % axes.size()]);
        view.low = glm::dvec2(std::numeric_limits<double>::infinity());
        view.high = -view.low;
        for (std::size_t other = 0; other < axes.size(); ++other) {
            if (other == face) continue;
            const DVec3 corner = -axes[other];
            const glm::dvec2 xy =
                glm::dvec2(glm::dot(corner, view.right_ws), glm::dot(corner, view.up_ws)) /
                glm::dot(corner, view.forward_ws);
            view.low = glm::min(view.low, xy);
            view.high = glm::max(view.high, xy);
        }
        views.push_back(view);
    }
    return views;
}

LightView fitted(const LightView& view, std::span<const DVec3> receivers_ws) {
    LightView part = view;
    part.low = view.high;
    part.high = view.low;
    for (const DVec3& p_ws : receivers_ws) {
        const DVec3 p = p_ws - view.position_ws;
        const double along_m = glm::dot(p, view.forward_ws);
        // Around a receiver at the light's own place it sees all of its view.
        if (!(along_m > 0.0)) return view;
        const glm::dvec2 xy =
            glm::dvec2(glm::dot(p, view.right_ws), glm::dot(p, view.up_ws)) / along_m;
        part.low = glm::min(part.low, xy);
        part.high = glm::max(part.high, xy);
    }
    const glm::dvec2 least = kLeastPart * (view.high - view.low);
    const glm::dvec2 middle = 0.5 * (part.low + part.high);
    const glm::dvec2 half = 0.5 * glm::max(part.high - part.low, least);
    part.low = glm::max(middle - half, view.low);
    part.high = glm::min(middle + half, view.high);
    return part;
}

double near_light_m(const Box3& bounds) {
    // Of the scene's size: a few roundings of coordinates. Reversed Z keeps precision however near
    // that is.
    constexpr double kNearFraction = 1e-6;
    const double near_m = kNearFraction * static_cast<double>(std::max(bounds.diagonal(), 1e-3f));
    // A power of 2: maps rest while what moves in the scene changes its size a little.
    return std::exp2(std::floor(std::log2(near_m)));
}

LightFit fit_view(const LightView& view, const Box3& bounds, unsigned size_texels,
                  float margin_texels) {
    const double near_m = near_light_m(bounds);
    const glm::dvec2 half =
        0.5 * (view.high - view.low) * (size_texels / used_texels(size_texels, margin_texels));
    const glm::dvec2 middle = 0.5 * (view.low + view.high);

    const DVec4 along(view.forward_ws, -glm::dot(view.forward_ws, view.position_ws));
    const DVec4 right(view.right_ws, -glm::dot(view.right_ws, view.position_ws));
    const DVec4 up(view.up_ws, -glm::dot(view.up_ws, view.position_ws));
    const glm::dmat4 rows((right - middle.x * along) / half.x, (up - middle.y * along) / half.y,
                          DVec4(0, 0, 0, near_m), along);
    LightFit fit;
    fit.clip_from_world = glm::transpose(rows);
    fit.size_texels = size_texels;
    fit.affine = false;
    fit.far_m = farthest_m(bounds, view.position_ws);
    fit.is_view = true;
    fit.clamps_near =
        false;  // what all but touches the light, as a ceiling around it, hides nothing
    return fit;
}

}  // namespace gnomon
