// Casters that move, over a map of those that stay. After M. Acton, "CSM Scrolling: An Acceleration
// Technique for the Rendering of Cascaded Shadow Maps", SIGGRAPH 2012 (Advances in Real-Time
// Rendering in Games), where moving casters are drawn over a copy of the map in each frame. Here
// only the texels are copied that they cover or have left, and none where all of them rest; and
// nobody says which casters move: those do that have once moved, or that differ from one scene to
// the next.

#include "visibility/moving_casters.h"

#include "scene/caster_changes.h"

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
    scene_.reset();
    moving_.clear();
    still_.clear();
    shapes_.clear();
}

// Of one scene's placements none differ but in what their moving() names.
std::vector<std::uint32_t> MovingCasters::changes(const Scene& scene) {
    if (scene_ && same(scene_->contents_identity(), scene.contents_identity())) return {};
    const auto changed = scene_ ? scene::changed_casters(*scene_, scene) : std::nullopt;
    if (!changed) {
        clear();
        shapes_.assign(scene.instances().size(), 0);
        return {};
    }
    for (const std::uint32_t instance : *changed)
        ++shapes_[instance];
    return *changed;
}

bool MovingCasters::follow(const Scene& scene) {
    std::vector<std::uint32_t> now;
    std::ranges::set_union(changes(scene), scene.moving(), std::back_inserter(now));
    const bool has_more = !std::ranges::includes(moving_, now);
    const bool is_other = !scene_.has_value();
    scene_ = scene;
    if (!has_more) return !is_other;
    std::vector<std::uint32_t> all;
    std::ranges::set_union(moving_, now, std::back_inserter(all));
    moving_ = std::move(all);
    still_.assign(scene.instances().size(), 1);
    for (const std::uint32_t instance : moving_)
        still_[instance] = 0;
    return false;
}

std::vector<CasterPlace> MovingCasters::places() const {
    std::vector<CasterPlace> places;
    for (const std::uint32_t i : moving_) {
        const Instance& instance = scene_->instances()[i];
        places.push_back(
            {instance.world_from_local, scene_->mesh_bounds(instance.mesh), shapes_[i]});
    }
    return places;
}

std::vector<TexelRect> MovingCasters::changed(const LightFit& fit,
                                              std::span<const CasterPlace> before) const {
    const std::vector<CasterPlace> now = places();
    std::vector<TexelRect> rects;
    for (std::size_t i = 0; i < now.size(); ++i) {
        if (now[i].same_as(before[i])) continue;
        for (const CasterPlace& place : {before[i], now[i]})
            rects.push_back(covered_texels(fit, place.world_from_local, place.local));
    }
    return apart(rects);
}

std::vector<std::uint8_t> MovingCasters::reaching(const LightFit& fit,
                                                  std::span<const TexelRect> texels) const {
    const std::vector<CasterPlace> now = places();
    std::vector<std::uint8_t> reaching(still_.size(), 0);
    for (std::size_t i = 0; i < now.size(); ++i) {
        const TexelRect covers = covered_texels(fit, now[i].world_from_local, now[i].local);
        const bool meets =
            covers.area() > 0 && std::ranges::any_of(texels, [&](const TexelRect& rect) {
                return overlap(rect, covers);
            });
        reaching[moving_[i]] = meets ? 1 : 0;
    }
    return reaching;
}

}  // namespace gnomon
