#pragma once

#include "interval/split.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gnomon::interval {

/// Which nodes of a binary tree become the children of wide nodes, so that the boxes that are
/// tested have the least area in all.
class Collapse {
public:
    explicit Collapse(const std::vector<BinaryNode>& nodes);

    /// The up to kWidth nodes that are the children of the wide node of `node`, no leaf.
    std::vector<std::uint32_t> children(std::uint32_t node) const;

private:
    /// What the part below a node costs when it may be up to i + 1 children of a wide node, and
    /// how many of those the left side then gets.
    struct Choice {
        std::array<float, kWidth> cost;
        std::array<std::uint8_t, kWidth> left;
    };

    void choose(std::uint32_t node);
    void gather(std::uint32_t node, int slots, std::vector<std::uint32_t>& children) const;

    const std::vector<BinaryNode>& nodes_;
    std::vector<Choice> choices_;
};

}  // namespace gnomon::interval
