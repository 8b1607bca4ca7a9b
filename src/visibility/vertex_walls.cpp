#include "visibility/vertex_walls.h"

#include <algorithm>

namespace gnomon::vertex_grid {

namespace {

/// How high above the surface, in cells, a receiver looks for its vertices: higher than what lies
/// on it, such as a road's markings, lower than a wall.
constexpr double kLookHeight_cells = 1.0 / 32.0;

}  // namespace

CornerRays corner_rays(const trace::Receiver& receiver, const trace::Triangle& triangle,
                       const TriangleGrid& grid, const GridCell& cell) {
    const DVec3 p_ws(receiver.position_ws);
    CornerRays rays{.lifted = receiver};
    rays.lifted.position_ws = Vec3(p_ws + kLookHeight_cells * static_cast<double>(grid.cell_m) *
                                              DVec3(receiver.normal_ws));
    for (std::size_t k = 0; k < rays.to_corners_ws.size(); ++k) {
        const DVec3 vertex_ws = position_ws(triangle, sampled_at(grid.parts, cell.vertices[k]));
        rays.to_corners_ws[k] = Vec3(vertex_ws - p_ws);
    }
    return rays;
}

std::vector<std::array<std::uint8_t, 3>> hidden_corners(const trace::Tracer& tracer,
                                                        std::span<const CornerRays> rays) {
    std::vector<trace::ShadowRay> all;
    for (const CornerRays& of_one : rays) {
        for (const Vec3 to_corner_ws : of_one.to_corners_ws)
            all.push_back({&of_one.lifted, to_corner_ws, false});
    }
    std::vector<std::uint8_t> blocked(all.size());
    tracer.blocked(all, blocked);
    std::vector<std::array<std::uint8_t, 3>> hidden(rays.size());
    for (std::size_t i = 0; i < all.size(); ++i)
        hidden[i / 3][i % 3] = blocked[i];
    return hidden;
}

}  // namespace gnomon::vertex_grid
