#pragma once

#include <gnomon/scene.h>

namespace gnomon::scene {

/// A sprig of leaves: green, opaque within the leaves and along the stem, with soft edges for
/// bilinear sampling. The stem starts in the middle of the bottom edge.
Texture leaf_texture();

/// Where its leaves begin: a point on a branch and the direction in which the branch grows there.
struct BranchTip {
    Vec3 position;
    Vec3 direction;
};

/// Trunk and branches of a broad-leaved tree on the origin, closed, and the tips of its branches.
/// Branches have `sides` sides, the trunk twice as many.
struct TreeSkeleton {
    Mesh wood;
    std::vector<BranchTip> tips;
};
TreeSkeleton tree_skeleton(std::uint64_t seed, float height_m, int branches, int sides);

/// `count` square cards of `size_m` for leaf_texture() about the tips. Open.
Mesh leaf_cards(const std::vector<BranchTip>& tips, std::uint64_t seed, int count, float size_m);

/// `count` flat tetrahedra, as leaves that are closed, about the tips.
Mesh solid_leaves(const std::vector<BranchTip>& tips, std::uint64_t seed, int count, float size_m);

}  // namespace gnomon::scene
