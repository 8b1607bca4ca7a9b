#include "raster/caster_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

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
    const CasterMesh caster = caster_mesh(mesh, 100);
    EXPECT_EQ(as_set(caster.triangles), as_set(mesh.triangles));
    ASSERT_EQ(caster.clusters.size(), 32u);
    std::uint32_t next = 0;
    double area = 0.0;
    for (const MeshCluster& cluster : caster.clusters) {
        EXPECT_EQ(cluster.first_triangle, next);
        next += cluster.triangle_count;
        const Vec3 size = cluster.bounds.size();
        area += static_cast<double>(size.x) * static_cast<double>(size.y);
        for (std::uint32_t i = cluster.first_triangle; i < next; ++i) {
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

TEST(CasterMesh, LeavesSmallMeshesWhole) {
    EXPECT_EQ(caster_mesh(grid(), 2 * kSide * kSide).clusters.size(), 1u);
    EXPECT_TRUE(caster_mesh(Mesh{}, 100).clusters.empty());
}

}  // namespace
}  // namespace gnomon::raster
