// The binary tree by the surface area heuristic over bins: I. Wald, "On fast Construction of
// SAH-based Bounding Volume Hierarchies", Symposium on Interactive Ray Tracing, 2007. A leaf costs
// as much with one triangle as with kWidth, because they are tested together; so the cost of a side
// is its area times its number of full leaves.

#include "interval/split.h"

#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <limits>

namespace gnomon::interval {

namespace {

constexpr int kBins = 32;

/// From here on triangles are halved, whatever it costs: bounds the depth of trees of nested boxes.
constexpr int kDeepestSplit = 64;

/// Work between two questions whether to go on, in triangles.
constexpr std::uint32_t kTrianglesPerReport = 1 << 15;

/// The bin of a box along an axis.
struct Binning {
    float start, per_m;

    int operator()(float center) const {
        return std::clamp(static_cast<int>((center - start) * per_m), 0, kBins - 1);
    }
};

struct Split {
    float cost = std::numeric_limits<float>::infinity();
    int axis = -1;  ///< -1: there is none
    int last_left_bin = 0;
    Binning bin{};
};

float leaves_of(std::uint32_t count) {
    return static_cast<float>((count + kWidth - 1) / kWidth);
}

class Splitter {
public:
    Splitter(std::vector<BoxedTriangle>& triangles, Progress& progress)
        : triangles_(triangles), progress_(progress) {
        nodes_.reserve(triangles.size() / 4 + 1);
    }

    std::vector<BinaryNode> split() {
        if (!triangles_.empty()) split(0, static_cast<std::uint32_t>(triangles_.size()), 0);
        return std::move(nodes_);
    }

private:
    std::uint32_t split(std::uint32_t first, std::uint32_t count, int depth) {
        const auto id = static_cast<std::uint32_t>(nodes_.size());
        Box box = Box::empty(), centers = Box::empty();
        for (std::uint32_t i = first; i < first + count; ++i) {
            const Box& other = triangles_[i].box;
            box.include(other);
            for (int axis = 0; axis < 3; ++axis) {
                centers.lower[axis] = std::min(centers.lower[axis], other.center(axis));
                centers.upper[axis] = std::max(centers.upper[axis], other.center(axis));
            }
        }
        nodes_.push_back({box, first, count, 0, 0});
        const Split best = count > 1 ? best_split(first, count, centers) : Split{};
        if (count <= kWidth && best.cost + box.area() >= box.area()) {
            finish(count);
            return id;
        }
        const std::uint32_t left_count = partition(first, count, depth, best);
        nodes_[id].left = split(first, left_count, depth + 1);
        const std::uint32_t right = split(first + left_count, count - left_count, depth + 1);
        nodes_[id].right = right;
        return id;
    }

    Split best_split(std::uint32_t first, std::uint32_t count, const Box& centers) const {
        Split best;
        for (int axis = 0; axis < 3; ++axis) {
            const float extent = centers.upper[axis] - centers.lower[axis];
            const Binning bin{centers.lower[axis], static_cast<float>(kBins) / extent};
            if (extent > 0.0f) improve(best, first, count, axis, bin);
        }
        return best;
    }

    void improve(Split& best, std::uint32_t first, std::uint32_t count, int axis,
                 const Binning& bin) const {
        std::array<Box, kBins> boxes;
        boxes.fill(Box::empty());
        std::array<std::uint32_t, kBins> counts{};
        for (std::uint32_t i = first; i < first + count; ++i) {
            const auto b = static_cast<unsigned>(bin(triangles_[i].box.center(axis)));
            boxes[b].include(triangles_[i].box);
            ++counts[b];
        }
        std::array<float, kBins> right_costs{};
        Box box = Box::empty();
        std::uint32_t inside = 0;
        for (unsigned b = kBins - 1; b > 0; --b) {
            box.include(boxes[b]);
            inside += counts[b];
            right_costs[b - 1] = box.area() * leaves_of(inside);
        }
        box = Box::empty();
        inside = 0;
        for (unsigned b = 0; b + 1 < kBins; ++b) {
            box.include(boxes[b]);
            inside += counts[b];
            if (inside == 0 || inside == count) continue;
            const float cost = box.area() * leaves_of(inside) + right_costs[b];
            if (cost < best.cost) best = {cost, axis, static_cast<int>(b), bin};
        }
    }

    /// Moves the left side's triangles to the front; returns how many they are.
    std::uint32_t partition(std::uint32_t first, std::uint32_t count, int depth,
                            const Split& best) {
        if (best.axis < 0 || depth >= kDeepestSplit) return count / 2;
        const auto begin = triangles_.begin() + first;
        const auto middle = std::partition(begin, begin + count, [&](const BoxedTriangle& other) {
            return best.bin(other.box.center(best.axis)) <= best.last_left_bin;
        });
        return static_cast<std::uint32_t>(middle - begin);
    }

    void finish(std::uint32_t count) {
        done_ += count;
        unreported_ += count;
        if (unreported_ < kTrianglesPerReport) return;
        unreported_ = 0;
        throw_if_cancelled(progress_, kBuildTask);
        progress_.report(kBuildTask,
                         static_cast<double>(done_) / static_cast<double>(triangles_.size()));
    }

    std::vector<BoxedTriangle>& triangles_;
    Progress& progress_;
    std::vector<BinaryNode> nodes_;
    std::uint32_t done_ = 0, unreported_ = 0;
};

}  // namespace

Box Box::empty() {
    constexpr float kFar = std::numeric_limits<float>::max();
    return {{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
}

void Box::include(const Box& other) {
    for (int axis = 0; axis < 3; ++axis) {
        lower[axis] = std::min(lower[axis], other.lower[axis]);
        upper[axis] = std::max(upper[axis], other.upper[axis]);
    }
}

float Box::area() const {
    if (lower[0] > upper[0]) return 0.0f;
    const float x = upper[0] - lower[0], y = upper[1] - lower[1], z = upper[2] - lower[2];
    return x * y + y * z + z * x;
}

std::vector<BinaryNode> split_triangles(std::vector<BoxedTriangle>& triangles, Progress& progress) {
    return Splitter(triangles, progress).split();
}

}  // namespace gnomon::interval
