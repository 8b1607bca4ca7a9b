#include "raster/caster_mesh.h"

#include <glm/geometric.hpp>
#include <meshoptimizer.h>

#include <algorithm>
#include <span>
#include <unordered_map>

namespace gnomon::raster {

namespace {

/// Each level aims at this share of the triangles of the one before, and is not worth having with
/// more than the other.
constexpr double kLevelShare = 0.4;
constexpr double kWorthwhileShare = 0.75;
/// A level that loses more of the area has lost leaves, each smaller than the error, but all of a
/// tree.
constexpr double kLeastArea = 0.95;
/// A level of fewer triangles saves nothing.
constexpr std::size_t kLeastTriangles = 8;

unsigned* indices_of(std::span<UVec3> triangles) {
    return &triangles.front().x;
}

const unsigned* indices_of(std::span<const UVec3> triangles) {
    return &triangles.front().x;
}

/// Some triangles of a mesh with vertices of their own, so that simplifying them does not walk
/// through all of the mesh's.
struct Part {
    std::vector<Vec3> positions;
    std::vector<unsigned> vertices;  ///< of the mesh
    std::vector<UVec3> triangles;

    Part(const Mesh& mesh, std::span<const UVec3> from) {
        std::unordered_map<unsigned, unsigned> own;
        for (UVec3 triangle : from) {
            for (int i = 0; i < 3; ++i) {
                const auto [found, is_new] =
                    own.try_emplace(triangle[i], static_cast<unsigned>(vertices.size()));
                if (is_new) {
                    vertices.push_back(triangle[i]);
                    positions.push_back(mesh.positions[triangle[i]]);
                }
                triangle[i] = found->second;
            }
            triangles.push_back(triangle);
        }
    }
};

double area_of(std::span<const Vec3> positions, std::span<const UVec3> triangles) {
    double area = 0.0;
    for (const UVec3& t : triangles) {
        const Vec3 a = positions[t.x];
        area += 0.5 * static_cast<double>(
                          glm::length(glm::cross(positions[t.y] - a, positions[t.z] - a)));
    }
    return area;
}

/// Appends ever simpler triangles of the cluster to those of `result`. Borders stay: clusters go on
/// meeting there, and an open sheet does not vanish, as one that may shrink from its border would.
void add_levels(const Mesh& mesh, CasterMesh& result, MeshCluster& cluster) {
    const CasterLevel finest = cluster.levels.front();
    const Part part(
        mesh, std::span(result.triangles).subspan(finest.first_triangle, finest.triangle_count));
    const float* positions = &part.positions.front().x;
    const float scale_m = meshopt_simplifyScale(positions, part.positions.size(), sizeof(Vec3));
    const double area = area_of(part.positions, part.triangles);
    std::vector<UVec3> simpler(part.triangles.size());
    for (std::size_t before = part.triangles.size(); before > kLeastTriangles;) {
        const auto target = static_cast<std::size_t>(kLevelShare * static_cast<double>(before));
        float error = 0.0f;
        const std::size_t count =
            meshopt_simplify(indices_of(std::span(simpler)), indices_of(std::span(part.triangles)),
                             3 * part.triangles.size(), positions, part.positions.size(),
                             sizeof(Vec3), 3 * target, 1.0f, meshopt_SimplifyLockBorder, &error) /
            3;
        if (count == 0 ||
            static_cast<double>(count) > kWorthwhileShare * static_cast<double>(before)) {
            break;
        }
        if (area_of(part.positions, std::span(simpler).first(count)) < kLeastArea * area) break;
        cluster.levels.push_back({static_cast<std::uint32_t>(result.triangles.size()),
                                  static_cast<std::uint32_t>(count), error * scale_m});
        meshopt_optimizeVertexCache(indices_of(std::span(simpler)), indices_of(std::span(simpler)),
                                    3 * count, part.positions.size());
        for (const UVec3& t : std::span(simpler).first(count)) {
            result.triangles.emplace_back(part.vertices[t.x], part.vertices[t.y],
                                          part.vertices[t.z]);
        }
        before = count;
    }
}

Box3 bounds_of(const Mesh& mesh, std::span<const UVec3> triangles) {
    Box3 bounds;
    for (const UVec3& triangle : triangles) {
        for (int i = 0; i < 3; ++i)
            bounds.include(mesh.positions[triangle[i]]);
    }
    return bounds;
}

}  // namespace

CasterMesh caster_mesh(const Mesh& mesh, std::uint32_t cluster_triangles, Simplify simplify) {
    CasterMesh result{.triangles = mesh.triangles};
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    if (count == 0) return result;
    const std::span<UVec3> all(result.triangles);
    if (simplify == Simplify::yes) {  // vertices that differ in other attributes only become one
        meshopt_generateShadowIndexBuffer(indices_of(all), indices_of(std::span(mesh.triangles)),
                                          3 * std::size_t{count}, mesh.positions.data(),
                                          mesh.positions.size(), sizeof(Vec3), sizeof(Vec3));
        result.winding = scene::winding_of(mesh.positions, all);
    }
    if (count > cluster_triangles) {
        const std::vector<UVec3> unsorted = result.triangles;
        meshopt_spatialSortTriangles(indices_of(all), indices_of(std::span(unsorted)),
                                     3 * std::size_t{count}, &mesh.positions.front().x,
                                     mesh.positions.size(), sizeof(Vec3));
    }
    for (std::uint32_t first = 0; first < count; first += cluster_triangles) {
        const std::span<UVec3> triangles =
            all.subspan(first, std::min(cluster_triangles, count - first));
        meshopt_optimizeVertexCache(indices_of(triangles), indices_of(triangles),
                                    3 * triangles.size(), mesh.positions.size());
        result.clusters.push_back({bounds_of(mesh, triangles),
                                   {{first, static_cast<std::uint32_t>(triangles.size()), 0.0f}}});
    }
    if (simplify == Simplify::yes) {
        for (MeshCluster& cluster : result.clusters)
            add_levels(mesh, result, cluster);
    }
    return result;
}

}  // namespace gnomon::raster
