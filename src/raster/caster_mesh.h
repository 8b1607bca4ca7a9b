#pragma once

#include <gnomon/scene.h>

#include "scene/winding.h"

#include <cstdint>
#include <vector>

namespace gnomon::raster {

/// Consecutive triangles of a CasterMesh.
struct CasterLevel {
    std::uint32_t first_triangle = 0, triangle_count = 0;
    float error_m = 0.0f;  ///< how far they are from the mesh's own, about, in its space
};

/// Triangles of a mesh that lie close together.
struct MeshCluster {
    Box3 bounds;                      ///< in the mesh's space
    std::vector<CasterLevel> levels;  ///< all of them first, then ever fewer
};

/// A mesh as a caster: its triangles in an order in which neighbours are near each other, cut into
/// clusters, so that a map needs to draw only those that can cast into it, and each no finer than
/// its texels show.
struct CasterMesh {
    std::vector<UVec3> triangles;
    std::vector<MeshCluster> clusters;
    scene::Winding winding =
        scene::Winding::open;  ///< of all of it; open when it was not asked to simplify
};

enum class Simplify { no, yes };

/// Meshes of no more than `cluster_triangles` stay whole. Simplified levels keep to positions
/// alone, and to the borders between clusters. Order, vertex reuse and simplification by
/// meshoptimizer: M. Garland, P. Heckbert, "Surface Simplification Using Quadric Error Metrics",
/// SIGGRAPH 1997.
CasterMesh caster_mesh(const Mesh& mesh, std::uint32_t cluster_triangles, Simplify simplify);

}  // namespace gnomon::raster
