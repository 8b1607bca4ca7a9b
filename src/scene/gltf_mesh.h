#pragma once

#include "scene/gltf_document.h"
#include "scene/load_draft.h"

#include <glm/ext/matrix_double4x4.hpp>

#include <span>
#include <string>
#include <vector>

namespace gnomon::scene {

/// One primitive, not yet repaired: triangles from any of glTF's modes, its streams, moved by the
/// morph targets. Without triangles when the primitive has points, lines or no positions.
/// `texcoord_set`: n of the TEXCOORD_n that the texture uses, -1 = none; TEXCOORD_1 is read as the
/// light map's besides. The mesh's material is not set.
Mesh read_primitive(GltfDocument& document, const tinygltf::Primitive& primitive,
                    const std::string& name, std::span<const double> morph_weights,
                    int texcoord_set, Warnings& warnings);

/// Corner indices as triangles, for mode TRIANGLES, TRIANGLE_STRIP or TRIANGLE_FAN.
std::vector<UVec3> triangles_from(int mode, const std::vector<std::uint32_t>& corners);

/// Moves a mesh that read_primitive made to where the joints hold it, in world space: vertex =
/// sum of weight * world_from_joint * inverse bind matrix. Positions are then relative to the
/// draft's origin, which is near the first joint when that is far from the world's. False, and
/// nothing done, when the primitive has no joints.
bool bake_skin(GltfDocument& document, const tinygltf::Primitive& primitive, int skin,
               std::span<const glm::dmat4> world_from_node, DraftMesh& draft, Warnings& warnings);

}  // namespace gnomon::scene
