#pragma once

#include <gnomon/scene.h>

#include "adjacency.h"
#include "shadow_volumes.shared.h"

#include <cstdint>
#include <vector>

namespace gnomon::shadow_volumes {

/// The light as a point of projective space: (position, 1) or (direction to the light, 0).
using HomogeneousLight = Vec4;

/// The shadow volume of one instance: its caps' triangles, counter-clockwise seen from the light or
/// clockwise, and the edges whose sides close it, run so that the volume is to their left seen from
/// the light. A triangle keeps the order of its corners in the mesh: clipped in another one it has
/// other depths than the receivers on it.
struct Volume {
    std::vector<shared::VolumeTriangle> caps, clockwise_caps;
    std::vector<shared::VolumeSide> sides;
};

/// Which vertices and which instance the records name.
struct VolumeSource {
    std::uint32_t slot = 0;          ///< in the instance buffer
    std::uint32_t first_vertex = 0;  ///< of the mesh in the vertex buffer
};

/// Every point that the instance hides from the light is enclosed at least once, no other point is.
/// A solid's volume is that of its triangles that face the light. Where that is not enough (an open
/// or inconsistent mesh, a light that may be inside) each triangle is turned towards the light and
/// has a volume of its own; sides that two of them share cancel.
Volume build_volume(const Mesh& mesh, const Adjacency& adjacency, const Mat4& world_from_local,
                    HomogeneousLight light_ws, VolumeSource source);

}  // namespace gnomon::shadow_volumes
