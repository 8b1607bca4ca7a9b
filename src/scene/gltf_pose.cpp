#include "scene/gltf_pose.h"

#include "base/check.h"
#include "scene/gltf_animation.h"

#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace gnomon::scene {

namespace {

// The Khronos validator's tolerance for quaternions written with few digits.
constexpr double kUnitTolerance = 5e-3;

NodeTransform transform_of(const tinygltf::Node& node, Warnings& warnings) {
    NodeTransform transform;
    if (node.matrix.size() == 16) {
        glm::dmat4 matrix;
        for (int i = 0; i < 16; ++i)
            matrix[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
        for (int column = 0; column < 4; ++column) {
            const double affine = column == 3 ? 1.0 : 0.0;
            if (matrix[column][3] != affine) {
                warnings.add("the last row of a node's matrix is taken as 0 0 0 1", node.name);
                matrix[column][3] = affine;
            }
        }
        transform.matrix = matrix;
    }
    if (node.translation.size() == 3) {
        transform.translation = {node.translation[0], node.translation[1], node.translation[2]};
    }
    if (node.scale.size() == 3) transform.scale = {node.scale[0], node.scale[1], node.scale[2]};
    if (node.rotation.size() == 4) {
        transform.rotation =
            glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
        const double length = glm::length(transform.rotation);
        if (!(std::abs(length - 1.0) <= kUnitTolerance)) {
            warnings.add("a rotation that is no unit quaternion is scaled to one", node.name);
        }
    }
    return transform;
}

std::vector<int> parents_of(const tinygltf::Model& model) {
    std::vector<int> parents(model.nodes.size(), -1);
    for (std::size_t i = 0; i < model.nodes.size(); ++i) {
        for (const int child : model.nodes[i].children) {
            int& parent = parents[static_cast<std::size_t>(child)];
            if (parent >= 0) {
                fail_input("nodes[{}]: is a child of both nodes[{}] and nodes[{}]", child, parent,
                           i);
            }
            parent = static_cast<int>(i);
        }
    }
    return parents;
}

// `roots` and all below them, parents first. Ends, as no node has two parents.
std::vector<int> descendants(const tinygltf::Model& model, std::vector<int> roots) {
    std::vector<bool> seen(model.nodes.size(), false);
    std::vector<int> order;
    std::vector<int> pending(roots.rbegin(), roots.rend());
    while (!pending.empty()) {
        const int index = pending.back();
        pending.pop_back();
        if (seen[static_cast<std::size_t>(index)]) continue;
        seen[static_cast<std::size_t>(index)] = true;
        order.push_back(index);
        const std::vector<int>& children = model.nodes[static_cast<std::size_t>(index)].children;
        pending.insert(pending.end(), children.rbegin(), children.rend());
    }
    return order;
}

std::vector<int> roots_of(const std::vector<int>& parents) {
    std::vector<int> roots;
    for (std::size_t i = 0; i < parents.size(); ++i) {
        if (parents[i] < 0) roots.push_back(static_cast<int>(i));
    }
    return roots;
}

void place_nodes(const tinygltf::Model& model, Pose& pose) {
    const std::vector<int> parents = parents_of(model);
    const std::vector<int> order = descendants(model, roots_of(parents));
    if (order.size() < model.nodes.size()) {
        std::vector<bool> placed(model.nodes.size(), false);
        for (const int index : order)
            placed[static_cast<std::size_t>(index)] = true;
        const auto looped = std::find(placed.begin(), placed.end(), false) - placed.begin();
        fail_input("nodes[{}]: is among its own descendants", looped);
    }
    pose.world_from_node.resize(model.nodes.size());
    for (const int index : order) {
        const auto i = static_cast<std::size_t>(index);
        const glm::dmat4 parent_from_node = pose.transforms[i].parent_from_node();
        pose.world_from_node[i] =
            parents[i] < 0
                ? parent_from_node
                : pose.world_from_node[static_cast<std::size_t>(parents[i])] * parent_from_node;
    }
}

}  // namespace

glm::dmat4 NodeTransform::parent_from_node() const {
    if (matrix) return *matrix;
    const double length = glm::length(rotation);
    const glm::dquat turn = length > 0.0 ? rotation / length : glm::dquat(1.0, 0.0, 0.0, 0.0);
    return glm::scale(glm::translate(glm::dmat4(1.0), translation) * glm::mat4_cast(turn), scale);
}

Pose pose_nodes(GltfDocument& document, LoadContext& context) {
    const tinygltf::Model& model = document.model();
    Pose pose;
    for (const tinygltf::Node& node : model.nodes) {
        pose.transforms.push_back(transform_of(node, context.warnings));
        pose.morph_weights.push_back(node.weights);
    }
    const auto wanted = static_cast<std::size_t>(std::max(context.options.animation, 0));
    if (!model.animations.empty()) {
        if (context.options.animation < 0 || wanted >= model.animations.size()) {
            fail_input("has no animation {}; choose one in [0, {}]", context.options.animation,
                       model.animations.size() - 1);
        }
        animate(document, model.animations[wanted], context, pose);
    }
    place_nodes(model, pose);
    return pose;
}

std::vector<int> visible_nodes(const GltfDocument& document, LoadContext& context) {
    const tinygltf::Model& model = document.model();
    if (model.scenes.empty()) {
        if (!model.nodes.empty())
            context.warnings.add("the file has no scene: all nodes are shown");
        return descendants(model, roots_of(parents_of(model)));
    }
    const auto shown = static_cast<std::size_t>(std::max(model.defaultScene, 0));
    if (model.scenes.size() > 1) {
        context.warnings.add("the file has several scenes; one is shown", model.scenes[shown].name);
    }
    return descendants(model, model.scenes[shown].nodes);
}

}  // namespace gnomon::scene
