#pragma once

#include "scene/gltf_document.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/ext/quaternion_double.hpp>
#include <glm/ext/vector_double3.hpp>

#include <optional>
#include <vector>

namespace gnomon::scene {

/// A node's own transform: a matrix, or translation * rotation * scale.
struct NodeTransform {
    std::optional<glm::dmat4> matrix;
    glm::dvec3 translation{0.0};
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  // w, x, y, z
    glm::dvec3 scale{1.0};

    glm::dmat4 parent_from_node() const;
};

/// The nodes at one time of one animation, in the order of "nodes".
struct Pose {
    std::vector<NodeTransform> transforms;
    std::vector<std::vector<double>> morph_weights;  // empty = those of the mesh
    std::vector<glm::dmat4> world_from_node;
};

/// The nodes as the file has them, moved by the animation and time of the options.
/// Throws Error{input} when nodes form a loop or one has two parents, and when the file has
/// animations, but not the one that is asked for.
Pose pose_nodes(GltfDocument& document, LoadContext& context);

/// Nodes of the scene to show and all below them, parents first.
std::vector<int> visible_nodes(const GltfDocument& document, LoadContext& context);

}  // namespace gnomon::scene
