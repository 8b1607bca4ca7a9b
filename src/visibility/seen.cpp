#include "visibility/seen.h"

#include "visibility/light_view.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace gnomon {

namespace {

/// Of all of the box, seen or not.
DepthRange depth_range(const glm::dvec4& depth, const Box3& box) {
    return {-reach(-depth, box), reach(depth, box)};
}

double nearest_seen_m(const Camera& camera, Extent size, const Box3& box, const glm::dvec4& depth) {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const DVec3& p : visible_corners(camera, size, box))
        nearest_m = std::min(nearest_m, glm::dot(DVec3(depth), p) + depth.w);
    return nearest_m;
}

bool outside_of_any(std::span<const glm::dvec4> planes, const Box3& box) {
    return std::ranges::any_of(planes,
                               [&](const glm::dvec4& plane) { return reach(plane, box) < 0.0; });
}

struct SeenBox {
    const Box3* box;
    double near_m;
};

}  // namespace

Seen Seen::within(DepthRange part, std::span<const glm::dvec4> planes) const {
    if (tiles.empty()) {
        return {
            bounds, {std::max(range.near_m, part.near_m), std::min(range.far_m, part.far_m)}, {}};
    }
    std::vector<SeenTile> inside;
    for (const SeenTile& tile : tiles) {
        const DepthRange both{std::max(tile.range.near_m, part.near_m),
                              std::min(tile.range.far_m, part.far_m)};
        if (both.far_m < both.near_m || outside_of_any(planes, tile.bounds)) continue;
        inside.push_back({tile.bounds, both});
    }
    return seen_in(std::move(inside));
}

std::vector<DepthRange> Seen::occupied() const {
    if (tiles.empty()) return {range};
    std::vector<DepthRange> ranges;
    for (const SeenTile& tile : tiles)
        ranges.push_back(tile.range);
    std::ranges::sort(ranges, {}, &DepthRange::near_m);
    std::vector<DepthRange> apart{ranges.front()};
    for (const DepthRange& next : ranges) {
        if (next.near_m > apart.back().far_m) {
            apart.push_back(next);
        } else {
            apart.back().far_m = std::max(apart.back().far_m, next.far_m);
        }
    }
    return apart;
}

Seen seen_in(std::vector<SeenTile> tiles) {
    if (tiles.empty()) return {{}, {0.0, 0.0}, {}};
    Seen seen{{}, {std::numeric_limits<double>::infinity(), 0.0}, std::move(tiles)};
    for (const SeenTile& tile : seen.tiles) {
        seen.bounds.include(tile.bounds.min);
        seen.bounds.include(tile.bounds.max);
        seen.range.near_m = std::min(seen.range.near_m, tile.range.near_m);
        seen.range.far_m = std::max(seen.range.far_m, tile.range.far_m);
    }
    return seen;
}

Seen seen_part(const Camera& camera, Extent size, std::span<const Box3> boxes_ws) {
    Box3 all;
    for (const Box3& box : boxes_ws) {
        if (box.empty()) continue;
        all.include(box.min);
        all.include(box.max);
    }
    const std::vector<glm::dvec4> planes = visible_planes(camera, size, all);
    if (planes.empty()) return {{}, {0.0, 0.0}, {}};

    const glm::dmat4 view(camera.view_from_world);
    const glm::dvec4 depth(-view[0].z, -view[1].z, -view[2].z, -view[3].z);
    Seen seen{{}, {std::numeric_limits<double>::infinity(), 0.0}, {}};
    std::vector<SeenBox> boxes;
    for (const Box3& box : boxes_ws) {
        if (box.empty() || outside_of_any(planes, box)) continue;
        const DepthRange range = depth_range(depth, box);
        boxes.push_back({&box, range.near_m});
        seen.range.far_m = std::max(seen.range.far_m, range.far_m);
        seen.bounds.include(box.min);
        seen.bounds.include(box.max);
    }
    // A box begins before the first point of it that is seen, often behind the camera. Nearest
    // first, few need be cut by the frustum to find the nearest of all.
    std::ranges::sort(boxes, {}, &SeenBox::near_m);
    for (const SeenBox& candidate : boxes) {
        if (candidate.near_m >= seen.range.near_m) break;
        seen.range.near_m =
            std::min(seen.range.near_m, nearest_seen_m(camera, size, *candidate.box, depth));
    }
    seen.range.near_m = std::max(seen.range.near_m, static_cast<double>(camera.near_m));
    return seen;
}

LightFit fit_to_seen(const Frame& frame, const Seen& seen, unsigned size_texels,
                     float margin_texels) {
    const Box3 bounds = frame.scene.bounds();
    if (const auto* sun = std::get_if<DirectionalLight>(&frame.light)) {
        return fit_directional(*sun,
                               visible_corners(frame.camera, frame.size, seen.bounds, seen.range),
                               bounds, size_texels, margin_texels);
    }
    const LightView view = spot_view(std::get<SpotLight>(frame.light));
    const std::vector<DVec3> receivers_ws =
        visible_corners(frame.camera, frame.size, seen.bounds, seen.range, view.planes());
    return fit_view(receivers_ws.empty() ? view : fitted(view, receivers_ws), bounds, size_texels,
                    margin_texels);
}

}  // namespace gnomon
