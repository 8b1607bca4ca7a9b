#pragma once

#include <gnomon/scene.h>

#include <cstdint>
#include <vector>

namespace gnomon::shadow_volumes {

/// A triangle at an edge: its index, and whether it runs along the edge from v0 to v1.
struct EdgeUse {
    std::uint32_t triangle : 31;
    std::uint32_t forward : 1;
};

struct Edge {
    std::uint32_t v0 = 0, v1 = 0;  ///< v0 < v1
    std::uint32_t first_use = 0;   ///< its uses end where those of the next edge begin
};

/// Which triangles meet at which edges of a mesh, whatever the mesh is: open, with edges of three
/// triangles, or in pieces. Vertices at the same place are one. Triangles whose corners are not
/// three places are left out.
struct Adjacency {
    std::vector<UVec3> triangles;  ///< corners, as indices into Mesh::positions
    std::vector<Edge> edges;       ///< and one more, whose first_use is uses.size()
    std::vector<EdgeUse> uses;
    /// Of each triangle: its connected piece has no boundary and a consistent winding, so that it
    /// encloses a solid...
    std::vector<bool> closed;
    /// ...and then: the winding is clockwise seen from outside.
    std::vector<bool> inside_out;
};

Adjacency find_adjacency(const Mesh& mesh);

}  // namespace gnomon::shadow_volumes
