#include "lightmap/coverage.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace gnomon::lightmap {
namespace {

using Cells = std::set<std::pair<int, int>>;

Cells touched(const Corners& c) {
    Cells cells;
    for_touched(c, [&](int y, int begin, int end) {
        for (int x = begin; x < end; ++x)
            EXPECT_TRUE(cells.insert({x, y}).second);
    });
    return cells;
}

Cells centred(const Corners& c) {
    Cells cells;
    for_centres(c, [&](int y, int begin, int end) {
        for (int x = begin; x < end; ++x)
            EXPECT_TRUE(cells.insert({x, y}).second);
    });
    return cells;
}

TEST(Coverage, WhatLiesOnABorderDoesNotTouchTheNextTexel) {
    EXPECT_EQ(touched({dvec2(0, 0), dvec2(2, 0), dvec2(0, 2)}), (Cells{{0, 0}, {1, 0}, {0, 1}}));
}

TEST(Coverage, EveryTriangleTouchesATexelHoweverSmall) {
    EXPECT_EQ(touched({dvec2(3.4, 5.6), dvec2(3.4001, 5.6), dvec2(3.4, 5.6001)}), (Cells{{3, 5}}));
    EXPECT_EQ(touched({dvec2(3.999, 5), dvec2(4.0, 5), dvec2(4.0, 5.0001)}).size(), 1u);
}

TEST(Coverage, PointsInATriangleAreInTouchedTexels) {
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> place(0.0, 12.0);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int round = 0; round < 200; ++round) {
        const Corners c{dvec2(place(engine), place(engine)), dvec2(place(engine), place(engine)),
                        dvec2(place(engine), place(engine))};
        const Cells cells = touched(c);
        for (const auto& cell : centred(c))
            EXPECT_TRUE(cells.contains(cell));
        for (int i = 0; i < 200; ++i) {
            const double a = unit(engine);
            const double b = unit(engine) * (1.0 - a);
            const dvec2 p = weighted(c, {a, b, 1.0 - a - b});
            // Points within the border's tolerance may belong to the neighbour.
            const dvec2 inside = p - glm::floor(p);
            if (std::min({inside.x, inside.y, 1 - inside.x, 1 - inside.y}) < 2 * kBorder_texels) {
                continue;
            }
            EXPECT_TRUE(cells.contains({static_cast<int>(p.x), static_cast<int>(p.y)}));
        }
        // And no touched texel is farther from the triangle than half its diagonal.
        for (const auto& [x, y] : cells) {
            const dvec2 center(x + 0.5, y + 0.5);
            EXPECT_LT(glm::distance(weighted(c, nearest_weights(c, center)), center),
                      std::sqrt(0.5));
        }
    }
}

TEST(Coverage, TrianglesThatShareEdgesShareNoCentres) {
    // A fan about points of the half grid, where centres lie on edges.
    std::mt19937 engine(6);
    std::uniform_int_distribution<int> half(0, 24);
    for (int round = 0; round < 200; ++round) {
        const dvec2 hub(6.5, 6.5);
        const Corners square{dvec2(0, 0), dvec2(13, 0), dvec2(13, 13)};
        const dvec2 corners[] = {square[0], {0.5 * half(engine), 0.0},  square[1],
                                 square[2], {0.5 * half(engine), 13.0}, {0.0, 13.0}};
        std::map<std::pair<int, int>, int> counts;
        for (int i = 0; i < 6; ++i) {
            for (const auto& cell : centred({hub, corners[i], corners[(i + 1) % 6]}))
                ++counts[cell];
        }
        EXPECT_EQ(counts.size(), 13u * 13u);
        for (const auto& [cell, count] : counts)
            EXPECT_EQ(count, 1);
    }
}

TEST(Coverage, NearestPointsAreOnTheTriangle) {
    const Corners c{dvec2(0, 0), dvec2(4, 0), dvec2(0, 4)};
    EXPECT_EQ(weighted(c, nearest_weights(c, {1, 1})), dvec2(1, 1));
    EXPECT_EQ(weighted(c, nearest_weights(c, {3, 3})), dvec2(2, 2));
    EXPECT_EQ(weighted(c, nearest_weights(c, {-1, -1})), dvec2(0, 0));
    EXPECT_EQ(weighted(c, nearest_weights(c, {2, -5})), dvec2(2, 0));
    const Corners line{dvec2(0, 0), dvec2(4, 0), dvec2(2, 0)};
    EXPECT_EQ(weighted(line, nearest_weights(line, {3, 1})), dvec2(3, 0));
}

}  // namespace
}  // namespace gnomon::lightmap
