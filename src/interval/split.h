#pragma once

#include <gnomon/progress.h>

#include "trace/receiver.h"

#include <cstdint>
#include <vector>

namespace gnomon::interval {

/// Leaves hold up to so many triangles, nodes as many children: the floats of one AVX-512 register.
inline constexpr int kWidth = 16;

/// An axis-aligned box in the tree's frame.
struct Box {
    float lower[3], upper[3];

    static Box empty();
    void include(const Box& other);
    /// Half of the surface; 0 when empty.
    float area() const;
    float center(int axis) const { return 0.5f * (lower[axis] + upper[axis]); }
};

struct BoxedTriangle {
    Box box;
    trace::SurfaceId id;
};

/// A node of a binary tree over triangles [first, first + count). Children come after their parent;
/// 0 = none, it is a leaf.
struct BinaryNode {
    Box box;
    std::uint32_t first = 0, count = 0;
    std::uint32_t left = 0, right = 0;

    bool is_leaf() const { return left == 0; }
};

/// Orders the triangles, and splits them until at most kWidth are in a leaf. The root is node 0;
/// empty without triangles. Throws Error{cancelled}.
std::vector<BinaryNode> split_triangles(std::vector<BoxedTriangle>& triangles, Progress& progress);

inline constexpr const char* kBuildTask = "building the interval tree";

}  // namespace gnomon::interval
