#include "raster/caster_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <utility>

namespace gnomon::raster {
namespace {

constexpr unsigned kSide = 40;

/// A square of kSide x kSide squares.
Mesh grid() {
    Mesh mesh;
    for (unsigned y = 0; y <= kSide; ++y) {
        for (unsigned x = 0; x <= kSide; ++x)
            mesh.positions.emplace_back(x, y, 0.0f);
    }
    for (unsigned y = 0; y < kSide; ++y) {
        for (unsigned x = 0; x < kSide; ++x) {
            const unsigned a = y * (kSide + 1) + x;
            mesh.triangles.push_back({a, a + 1, a + kSide + 2});
            mesh.triangles.push_back({a, a + kSide + 2, a + kSide + 1});
        }
    }
    return mesh;
}

std::vector<std::array<unsigned, 3>> as_set(const std::vector<UVec3>& triangles) {
    std::vector<std::array<unsigned, 3>> set;
    for (const UVec3& t : triangles) {
        std::array<unsigned, 3> corners{t.x, t.y, t.z};
        std::ranges::sort(corners);
        set.push_back(corners);
    }
    std::ranges::sort(set);
    return set;
}

TEST(CasterMesh, HasEachTriangleOnceInClustersOfNeighbours) {
    const Mesh mesh = grid();
    const CasterMesh caster = caster_mesh(mesh, 100, Simplify::no);
    EXPECT_EQ(as_set(caster.triangles), as_set(mesh.triangles));
    ASSERT_EQ(caster.clusters.size(), 32u);
    std::uint32_t next = 0;
    double area = 0.0;
    for (const MeshCluster& cluster : caster.clusters) {
        ASSERT_EQ(cluster.levels.size(), 1u);
        const std::uint32_t first = cluster.levels[0].first_triangle;
        EXPECT_EQ(first, next);
        next += cluster.levels[0].triangle_count;
        const Vec3 size = cluster.bounds.size();
        area += static_cast<double>(size.x) * static_cast<double>(size.y);
        for (std::uint32_t i = first; i < next; ++i) {
            for (int corner = 0; corner < 3; ++corner) {
                const Vec3 p = mesh.positions[caster.triangles[i][corner]];
                EXPECT_TRUE(p.x >= cluster.bounds.min.x && p.x <= cluster.bounds.max.x &&
                            p.y >= cluster.bounds.min.y && p.y <= cluster.bounds.max.y);
            }
        }
    }
    EXPECT_EQ(next, caster.triangles.size());
    // Boxes of clusters overlap a little; strips of whole rows would have four times the area.
    EXPECT_LT(area, 2.0 * kSide * kSide);
}

/// A hill over the square.
Mesh hill() {
    Mesh mesh = grid();
    for (Vec3& p : mesh.positions) {
        const Vec2 from_middle = Vec2(p) - 0.5f * kSide;
        p.z = 5.0f * std::exp(-glm::dot(from_middle, from_middle) / 100.0f);
    }
    return mesh;
}

TEST(CasterMesh, HasLevelsOfEverFewerTrianglesWhoseErrorGrows) {
    const Mesh mesh = hill();
    const CasterMesh caster = caster_mesh(mesh, 4000, Simplify::yes);
    ASSERT_EQ(caster.clusters.size(), 1u);
    const std::vector<CasterLevel>& levels = caster.clusters[0].levels;
    ASSERT_GT(levels.size(), 3u);
    for (std::size_t i = 1; i < levels.size(); ++i) {
        EXPECT_LT(levels[i].triangle_count, levels[i - 1].triangle_count);
        EXPECT_GE(levels[i].error_m, levels[i - 1].error_m);
        // Heights at the corners that are left are the mesh's own, so that between two the
        // triangles cut off no more than the error, which is a mean over their surroundings.
        double most_m = 0.0;
        const std::span<const UVec3> triangles =
            std::span(caster.triangles).subspan(levels[i].first_triangle, levels[i].triangle_count);
        for (const UVec3& t : triangles) {
            const Vec3 middle =
                (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0f;
            const Vec2 from_middle = Vec2(middle) - 0.5f * kSide;
            const float height = 5.0f * std::exp(-glm::dot(from_middle, from_middle) / 100.0f);
            most_m = std::max(most_m, static_cast<double>(std::abs(height - middle.z)));
        }
        EXPECT_LT(most_m, 3.0 * static_cast<double>(levels[i].error_m) + 0.02) << "level " << i;
    }
}

TEST(CasterMesh, KeepsTheBordersOfItsClusters) {
    const Mesh mesh = hill();
    const CasterMesh caster = caster_mesh(mesh, 400, Simplify::yes);
    ASSERT_GT(caster.clusters.size(), 1u);
    const auto borders = [&](const CasterLevel& level) {
        std::map<std::pair<unsigned, unsigned>, int> edges;
        for (std::uint32_t i = 0; i < level.triangle_count; ++i) {
            const UVec3& t = caster.triangles[level.first_triangle + i];
            for (int k = 0; k < 3; ++k) {
                const unsigned a = t[k];
                const unsigned b = t[(k + 1) % 3];
                ++edges[{std::min(a, b), std::max(a, b)}];
            }
        }
        std::erase_if(edges, [](const auto& edge) { return edge.second != 1; });
        return edges;
    };
    for (const MeshCluster& cluster : caster.clusters) {
        for (const CasterLevel& level : cluster.levels)
            EXPECT_EQ(borders(level), borders(cluster.levels.front()));
    }
}

TEST(CasterMesh, LeavesSmallMeshesWhole) {
    EXPECT_EQ(caster_mesh(grid(), 2 * kSide * kSide, Simplify::no).clusters.size(), 1u);
    EXPECT_TRUE(caster_mesh(Mesh{}, 100, Simplify::yes).clusters.empty());
}

}  // namespace
}  // namespace gnomon::raster
