#include "scene/winding.h"

#include <gtest/gtest.h>

#include <utility>

namespace gnomon::scene {
namespace {

// A tetrahedron; from outside its triangles are counter-clockwise.
const std::vector<Vec3> kCorners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<UVec3> kSolid{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

std::vector<UVec3> turned(std::vector<UVec3> triangles) {
    for (UVec3& t : triangles)
        std::swap(t.y, t.z);
    return triangles;
}

/// Both, side by side.
Winding winding_of_both(const std::vector<UVec3>& first, const std::vector<UVec3>& second) {
    std::vector<Vec3> positions = kCorners;
    std::vector<UVec3> triangles = first;
    for (const Vec3& p : kCorners)
        positions.push_back(p + Vec3(3, 0, 0));
    for (const UVec3& t : second)
        triangles.push_back(t + UVec3(4));
    return winding_of(positions, triangles);
}

TEST(Winding, TellsTheOutsideOfASolid) {
    EXPECT_EQ(winding_of(kCorners, kSolid), Winding::outward);
    EXPECT_EQ(winding_of(kCorners, turned(kSolid)), Winding::inward);
    EXPECT_EQ(mirrored(Winding::outward), Winding::inward);
    EXPECT_EQ(mirrored(Winding::open), Winding::open);
}

TEST(Winding, DoesNotDependOnWhereTheSolidIs) {
    std::vector<Vec3> far = kCorners;
    for (Vec3& p : far)
        p += Vec3(-1000, 500, 2000);
    EXPECT_EQ(winding_of(far, kSolid), Winding::outward);
}

TEST(Winding, IsOpenWithAHole) {
    const std::span<const UVec3> all(kSolid);
    EXPECT_EQ(winding_of(kCorners, all.first(3)), Winding::open);
    EXPECT_EQ(winding_of(kCorners, {}), Winding::open);
}

TEST(Winding, IsOpenWhenOneTriangleIsTurned) {
    std::vector<UVec3> triangles = kSolid;
    std::swap(triangles.front().y, triangles.front().z);
    EXPECT_EQ(winding_of(kCorners, triangles), Winding::open);
}

TEST(Winding, IsOpenWhenPartsDiffer) {
    EXPECT_EQ(winding_of_both(kSolid, kSolid), Winding::outward);
    EXPECT_EQ(winding_of_both(kSolid, turned(kSolid)), Winding::open);
}

TEST(Winding, IsOpenWithoutVolume) {
    EXPECT_EQ(winding_of(kCorners, std::vector<UVec3>{{0, 1, 2}, {0, 2, 1}}), Winding::open);
}

TEST(Winding, IgnoresTrianglesThatAreNone) {
    std::vector<UVec3> triangles = kSolid;
    triangles.emplace_back(2, 2, 3);
    EXPECT_EQ(winding_of(kCorners, triangles), Winding::outward);
}

}  // namespace
}  // namespace gnomon::scene
