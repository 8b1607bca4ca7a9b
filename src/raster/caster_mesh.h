#pragma once

#include <gnomon/scene.h>

#include <cstdint>
#include <vector>

namespace gnomon::raster {

/// Triangles of a mesh that lie close together.
struct MeshCluster {
    std::uint32_t first_triangle = 0, triangle_count = 0;
    Box3 bounds;  ///< in the mesh's space
};

/// A mesh as a caster: its triangles in an order in which neighbours are near each other, cut into
/// clusters, so that a map needs to draw only those that can cast into it.
struct CasterMesh {
    std::vector<UVec3> triangles;
    std::vector<MeshCluster> clusters;  ///< in the order of their triangles, all of them
};

/// Meshes of no more than `cluster_triangles` stay whole. Order and vertex reuse by meshoptimizer.
CasterMesh caster_mesh(const Mesh& mesh, std::uint32_t cluster_triangles);

}  // namespace gnomon::raster
