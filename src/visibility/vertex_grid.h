#pragma once

#include <gnomon/scene.h>

#include "trace/receiver.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::vertex_grid {

/// A vertex of the grid in a triangle whose edges are each cut into `parts`: at the barycentric
/// coordinates (1 - (i + j) / parts, i / parts, j / parts), i + j <= parts.
struct GridVertex {
    unsigned i = 0, j = 0;
    bool operator==(const GridVertex&) const = default;
};

std::uint64_t vertex_count(unsigned parts);
/// Row after row, in [0, vertex_count(parts)).
std::uint64_t vertex_index(unsigned parts, GridVertex vertex);

/// Where a vertex is sampled, barycentric: a little inside of the triangle, as at its edges it is
/// on the walls, too, that stand there.
DVec3 sampled_at(unsigned parts, GridVertex vertex);

/// The cell of the grid around a place: its corners, and their shares in what is there, which are
/// not negative and add up to 1.
struct GridCell {
    std::array<GridVertex, 3> vertices;
    DVec3 weights{0.0};
};

/// `barycentric` adds up to 1; what rounding has put outside of the triangle counts as on its edge.
GridCell cell_at(unsigned parts, DVec3 barycentric);

/// How many parts the edges of a triangle are cut into, so that none is longer than `edge_m`; 1 if
/// that is 0.
unsigned parts_for(double longest_m, double edge_m);

/// The least edge, from `edge_m` on, at which the triangles that it cuts have no more than
/// `most_vertices` together. 0 stays 0.
double affordable_edge_m(std::span<const float> longest_m, double edge_m,
                         std::uint64_t most_vertices);

/// The grid of a triangle of the scene.
struct TriangleGrid {
    trace::SurfaceId id;
    unsigned parts = 1;
    float cell_m = 0.0f;      ///< the longest edge of its cells
    std::uint64_t first = 0;  ///< of its vertices among the scene's
};

/// The grids of all triangles, those of an instance one after the other.
class SceneGrid {
public:
    SceneGrid() = default;
    /// `edge_m`: how long edges may be, unless that takes more than `most_vertices` in the
    /// triangles that it cuts. 0 cuts none.
    SceneGrid(const Scene& scene, double edge_m, std::uint64_t most_vertices);

    std::span<const TriangleGrid> triangles() const { return triangles_; }
    const TriangleGrid& of(trace::SurfaceId id) const {
        return triangles_[first_of_instance_[id.instance] + id.primitive];
    }
    std::uint64_t vertex_count() const { return vertex_count_; }
    double edge_m() const { return edge_m_; }  ///< as afforded
    std::uint64_t memory_bytes() const;

private:
    std::vector<std::uint64_t> first_of_instance_;
    std::vector<TriangleGrid> triangles_;
    std::uint64_t vertex_count_ = 0;
    double edge_m_ = 0.0;
};

/// Where barycentric coordinates are in the world.
DVec3 position_ws(const trace::Triangle& triangle, DVec3 barycentric);

/// The grid's vertices on a side of the triangle as receivers, vertex_count() of them; left as they
/// are where that side is not seen. They are on no surface: in the plane of a solid's face a vertex
/// counts as outside of it, wherever the rest of its triangle lies.
void place_vertices(const Scene& scene, const TriangleGrid& grid, bool front,
                    std::span<trace::Receiver> out);

}  // namespace gnomon::vertex_grid
