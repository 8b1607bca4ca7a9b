#pragma once

#include "trace/tracer.h"
#include "visibility/vertex_grid.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

/// Receivers take nothing from vertices behind a wall, which are dark within whatever stands on the
/// ground: else a dark hem goes around it, a cell wide, on its lit side.
namespace gnomon::vertex_grid {

/// Rays from a receiver to the corners of its cell.
struct CornerRays {
    trace::Receiver lifted;
    std::array<Vec3, 3> to_corners_ws{};
};

CornerRays corner_rays(const trace::Receiver& receiver, const trace::Triangle& triangle,
                       const TriangleGrid& grid, const GridCell& cell);

/// Of each one's corners whether something stands before it: 1 or 0. Runs on the calling thread.
std::vector<std::array<std::uint8_t, 3>> hidden_corners(const trace::Tracer& tracer,
                                                        std::span<const CornerRays> rays);

}  // namespace gnomon::vertex_grid
