#include "visibility/receiver_mask.h"

#include <glm/ext/matrix_double3x3.hpp>
#include <glm/ext/matrix_double4x4.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace gnomon {

namespace {

/// Along a side of the mask. In a large field twice as many leave out a tenth more triangles, half
/// as many a tenth fewer.
constexpr int kCells = 64;

constexpr double kNoReceiver = std::numeric_limits<double>::infinity();

int cell(double at) {
    return static_cast<int>(std::floor(std::clamp(at, -1.0, static_cast<double>(kCells))));
}

}  // namespace

ReceiverMask::ReceiverMask(const LightFit& fit, std::span<const Box3> receivers_ws,
                           double margin_texels)
    : farthest_(std::size_t{kCells} * kCells, kNoReceiver) {
    assert(fit.affine);
    glm::dmat4 cells_from_clip(1.0);
    cells_from_clip[0][0] = cells_from_clip[1][1] = 0.5 * kCells;
    cells_from_clip[3] = {0.5 * kCells, 0.5 * kCells, 0.0, 1.0};
    cells_from_world_ = cells_from_clip * fit.clip_from_world;
    for (const Box3& box : receivers_ws) {
        const Touched touched = touched_by(box, margin_texels * kCells / fit.size_texels);
        for (int y = touched.y0; y <= touched.y1; ++y) {
            for (int x = touched.x0; x <= touched.x1; ++x) {
                double& farthest = farthest_[static_cast<std::size_t>(y * kCells + x)];
                farthest = std::min(farthest, touched.farthest);
            }
        }
    }
}

bool ReceiverMask::is_before_any(const Box3& box_ws) const {
    if (farthest_.empty()) return true;
    const Touched touched = touched_by(box_ws, 0.0);
    for (int y = touched.y0; y <= touched.y1; ++y) {
        for (int x = touched.x0; x <= touched.x1; ++x) {
            if (farthest_[static_cast<std::size_t>(y * kCells + x)] < touched.nearest) return true;
        }
    }
    return false;
}

ReceiverMask::Touched ReceiverMask::touched_by(const Box3& box_ws, double grown_cells) const {
    const DVec3 center = 0.5 * (DVec3(box_ws.min) + DVec3(box_ws.max));
    const DVec3 half = DVec3(box_ws.max) - center;
    const DVec3 middle(cells_from_world_ * glm::dvec4(center, 1.0));
    DVec3 reach(0.0);
    for (int axis = 0; axis < 3; ++axis)
        reach += half[axis] * glm::abs(DVec3(cells_from_world_[axis]));
    return {.x0 = std::max(cell(middle.x - reach.x - grown_cells), 0),
            .x1 = std::min(cell(middle.x + reach.x + grown_cells), kCells - 1),
            .y0 = std::max(cell(middle.y - reach.y - grown_cells), 0),
            .y1 = std::min(cell(middle.y + reach.y + grown_cells), kCells - 1),
            .farthest = middle.z - reach.z,
            .nearest = middle.z + reach.z};
}

}  // namespace gnomon
