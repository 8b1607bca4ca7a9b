#include "interval/tree.h"

#include "interval/collapse.h"
#include "interval/test_days.h"
#include "trace/test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace gnomon::interval {
namespace {

Scene crowd(int count) {
    Random random(7);
    Mesh mesh;
    for (unsigned i = 0; i < static_cast<unsigned>(count); ++i) {
        const Vec3 corner = random.in_box(50.0f);
        mesh.positions.insert(mesh.positions.end(),
                              {corner, corner + random.in_box(1.0f), corner + random.in_box(1.0f)});
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return trace::make_scene({{mesh, {Mat4(1.0f), trace::far_and_turned()}}});
}

/// Walks down from a node; every box must hold what is below it.
void expect_inside(const Tree& tree, std::int32_t child, const Box& box,
                   std::set<std::pair<unsigned, unsigned>>& found) {
    if (child >= 0) {
        const Node& node = tree.nodes()[static_cast<std::size_t>(child)];
        for (int slot = 0; slot < kWidth; ++slot) {
            if (node.child[slot] == Node::kNoChild) continue;
            Box inner{};
            for (int axis = 0; axis < 3; ++axis) {
                inner.lower[axis] = node.lower[axis][slot];
                inner.upper[axis] = node.upper[axis][slot];
                EXPECT_GE(inner.lower[axis], box.lower[axis]);
                EXPECT_LE(inner.upper[axis], box.upper[axis]);
            }
            expect_inside(tree, node.child[slot], inner, found);
        }
        return;
    }
    const auto id = static_cast<std::size_t>(~child);
    const Leaf& leaf = tree.leaves()[id];
    const float slack = 1e-6f * tree.reach_m();  // an edge is rounded by itself
    for (unsigned lane = 0; lane < kWidth && !std::isnan(leaf.corner[0][lane]); ++lane) {
        const trace::SurfaceId surface = tree.leaf_ids()[id][lane];
        EXPECT_TRUE(found.insert({surface.instance, surface.primitive}).second);
        for (int axis = 0; axis < 3; ++axis) {
            const float corner = leaf.corner[axis][lane];
            for (const float edge : {0.0f, leaf.edge1[axis][lane], leaf.edge2[axis][lane]}) {
                EXPECT_GE(corner + edge, box.lower[axis] - slack);
                EXPECT_LE(corner + edge, box.upper[axis] + slack);
            }
        }
    }
}

TEST(Tree, HoldsEveryTriangleOnce) {
    for (const int count : {1, 15, 16, 17, 40, 3000}) {
        Progress progress;
        const Tree tree(crowd(count), frame_around(pole_at(0.5)), false, progress);
        std::set<std::pair<unsigned, unsigned>> found;
        const float far = tree.reach_m();
        expect_inside(tree, 0, {{-far, -far, -far}, {far, far, far}}, found);
        EXPECT_EQ(found.size(), static_cast<std::size_t>(2 * count));
        EXPECT_EQ(tree.triangle_count(), found.size());
        // 36 bytes of floats, an id, boxes; leaves half full at worst when there are many.
        if (count == 3000) {
            EXPECT_LT(tree.memory_bytes() / found.size(), 120u);
        }
    }
}

TEST(Tree, NestedBoxesDoNotMakeItDeep) {
    // Each triangle is twice as large as the one before, so that splits by area peel them off one
    // by one; and many are in one place, so that no split parts them.
    Mesh mesh;
    for (unsigned i = 0; i < 120; ++i) {
        const float size = std::ldexp(1.0f, static_cast<int>(i) - 60);
        mesh.positions.insert(mesh.positions.end(), {{0, 0, 0}, {size, 0, size}, {0, size, size}});
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    for (unsigned i = 0; i < 1000; ++i)
        mesh.triangles.push_back({0, 1, 2});
    Progress progress;
    const Tree tree(trace::make_scene({{mesh}}), frame_around({0, 1, 0}), false, progress);
    EXPECT_GT(tree.triangle_count(), 1000u);
}

TEST(Collapse, NodesAreFull) {
    Progress progress;
    const Tree tree(crowd(20000), frame_around(pole_at(0.5)), false, progress);
    std::size_t children = 0;
    for (const Node& node : tree.nodes()) {
        for (const std::int32_t child : node.child)
            children += child != Node::kNoChild ? 1 : 0;
    }
    EXPECT_GT(children, 9 * tree.nodes().size());
}

}  // namespace
}  // namespace gnomon::interval
