/// Both surfaces of a shell are one grid of directions, cut along an outline by marching squares
/// (W. Lorensen and H. Cline, "Marching cubes", 1987, in two dimensions). The walls of the holes
/// join the two surfaces along the cut. Vertices are shared by key, so nothing can gape.

#include "scene/builtin_carved_shell.h"

#include "scene/shapes.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace gnomon::scene {

namespace {

using Index = std::uint32_t;

/// A grid of directions cut along an outline.
struct CutGrid {
    std::vector<Vec3> directions;                    ///< unit vectors
    std::vector<UVec3> triangles;                    ///< of what is left, seen from outside
    std::vector<std::pair<Index, Index>> cut_edges;  ///< what is left lies on their left
};

class GridCutter {
public:
    GridCutter(int sides, int rings, const CarvedOutline& outline)
        : sides_(static_cast<Index>(sides)), rings_(static_cast<Index>(rings)) {
        add_directions();
        values_.reserve(grid_.directions.size());
        for (const Vec3 direction : grid_.directions)
            values_.push_back(outline ? outline(direction) : 1.0f);
    }

    CutGrid cut() && {
        for (Index ring = 0; ring < rings_; ++ring) {
            for (Index side = 0; side < sides_; ++side)
                cut_cell(side, ring);
        }
        return std::move(grid_);
    }

private:
    void add_directions() {
        const std::vector<Vec2> meridian = unit_circle(static_cast<int>(2 * rings_));
        const std::vector<Vec2> parallel = unit_circle(static_cast<int>(sides_));
        grid_.directions.emplace_back(0.0f, -1.0f, 0.0f);
        for (Index ring = 1; ring < rings_; ++ring) {
            for (const Vec2 c : parallel) {
                const float r = meridian[ring].y;
                grid_.directions.emplace_back(r * c.x, -meridian[ring].x, -r * c.y);
            }
        }
        grid_.directions.emplace_back(0.0f, 1.0f, 0.0f);
    }

    Index grid_vertex(Index side, Index ring) const {
        if (ring == 0) return 0;
        if (ring == rings_) return 1 + (rings_ - 1) * sides_;
        return 1 + (ring - 1) * sides_ + side % sides_;
    }

    bool solid(Index vertex) const { return values_[vertex] > 0.0f; }

    /// Where the outline crosses the edge between two grid vertices.
    Index cut_vertex(Index a, Index b) {
        if (a > b) std::swap(a, b);
        const auto [entry, is_new] =
            cut_vertices_.try_emplace({a, b}, static_cast<Index>(grid_.directions.size()));
        if (is_new) {
            // Away from the ends, or there would be triangles of no area.
            constexpr float kMargin = 0.05f;
            const float t =
                glm::clamp(values_[a] / (values_[a] - values_[b]), kMargin, 1.0f - kMargin);
            grid_.directions.push_back(
                normalize(glm::mix(grid_.directions[a], grid_.directions[b], t)));
        }
        return entry->second;
    }

    void cut_cell(Index side, Index ring) {
        // Counter-clockwise seen from outside; at the poles two corners are one.
        std::vector<Index> corners{grid_vertex(side, ring), grid_vertex(side + 1, ring),
                                   grid_vertex(side + 1, ring + 1), grid_vertex(side, ring + 1)};
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        std::vector<Index> left;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Index a = corners[i];
            const Index b = corners[(i + 1) % corners.size()];
            if (solid(a)) left.push_back(a);
            if (solid(a) != solid(b)) left.push_back(cut_vertex(a, b));
        }
        const std::size_t grid_size = values_.size();
        for (std::size_t i = 0; i < left.size(); ++i) {
            const Index a = left[i];
            const Index b = left[(i + 1) % left.size()];
            if (a >= grid_size && b >= grid_size && leaves_solid(corners, a)) {
                grid_.cut_edges.emplace_back(a, b);
            }
            if (i >= 2) grid_.triangles.push_back({left[0], left[i - 1], left[i]});
        }
    }

    /// True when the edge of the cell on which `cut` lies goes from solid to hole: there the walk
    /// about the cell turns onto the outline.
    bool leaves_solid(const std::vector<Index>& corners, Index cut) {
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Index a = corners[i];
            const Index b = corners[(i + 1) % corners.size()];
            if (solid(a) && !solid(b) && cut_vertex(a, b) == cut) return true;
        }
        return false;
    }

    Index sides_, rings_;
    CutGrid grid_;
    std::vector<float> values_;  // of the outline at the grid's vertices
    std::map<std::pair<Index, Index>, Index> cut_vertices_;
};

/// Adds the surface over a grid with smooth normals; `inside_out` turns it to face the origin.
void add_surface(Mesh& mesh, const CutGrid& grid, const StarSurface& surface, bool inside_out) {
    const auto first = static_cast<Index>(mesh.positions.size());
    for (const Vec3 direction : grid.directions)
        mesh.positions.push_back(surface(direction));
    mesh.normals.resize(mesh.positions.size(), Vec3(0.0f));
    for (const UVec3 t : grid.triangles) {
        const UVec3 turned = first + (inside_out ? UVec3(t.x, t.z, t.y) : t);
        mesh.triangles.push_back(turned);
        const Vec3 a = mesh.positions[turned.x];
        // Its length is twice the area: larger triangles weigh more.
        const Vec3 normal = glm::cross(mesh.positions[turned.y] - a, mesh.positions[turned.z] - a);
        for (int corner = 0; corner < 3; ++corner)
            mesh.normals[turned[corner]] += normal;
    }
    for (std::size_t i = 0; i < grid.directions.size(); ++i) {
        Vec3& normal = mesh.normals[first + i];
        const bool used = glm::dot(normal, normal) > 0.0f;
        normal = used ? normalize(normal) : grid.directions[i];
    }
}

/// Removes vertices that no triangle uses: those within the holes.
Mesh compacted(const Mesh& mesh) {
    constexpr Index kUnused = ~Index{0};
    std::vector<Index> moved_to(mesh.positions.size(), kUnused);
    Mesh result;
    for (UVec3 t : mesh.triangles) {
        for (int corner = 0; corner < 3; ++corner) {
            Index& index = moved_to[t[corner]];
            if (index == kUnused) {
                index = static_cast<Index>(result.positions.size());
                result.positions.push_back(mesh.positions[t[corner]]);
                result.normals.push_back(mesh.normals[t[corner]]);
            }
            t[corner] = index;
        }
        result.triangles.push_back(t);
    }
    return result;
}

}  // namespace

Mesh star_solid(const StarSurface& surface, int sides, int rings) {
    Mesh mesh;
    add_surface(mesh, GridCutter(sides, rings, nullptr).cut(), surface, false);
    return mesh;
}

Mesh carved_shell(const StarSurface& outer, const StarSurface& inner, const CarvedOutline& outline,
                  int sides, int rings) {
    const CutGrid grid = GridCutter(sides, rings, outline).cut();
    Mesh mesh;
    add_surface(mesh, grid, outer, false);
    add_surface(mesh, grid, inner, true);
    const auto inner_first = static_cast<Index>(grid.directions.size());
    for (const auto& [a, b] : grid.cut_edges) {
        const std::array wall{mesh.positions[b], mesh.positions[a], mesh.positions[inner_first + a],
                              mesh.positions[inner_first + b]};
        const Vec3 normal = normalize(glm::cross(wall[2] - wall[0], wall[3] - wall[1]));
        const auto first = static_cast<Index>(mesh.positions.size());
        for (const Vec3 p : wall) {
            mesh.positions.push_back(p);
            mesh.normals.push_back(normal);
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    }
    return compacted(mesh);
}

}  // namespace gnomon::scene
