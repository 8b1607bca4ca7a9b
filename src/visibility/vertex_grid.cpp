#include "visibility/vertex_grid.h"

#include "base/parallel.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::vertex_grid {

namespace {

/// How far inside of its triangle a vertex at its edge is sampled, in cells: far more than
/// rounding, so that walls that stand at the edge are on the right side, and less than is seen.
constexpr double kInset_cells = 1.0 / 64.0;

/// Halvings of the range of edges: to 2^-20 of it, finer than anybody sees.
constexpr int kBisections = 20;

constexpr std::size_t kTrianglesPerTask = 4096;

/// Of the triangles that are cut.
std::uint64_t cut_vertices(std::span<const float> longest_m, double edge_m) {
    std::uint64_t count = 0;
    for (const float longest : longest_m) {
        const unsigned parts = parts_for(longest, edge_m);
        if (parts > 1) count += vertex_count(parts);
    }
    return count;
}

float longest_edge_m(const trace::Triangle& triangle) {
    const auto& [a, b, c] = triangle.corners_ws;
    return static_cast<float>(
        std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)}));
}

}  // namespace

std::uint64_t vertex_count(unsigned parts) {
    return (std::uint64_t{parts} + 1) * (std::uint64_t{parts} + 2) / 2;
}

std::uint64_t vertex_index(unsigned parts, GridVertex vertex) {
    // Row 0 has parts + 1 vertices, each next one a vertex less.
    const std::uint64_t j = vertex.j;
    return j * (std::uint64_t{parts} + 1) - (j * j - j) / 2 + vertex.i;
}

DVec3 sampled_at(unsigned parts, GridVertex vertex) {
    const DVec3 cells(parts - vertex.i - vertex.j, vertex.i, vertex.j);
    const DVec3 inside = glm::max(cells, DVec3(kInset_cells));
    return inside / (inside.x + inside.y + inside.z);
}

GridCell cell_at(unsigned parts, DVec3 barycentric) {
    const DVec3 inside = glm::max(barycentric, DVec3(0.0));
    const DVec3 cells = inside * (parts / (inside.x + inside.y + inside.z));
    const unsigned i = std::min(static_cast<unsigned>(cells.y), parts - 1);
    const unsigned j = std::min(static_cast<unsigned>(cells.z), parts - 1 - i);
    const double x = cells.y - i, y = cells.z - j;
    if (x + y > 1.0 && i + j + 2 <= parts) {
        return {{GridVertex{i + 1, j + 1}, {i, j + 1}, {i + 1, j}},
                glm::max(DVec3(x + y - 1.0, 1.0 - x, 1.0 - y), DVec3(0.0))};
    }
    const DVec3 weights = glm::max(DVec3(1.0 - x - y, x, y), DVec3(0.0));
    return {{GridVertex{i, j}, {i + 1, j}, {i, j + 1}},
            weights / (weights.x + weights.y + weights.z)};
}

unsigned parts_for(double longest_m, double edge_m) {
    if (!(edge_m > 0.0 && longest_m > edge_m)) return 1;
    // More are never afforded.
    constexpr double kMostParts = 1 << 20;
    return static_cast<unsigned>(std::min(std::ceil(longest_m / edge_m), kMostParts));
}

double affordable_edge_m(std::span<const float> longest_m, double edge_m,
                         std::uint64_t most_vertices) {
    if (edge_m == 0.0 || cut_vertices(longest_m, edge_m) <= most_vertices) return edge_m;
    double dear_m = edge_m, enough_m = *std::ranges::max_element(longest_m);
    for (int i = 0; i < kBisections; ++i) {
        // Of the ratio, as edges may be of any size.
        const double middle_m = std::sqrt(dear_m * enough_m);
        (cut_vertices(longest_m, middle_m) <= most_vertices ? enough_m : dear_m) = middle_m;
    }
    return enough_m;
}

SceneGrid::SceneGrid(const Scene& scene, double edge_m, std::uint64_t most_vertices) {
    const std::vector<Instance>& instances = scene.instances();
    triangles_.reserve(scene.triangle_count());
    for (std::uint32_t instance = 0; instance < instances.size(); ++instance) {
        first_of_instance_.push_back(triangles_.size());
        const std::size_t count = scene.meshes()[instances[instance].mesh].triangles.size();
        for (std::uint32_t primitive = 0; primitive < count; ++primitive)
            triangles_.push_back({.id = {instance, primitive}});
    }
    std::vector<float> longest_m(triangles_.size());
    parallel_for(triangles_.size(), kTrianglesPerTask, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            longest_m[i] = longest_edge_m(trace::world_triangle(scene, triangles_[i].id));
    });
    edge_m_ = affordable_edge_m(longest_m, edge_m, most_vertices);
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
        TriangleGrid& grid = triangles_[i];
        grid.parts = parts_for(longest_m[i], edge_m_);
        grid.cell_m = longest_m[i] / static_cast<float>(grid.parts);
        grid.first = vertex_count_;
        vertex_count_ += vertex_grid::vertex_count(grid.parts);
    }
}

DVec3 position_ws(const trace::Triangle& triangle, DVec3 barycentric) {
    const auto& [a, b, c] = triangle.corners_ws;
    return barycentric.x * a + barycentric.y * b + barycentric.z * c;
}

void place_vertices(const Scene& scene, const TriangleGrid& grid, bool front,
                    std::span<trace::Receiver> out) {
    const trace::Triangle triangle = trace::world_triangle(scene, grid.id);
    const Mesh& mesh = scene.meshes()[scene.instances()[grid.id.instance].mesh];
    const DVec3 normal = triangle.front_normal_ws();
    const double area2 = glm::length(normal);
    if (!(area2 > 0.0) || (!front && !scene.materials()[mesh.material].double_sided)) return;
    const Vec3 normal_ws((front ? 1.0 : -1.0) / area2 * normal);
    std::size_t at = 0;
    for (unsigned j = 0; j <= grid.parts; ++j) {
        for (unsigned i = 0; i + j <= grid.parts; ++i, ++at) {
            const Vec3 p_ws(position_ws(triangle, sampled_at(grid.parts, {i, j})));
            out[at] = {p_ws, normal_ws, {trace::kNoSurface, 0}};
        }
    }
}

std::uint64_t SceneGrid::memory_bytes() const {
    return triangles_.size() * sizeof(TriangleGrid) +
           first_of_instance_.size() * sizeof(std::uint64_t);
}

}  // namespace gnomon::vertex_grid
