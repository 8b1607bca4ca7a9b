#include "raster/caster_mesh.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <span>

namespace gnomon::raster {

namespace {

Box3 bounds_of(const Mesh& mesh, std::span<const UVec3> triangles) {
    Box3 bounds;
    for (const UVec3& triangle : triangles) {
        for (int i = 0; i < 3; ++i)
            bounds.include(mesh.positions[triangle[i]]);
    }
    return bounds;
}

unsigned* indices_of(std::span<UVec3> triangles) {
    return &triangles.front().x;
}

const unsigned* indices_of(std::span<const UVec3> triangles) {
    return &triangles.front().x;
}

}  // namespace

CasterMesh caster_mesh(const Mesh& mesh, std::uint32_t cluster_triangles) {
    CasterMesh result{mesh.triangles, {}};
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    if (count == 0) return result;
    if (count > cluster_triangles) {
        meshopt_spatialSortTriangles(
            indices_of(std::span(result.triangles)), indices_of(std::span(mesh.triangles)),
            3 * std::size_t{count}, &mesh.positions.front().x, mesh.positions.size(), sizeof(Vec3));
    }
    for (std::uint32_t first = 0; first < count; first += cluster_triangles) {
        const std::span<UVec3> triangles =
            std::span(result.triangles).subspan(first, std::min(cluster_triangles, count - first));
        meshopt_optimizeVertexCache(indices_of(triangles), indices_of(triangles),
                                    3 * triangles.size(), mesh.positions.size());
        result.clusters.push_back(
            {first, static_cast<std::uint32_t>(triangles.size()), bounds_of(mesh, triangles)});
    }
    return result;
}

}  // namespace gnomon::raster
