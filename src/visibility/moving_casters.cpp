// Casters that move, over a map of those that stay. After M. Acton, "CSM Scrolling: An Acceleration
// Technique for the Rendering of Cascaded Shadow Maps", SIGGRAPH 2012 (Advances in Real-Time
// Rendering in Games), where moving casters are drawn over a copy of the map in each frame. Here
// only the texels are copied that they cover or have left, and none where all of them rest; and
// nobody says which casters move: those do that have once moved.

#include "visibility/moving_casters.h"

#include <glm/ext/matrix_double4x4.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace gnomon {

namespace {

/// Around what a box covers: what float leaves of a corner's place, and the half texel by which a
/// triangle's edge must pass a texel's centre.
constexpr double kRounding_texels = 2.0;

/// More are copied as one.
constexpr std::size_t kMostRects = 256;

bool overlap(const TexelRect& a, const TexelRect& b) {
    return a.x < b.x + static_cast<int>(b.width) && b.x < a.x + static_cast<int>(a.width) &&
           a.y < b.y + static_cast<int>(b.height) && b.y < a.y + static_cast<int>(a.height);
}

TexelRect around_both(const TexelRect& a, const TexelRect& b) {
    const int x = std::min(a.x, b.x);
    const int y = std::min(a.y, b.y);
    const int right = std::max(a.x + static_cast<int>(a.width), b.x + static_cast<int>(b.width));
    const int bottom = std::max(a.y + static_cast<int>(a.height), b.y + static_cast<int>(b.height));
    return {x, y, static_cast<unsigned>(right - x), static_cast<unsigned>(bottom - y)};
}

/// Adds a rectangle, joined with those that it overlaps.
void join(std::vector<TexelRect>& rects, TexelRect added) {
    for (bool grows = true; grows;) {
        const auto met = std::ranges::find_if(
            rects, [&](const TexelRect& rect) { return overlap(rect, added); });
        grows = met != rects.end();
        if (!grows) break;
        added = around_both(added, *met);
        *met = rects.back();
        rects.pop_back();
    }
    rects.push_back(added);
}

const Box3& local_bounds(const Scene& scene, std::uint32_t instance) {
    return scene.mesh_bounds(scene.instances()[instance].mesh);
}

}  // namespace

TexelRect covered_texels(const LightFit& fit, const Mat4& world_from_local, const Box3& local) {
    if (local.empty()) return {};
    const glm::dmat4 clip_from_local = fit.clip_from_world * glm::dmat4(world_from_local);
    const double size = fit.size_texels;
    glm::dvec2 low(std::numeric_limits<double>::infinity());
    glm::dvec2 high = -low;
    for (unsigned i = 0; i < 8; ++i) {
        const glm::dvec4 p =
            clip_from_local * glm::dvec4((i & 1) != 0 ? local.max.x : local.min.x,
                                         (i & 2) != 0 ? local.max.y : local.min.y,
                                         (i & 4) != 0 ? local.max.z : local.min.z, 1.0);
        // What reaches behind the map's eye can cover all of it.
        if (!(p.w > 0.0)) return whole_map(fit.size_texels);
        const glm::dvec2 at = (0.5 * glm::dvec2(p) / p.w + 0.5) * size;
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    low = glm::clamp(glm::floor(low - kRounding_texels), 0.0, size);
    high = glm::clamp(glm::ceil(high + kRounding_texels), 0.0, size);
    if (!(low.x < high.x && low.y < high.y)) return {};
    return {static_cast<int>(low.x), static_cast<int>(low.y), static_cast<unsigned>(high.x - low.x),
            static_cast<unsigned>(high.y - low.y)};
}

TexelRect around(std::span<const TexelRect> rects) {
    TexelRect all = rects.front();
    for (const TexelRect& rect : rects)
        all = around_both(all, rect);
    return all;
}

std::vector<TexelRect> apart(std::span<const TexelRect> rects) {
    std::vector<TexelRect> result;
    for (const TexelRect& rect : rects) {
        if (rect.area() == 0) continue;
        join(result, rect);
        if (result.size() <= kMostRects) continue;
        result = {around(result)};
    }
    return result;
}

void MovingCasters::clear() {
    moving_.clear();
    still_.clear();
}

bool MovingCasters::add(const Scene& scene) {
    std::vector<std::uint32_t> all;
    std::ranges::set_union(moving_, scene.moving(), std::back_inserter(all));
    if (all.size() == moving_.size()) return false;
    moving_ = std::move(all);
    still_.assign(scene.instances().size(), 1);
    for (const std::uint32_t instance : moving_)
        still_[instance] = 0;
    return true;
}

std::vector<Mat4> MovingCasters::places(const Scene& scene) const {
    std::vector<Mat4> places;
    for (const std::uint32_t instance : moving_)
        places.push_back(scene.instances()[instance].world_from_local);
    return places;
}

std::vector<TexelRect> MovingCasters::changed(const LightFit& fit, const Scene& scene,
                                              std::span<const Mat4> before) const {
    std::vector<TexelRect> rects;
    for (std::size_t i = 0; i < moving_.size(); ++i) {
        const Mat4& now = scene.instances()[moving_[i]].world_from_local;
        if (now == before[i]) continue;
        for (const Mat4& place : {before[i], now})
            rects.push_back(covered_texels(fit, place, local_bounds(scene, moving_[i])));
    }
    return apart(rects);
}

std::vector<std::uint8_t> MovingCasters::reaching(const LightFit& fit, const Scene& scene,
                                                  std::span<const TexelRect> texels) const {
    std::vector<std::uint8_t> reaching(scene.instances().size(), 0);
    for (const std::uint32_t instance : moving_) {
        const TexelRect covers = covered_texels(fit, scene.instances()[instance].world_from_local,
                                                local_bounds(scene, instance));
        const bool meets =
            covers.area() > 0 && std::ranges::any_of(texels, [&](const TexelRect& rect) {
                return overlap(rect, covers);
            });
        reaching[instance] = meets ? 1 : 0;
    }
    return reaching;
}

}  // namespace gnomon
