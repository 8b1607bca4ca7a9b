#pragma once

#include <gnomon/progress.h>
#include <gnomon/scene.h>

#include "interval/path.h"
#include "interval/split.h"
#include "trace/receiver.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gnomon::interval {

/// Boxes of up to kWidth children, side by side. A child is a node, ~leaf, or kNoChild.
struct alignas(64) Node {
    static constexpr std::int32_t kNoChild = 0;  // the root, which is nobody's child

    float lower[3][kWidth], upper[3][kWidth];
    std::int32_t child[kWidth];
};

/// Up to kWidth triangles, side by side: a corner and the edges from it to the two others. Those
/// that are not there come last, and have no number for a corner: all comparisons with it fail.
struct alignas(64) Leaf {
    float corner[3][kWidth], edge1[3][kWidth], edge2[3][kWidth];

    static Leaf empty();
};

using LeafIds = std::array<trace::SurfaceId, kWidth>;

/// The triangles of a scene, instances unfolded, in a frame around the celestial pole: one tree
/// serves every day at a place. About 60 bytes a triangle. Immutable once made, and safe to use
/// from several threads.
class Tree {
public:
    /// Keeps the scene alive. Triangles without area are left out; with `ignore_alpha` masked
    /// materials are solid. Throws Error{cancelled}, Error{machine} when memory runs out.
    Tree(const Scene& scene, const Frame& frame, bool ignore_alpha, Progress& progress);

    const Scene& scene() const { return scene_; }
    const Frame& frame() const { return frame_; }
    bool ignores_alpha() const { return ignore_alpha_; }

    /// Place in the frame, relative to the scene's middle, so that float loses least.
    DVec3 from_world(DVec3 point_ws) const { return frame_.from_world(point_ws - center_ws_); }
    /// No coordinate of a triangle in the frame is farther from 0.
    float reach_m() const { return reach_m_; }
    /// Bounds the sum of magnitudes of trace::Triangle.
    double magnitude_m() const { return magnitude_m_; }

    /// The root is node 0; empty without triangles.
    const std::vector<Node>& nodes() const { return nodes_; }
    const std::vector<Leaf>& leaves() const { return leaves_; }
    /// Of each leaf, the surfaces of the triangles, and a bit for those whose material has holes.
    const std::vector<LeafIds>& leaf_ids() const { return leaf_ids_; }
    const std::vector<std::uint16_t>& leaf_masked() const { return leaf_masked_; }
    std::size_t triangle_count() const { return triangle_count_; }
    std::size_t memory_bytes() const;

private:
    std::vector<BoxedTriangle> boxed_triangles(Progress& progress);
    struct Source;
    std::int32_t add_node(const Source& source, std::uint32_t binary_node);
    std::int32_t add_leaf(const Source& source, const BinaryNode& node);

    Scene scene_;
    Frame frame_;
    bool ignore_alpha_;
    DVec3 center_ws_{0.0};
    float reach_m_ = 0.0f;
    double magnitude_m_ = 0.0;
    std::size_t triangle_count_ = 0;
    std::vector<Node> nodes_;
    std::vector<Leaf> leaves_;
    std::vector<LeafIds> leaf_ids_;
    std::vector<std::uint16_t> leaf_masked_;
};

}  // namespace gnomon::interval
