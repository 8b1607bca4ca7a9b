#include "interval/tree.h"

#include "base/check.h"
#include "base/parallel.h"
#include "interval/collapse.h"
#include "interval/magnitudes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::interval {

namespace {

/// Work between two questions whether to go on.
constexpr std::uint32_t kTrianglesPerReport = 1 << 16;
constexpr std::int32_t kNodesPerReport = 1 << 10;

}  // namespace

Leaf Leaf::empty() {
    Leaf leaf{};
    for (float(&lanes)[kWidth] : leaf.corner)
        std::ranges::fill(lanes, std::numeric_limits<float>::quiet_NaN());
    return leaf;
}

/// What the tree is made from.
struct Tree::Source {
    const std::vector<BinaryNode>& binary;
    const std::vector<BoxedTriangle>& triangles;
    const Collapse& collapse;
    Progress& progress;
};

Tree::Tree(const Scene& scene, const Frame& frame, bool ignore_alpha, Progress& progress)
    : scene_(scene), frame_(frame), ignore_alpha_(ignore_alpha) {
    throw_if_cancelled(progress, kBuildTask);
    if (!scene.bounds().empty()) center_ws_ = DVec3(scene.bounds().center());
    try {
        std::vector<BoxedTriangle> triangles = boxed_triangles(progress);
        triangle_count_ = triangles.size();
        const std::vector<BinaryNode> binary = split_triangles(triangles, progress);
        if (!binary.empty()) add_node({binary, triangles, Collapse(binary), progress}, 0);
        nodes_.shrink_to_fit();
        leaves_.shrink_to_fit();
        leaf_ids_.shrink_to_fit();
        leaf_masked_.shrink_to_fit();
    } catch (const std::bad_alloc&) {
        fail_machine("out of memory while {}: the scene has {} triangles", kBuildTask,
                     scene.triangle_count());
    }
    progress.report(kBuildTask, 1.0);
}

std::vector<BoxedTriangle> Tree::boxed_triangles(Progress& progress) {
    std::vector<BoxedTriangle> triangles;
    triangles.reserve(scene_.triangle_count());
    for (std::uint32_t i = 0; i < scene_.instances().size(); ++i) {
        const Mesh& mesh = scene_.meshes()[scene_.instances()[i].mesh];
        for (std::uint32_t primitive = 0; primitive < mesh.triangles.size(); ++primitive) {
            if (primitive % kTrianglesPerReport == 0) throw_if_cancelled(progress, kBuildTask);
            const trace::Triangle triangle = trace::world_triangle(scene_, {i, primitive});
            const double area2 = glm::length(triangle.front_normal_ws());
            if (!(area2 > 0.0)) continue;
            Box box = Box::empty();
            for (const DVec3& corner_ws : triangle.corners_ws) {
                const Vec3 corner(from_world(corner_ws));
                box.include({{corner.x, corner.y, corner.z}, {corner.x, corner.y, corner.z}});
                reach_m_ = std::max(
                    {reach_m_, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
            }
            magnitude_m_ = std::max(magnitude_m_, sum_of_magnitudes(triangle.magnitude));
            triangles.push_back({box, {i, primitive}});
        }
    }
    return triangles;
}

std::int32_t Tree::add_node(const Source& source, std::uint32_t binary_node) {
    const auto id = static_cast<std::int32_t>(nodes_.size());
    if (id % kNodesPerReport == 0) throw_if_cancelled(source.progress, kBuildTask);
    nodes_.emplace_back();
    // A scene of one leaf has a root with one child.
    const std::vector<std::uint32_t> children = source.binary[binary_node].is_leaf()
                                                    ? std::vector{binary_node}
                                                    : source.collapse.children(binary_node);
    Node node{};
    for (std::size_t slot = 0; slot < children.size(); ++slot) {
        const BinaryNode& child = source.binary[children[slot]];
        for (int axis = 0; axis < 3; ++axis) {
            node.lower[axis][slot] = child.box.lower[axis];
            node.upper[axis][slot] = child.box.upper[axis];
        }
        node.child[slot] =
            child.is_leaf() ? add_leaf(source, child) : add_node(source, children[slot]);
    }
    nodes_[static_cast<std::size_t>(id)] = node;
    return id;
}

std::int32_t Tree::add_leaf(const Source& source, const BinaryNode& node) {
    Leaf leaf = Leaf::empty();
    LeafIds ids;
    std::uint16_t masked = 0;
    for (std::uint32_t lane = 0; lane < node.count; ++lane) {
        const trace::SurfaceId id = source.triangles[node.first + lane].id;
        const trace::Triangle triangle = trace::world_triangle(scene_, id);
        const DVec3 corner = from_world(triangle.corners_ws[0]);
        const DVec3 edge1 = from_world(triangle.corners_ws[1]) - corner;
        const DVec3 edge2 = from_world(triangle.corners_ws[2]) - corner;
        for (int axis = 0; axis < 3; ++axis) {
            leaf.corner[axis][lane] = static_cast<float>(corner[axis]);
            leaf.edge1[axis][lane] = static_cast<float>(edge1[axis]);
            leaf.edge2[axis][lane] = static_cast<float>(edge2[axis]);
        }
        ids[lane] = id;
        const Mesh& mesh = scene_.meshes()[scene_.instances()[id.instance].mesh];
        const bool has_holes = !ignore_alpha_ && scene_.materials()[mesh.material].masked();
        masked |= static_cast<std::uint16_t>(unsigned{has_holes} << lane);
    }
    leaves_.push_back(leaf);
    leaf_ids_.push_back(ids);
    leaf_masked_.push_back(masked);
    return ~static_cast<std::int32_t>(leaves_.size() - 1);
}

std::size_t Tree::memory_bytes() const {
    return nodes_.size() * sizeof(Node) + leaves_.size() * sizeof(Leaf) +
           leaf_ids_.size() * sizeof(LeafIds) + leaf_masked_.size() * sizeof(std::uint16_t);
}

}  // namespace gnomon::interval
