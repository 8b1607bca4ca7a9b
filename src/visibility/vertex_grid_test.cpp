#include "visibility/vertex_grid.h"

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <set>
#include <vector>

namespace gnomon::vertex_grid {
namespace {

TEST(VertexGrid, EveryVertexHasItsIndex) {
    for (const unsigned parts : {1u, 2u, 7u}) {
        std::set<std::uint64_t> indices;
        for (unsigned j = 0; j <= parts; ++j) {
            for (unsigned i = 0; i + j <= parts; ++i)
                indices.insert(vertex_index(parts, {i, j}));
        }
        EXPECT_EQ(indices.size(), vertex_count(parts));
        EXPECT_EQ(*indices.rbegin(), vertex_count(parts) - 1);
    }
    EXPECT_EQ(vertex_count(1), 3u);
    EXPECT_EQ(vertex_count(1 << 20), (std::uint64_t{1} << 39) + 3 * (std::uint64_t{1} << 19) + 1);
}

// Interpolation is exact for what is linear, such as the coordinates themselves.
TEST(VertexGrid, CellsHoldTheirPlace) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform;
    for (const unsigned parts : {1u, 2u, 9u, 1000u}) {
        for (int round = 0; round < 2000; ++round) {
            DVec3 place(uniform(random), uniform(random), uniform(random));
            if (round < 3) place = DVec3(round == 0, round == 1, round == 2);
            if (round % 7 == 3) place.x = 0.0;  // on an edge
            place /= place.x + place.y + place.z;
            const GridCell cell = cell_at(parts, place);
            DVec3 found(0.0);
            for (int k = 0; k < 3; ++k) {
                const auto [i, j] = cell.vertices[k];
                ASSERT_LE(i + j, parts);
                ASSERT_GE(cell.weights[k], 0.0);
                found += cell.weights[k] * DVec3(parts - i - j, i, j) / static_cast<double>(parts);
            }
            // A few roundings of numbers up to 1.
            constexpr double kError = 1e-15 * 8;
            for (int k = 0; k < 3; ++k)
                ASSERT_NEAR(found[k], place[k], kError) << parts << " parts, round " << round;
        }
    }
}

TEST(VertexGrid, WhatRoundingHasPutOutsideIsOnTheEdge) {
    const GridCell cell = cell_at(4, {-1e-9, 0.5, 0.5 + 1e-9});
    EXPECT_NEAR(cell.weights.x + cell.weights.y + cell.weights.z, 1.0, 1e-12);
    for (int k = 0; k < 3; ++k)
        EXPECT_GE(cell.weights[k], 0.0);
}

TEST(VertexGrid, VerticesAreSampledInsideOfTheirTriangle) {
    for (const GridVertex vertex : {GridVertex{0, 0}, {3, 0}, {0, 3}, {1, 1}, {1, 2}}) {
        const DVec3 place = sampled_at(3, vertex);
        EXPECT_GT(std::min({place.x, place.y, place.z}), 0.0);
        EXPECT_NEAR(place.x + place.y + place.z, 1.0, 1e-15);
        const DVec3 own = DVec3(3 - vertex.i - vertex.j, vertex.i, vertex.j) / 3.0;
        EXPECT_LT(glm::distance(place, own), 0.02);  // 1/64 of a cell at each of two edges
    }
}

TEST(VertexGrid, EdgesAreNoLongerThanAsked) {
    EXPECT_EQ(parts_for(1.0, 0.25), 4u);
    EXPECT_EQ(parts_for(1.01, 0.25), 5u);
    EXPECT_EQ(parts_for(0.2, 0.25), 1u);
    EXPECT_EQ(parts_for(1.0, 0.0), 1u) << "the mesh as it is";
    EXPECT_EQ(parts_for(0.0, 0.25), 1u);
}

std::uint64_t vertices(const std::vector<float>& longest_m, double edge_m) {
    std::uint64_t sum = 0;
    for (const float longest : longest_m)
        sum += parts_for(longest, edge_m) > 1 ? vertex_count(parts_for(longest, edge_m)) : 0;
    return sum;
}

TEST(VertexGrid, LargeScenesGetTheLeastEdgeThatIsAfforded) {
    const std::vector<float> longest_m{1e5f, 3.0f, 0.01f, 700.0f};
    constexpr std::uint64_t kMost = 10'000;
    const double edge_m = affordable_edge_m(longest_m, 0.1, kMost);
    EXPECT_LE(vertices(longest_m, edge_m), kMost);
    EXPECT_GT(vertices(longest_m, 0.95 * edge_m), kMost);
    EXPECT_EQ(affordable_edge_m(longest_m, 0.0, kMost), 0.0);
    const std::vector<float> small_m{1.0f, 2.0f};
    EXPECT_EQ(affordable_edge_m(small_m, 0.1, kMost), 0.1) << "as asked, where it is few";
    EXPECT_EQ(affordable_edge_m({}, 0.1, kMost), 0.1);
}

}  // namespace
}  // namespace gnomon::vertex_grid
