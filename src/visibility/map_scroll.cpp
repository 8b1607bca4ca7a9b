// Maps that move over the world by whole texels: what stays is copied, and only the strips that
// come into them are drawn. M. Acton, "CSM Scrolling: An Acceleration Technique for the Rendering
// of Cascaded Shadow Maps", SIGGRAPH 2012 (Advances in Real-Time Rendering in Games), over the
// whole texels of M. Valient, "Stable Rendering of Cascaded Shadow Maps", ShaderX6, 2008. There
// moving casters are drawn over a copy, and so they are here (moving_casters.cpp). Depths stay as
// well: a map's depth range is that of the scene, which does not move with the camera.

#include "visibility/map_scroll.h"

#include <glm/ext/matrix_double4x4.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

/// How far maps may be from whole texels apart: far more than double leaves of a texel anywhere on
/// Earth, far less than moves an edge.
constexpr double kMostRounding_texels = 1e-3;

/// Whether both differ by nothing but a step across the map.
bool differ_by_a_step(const LightFit& a, const LightFit& b) {
    const glm::dmat4& from = a.clip_from_world;
    const glm::dmat4& to = b.clip_from_world;
    if (a.size_texels != b.size_texels || a.clamps_near != b.clamps_near) return false;
    if (from[0] != to[0] || from[1] != to[1] || from[2] != to[2]) return false;
    return from[3].z == to[3].z && from[3].w == to[3].w && (a.affine || from == to);
}

}  // namespace

std::optional<MapScroll> scroll(const LightFit& before, const LightFit& after) {
    if (!differ_by_a_step(before, after)) return {};
    const auto size = static_cast<int>(after.size_texels);
    const double texels_per_ndc = 0.5 * size;
    const glm::dvec2 moved =
        texels_per_ndc * glm::dvec2(after.clip_from_world[3] - before.clip_from_world[3]);
    const glm::dvec2 whole = glm::round(moved);
    const glm::dvec2 off = glm::abs(moved - whole);
    if (!(std::max(off.x, off.y) <= kMostRounding_texels)) return {};
    if (!(std::max(std::abs(whole.x), std::abs(whole.y)) < size)) return {};

    MapScroll result{.x_texels = static_cast<int>(whole.x),
                     .y_texels = static_cast<int>(whole.y),
                     .stays = {},
                     .comes = {},
                     .fit = after};
    result.fit.clip_from_world = before.clip_from_world;
    result.fit.clip_from_world[3] += glm::dvec4(whole / texels_per_ndc, 0.0, 0.0);
    const unsigned width = after.size_texels - static_cast<unsigned>(std::abs(result.x_texels));
    const unsigned height = after.size_texels - static_cast<unsigned>(std::abs(result.y_texels));
    result.stays = {std::max(result.x_texels, 0), std::max(result.y_texels, 0), width, height};
    // One strip as high as the map, and one as wide as what it leaves.
    if (width < after.size_texels) {
        result.comes.push_back({result.x_texels > 0 ? 0 : static_cast<int>(width), 0,
                                after.size_texels - width, after.size_texels});
    }
    if (height < after.size_texels) {
        result.comes.push_back({result.stays.x, result.y_texels > 0 ? 0 : static_cast<int>(height),
                                width, after.size_texels - height});
    }
    return result;
}

}  // namespace gnomon
