#include "visibility/seen.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
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

struct SeenBox {
    const Box3* box;
    double near_m;
};

}  // namespace

Seen seen_part(const Camera& camera, Extent size, std::span<const Box3> boxes_ws) {
    Box3 all;
    for (const Box3& box : boxes_ws) {
        if (box.empty()) continue;
        all.include(box.min);
        all.include(box.max);
    }
    const std::vector<glm::dvec4> planes = visible_planes(camera, size, all);
    if (planes.empty()) return {{}, {0.0, 0.0}};

    const glm::dmat4 view(camera.view_from_world);
    const glm::dvec4 depth(-view[0].z, -view[1].z, -view[2].z, -view[3].z);
    Seen seen{{}, {std::numeric_limits<double>::infinity(), 0.0}};
    std::vector<SeenBox> boxes;
    for (const Box3& box : boxes_ws) {
        if (box.empty() || std::ranges::any_of(planes, [&](const glm::dvec4& plane) {
                return reach(plane, box) < 0.0;
            })) {
            continue;
        }
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

}  // namespace gnomon
