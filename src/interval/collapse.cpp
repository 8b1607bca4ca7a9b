// From a binary tree to a wide one by dynamic programming: H. Ylitie, T. Karras, S. Laine,
// "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", High-Performance
// Graphics, 2017, section 3.1; leaves stay as they are. A greedy collapse fills a third of the
// slots.

#include "interval/collapse.h"

namespace gnomon::interval {

namespace {

/// Choice::left where fewer slots than allowed are as good, and where the node is one child itself.
constexpr std::uint8_t kFewer = 255;
constexpr std::uint8_t kItself = 0;

}  // namespace

Collapse::Collapse(const std::vector<BinaryNode>& nodes) : nodes_(nodes), choices_(nodes.size()) {
    for (auto node = static_cast<std::uint32_t>(nodes.size()); node-- > 0;)
        choose(node);  // children first: they come after their parent
}

void Collapse::choose(std::uint32_t node) {
    const BinaryNode& binary = nodes_[node];
    Choice& choice = choices_[node];
    const float area = binary.box.area();
    if (binary.is_leaf()) {
        choice.cost.fill(area);
        choice.left.fill(kItself);
        return;
    }
    const Choice& left = choices_[binary.left];
    const Choice& right = choices_[binary.right];
    for (unsigned slots = 2; slots <= kWidth; ++slots) {
        float& cost = choice.cost[slots - 1];
        cost = left.cost[0] + right.cost[slots - 2];
        choice.left[slots - 1] = 1;
        for (unsigned to_left = 2; to_left < slots; ++to_left) {
            const float other = left.cost[to_left - 1] + right.cost[slots - to_left - 1];
            if (other < cost) {
                cost = other;
                choice.left[slots - 1] = static_cast<std::uint8_t>(to_left);
            }
        }
    }
    choice.cost[0] = area + choice.cost[kWidth - 1];
    choice.left[0] = kItself;
    for (unsigned slots = 1; slots < kWidth; ++slots) {
        if (choice.cost[slots - 1] > choice.cost[slots]) continue;
        // children() opens the node whatever it costs: its entry for all slots is kept.
        if (slots + 1 == kWidth) break;
        choice.cost[slots] = choice.cost[slots - 1];
        choice.left[slots] = kFewer;
    }
}

std::vector<std::uint32_t> Collapse::children(std::uint32_t node) const {
    std::vector<std::uint32_t> children;
    const int to_left = choices_[node].left[kWidth - 1];
    gather(nodes_[node].left, to_left, children);
    gather(nodes_[node].right, kWidth - to_left, children);
    return children;
}

void Collapse::gather(std::uint32_t node, int slots, std::vector<std::uint32_t>& children) const {
    const Choice& choice = choices_[node];
    while (slots > 1 && choice.left[static_cast<unsigned>(slots) - 1] == kFewer)
        --slots;
    const int to_left = choice.left[static_cast<unsigned>(slots) - 1];
    if (slots == 1 || to_left == kItself) {
        children.push_back(node);
        return;
    }
    gather(nodes_[node].left, to_left, children);
    gather(nodes_[node].right, slots - to_left, children);
}

}  // namespace gnomon::interval
