#include "scene/shapes.h"

#include "scene/builtin_carved_shell.h"
#include "scene/shapes_check_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace gnomon::scene {
namespace {

constexpr double kPiD = 3.14159265358979323846;

double volume_m3(const Mesh& mesh) {
    return enclosed_volume(mesh) / 6.0;
}

/// V - E + F of the welded mesh: 2 for a ball, 0 for a ring.
long euler_characteristic(const Mesh& mesh) {
    const std::vector<std::uint32_t> weld = welded(mesh);
    const long vertices = weld.empty() ? 0 : *std::max_element(weld.begin(), weld.end()) + 1L;
    const long faces = static_cast<long>(mesh.triangles.size());
    return vertices - faces * 3 / 2 + faces;
}

void expect_closed(const Mesh& mesh) {
    EXPECT_EQ(closedness_fault(mesh), "");
    EXPECT_EQ(shape_fault(mesh), "");
}

TEST(Shapes, BoxIsClosedAndHoldsItsVolume) {
    const Mesh mesh = box({-1.0f, 0.0f, 2.0f}, {2.0f, 2.0f, 4.0f});
    expect_closed(mesh);
    EXPECT_EQ(mesh.triangles.size(), 12u);
    EXPECT_DOUBLE_EQ(volume_m3(mesh), 12.0);
}

TEST(Shapes, RectangularWallIsARing) {
    const Mesh mesh = rectangular_wall({-2.0f, 0.0f, -3.0f}, {2.0f, 1.0f, 3.0f}, 0.5f);
    expect_closed(mesh);
    EXPECT_EQ(euler_characteristic(mesh), 0);
    EXPECT_DOUBLE_EQ(volume_m3(mesh), 4.0 * 6.0 - 3.0 * 5.0);
}

TEST(Shapes, CylinderHoldsAPrismOfItsPolygon) {
    constexpr int kSides = 24;
    const Mesh mesh = cylinder(0.5f, -1.0f, 2.0f, kSides);
    expect_closed(mesh);
    const double area = 0.5 * kSides * 0.25 * std::sin(2.0 * kPiD / kSides);
    EXPECT_NEAR(volume_m3(mesh), 3.0 * area, 1e-6);  // float positions
}

TEST(Shapes, SphereIsRoundAndItsNormalsAreRadial) {
    const Mesh mesh = sphere(2.0f, 48, 24);
    expect_closed(mesh);
    EXPECT_EQ(mesh.triangles.size(), 48u * 2u * 23u);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        EXPECT_NEAR(glm::length(mesh.positions[i]), 2.0f, 1e-6f);
        // Mean of two faces' normals, which are equally far off.
        EXPECT_GT(glm::dot(mesh.normals[i], normalize(mesh.positions[i])), 0.9999f);
    }
}

TEST(Shapes, LatheKeepsCreasesSharpAndCurvesSmooth) {
    // A cone's mantle meets its base at more than the crease angle: no normal is in between.
    const Mesh cone = lathe({{0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}}, 16);
    expect_closed(cone);
    for (const Vec3 n : cone.normals)
        EXPECT_TRUE(n.y == -1.0f || std::abs(n.y - std::sqrt(0.5f)) < 1e-6f);
}

TEST(Shapes, TubesAreClosedWhetherTheirPathIsOrNot) {
    const Mesh open = tube({{0, 0, 0}, {0, 1, 0}, {0.3f, 2, 0}, {1, 2.5f, 0.4f}}, 0.1f, 9);
    expect_closed(open);
    EXPECT_EQ(euler_characteristic(open), 2);
    const Mesh ring = torus(1.0f, 0.25f, 48, 16);
    expect_closed(ring);
    EXPECT_EQ(euler_characteristic(ring), 0);
    // The torus of both polygons: Pappus' theorem, with the mean radius of the major polygon.
    const double minor_area = 0.5 * 16 * 0.0625 * std::sin(2.0 * kPiD / 16);
    const double mean_path = 48 * std::sin(2.0 * kPiD / 48);
    EXPECT_NEAR(volume_m3(ring), minor_area * mean_path, 0.01 * minor_area * mean_path);
}

TEST(Shapes, ClosedTubeTakesBackItsTwist) {
    // On a path that leaves the plane the frames come back turned. Where the last ring meets the
    // first, corresponding points must be as far apart as anywhere else.
    constexpr int kPoints = 96;
    constexpr int kSides = 12;
    std::vector<Vec3> path;
    for (int i = 0; i < kPoints; ++i) {
        const double t = 2.0 * kPiD * i / kPoints;
        path.emplace_back((2.0 + std::cos(3 * t)) * std::cos(2 * t),
                          (2.0 + std::cos(3 * t)) * std::sin(2 * t), std::sin(3 * t));
    }
    const Mesh mesh = tube(path, 0.3f, kSides, true);
    expect_closed(mesh);
    float longest = 0.0f;
    for (int i = 0; i + 1 < kPoints; ++i) {
        const Vec3 step = mesh.positions[static_cast<std::size_t>((i + 1) * kSides)] -
                          mesh.positions[static_cast<std::size_t>(i * kSides)];
        longest = std::max(longest, glm::length(step));
    }
    const Vec3 seam = mesh.positions[0] - mesh.positions[(kPoints - 1) * kSides];
    EXPECT_LE(glm::length(seam), longest);
}

TEST(Shapes, ExtrudesConcaveOutlines) {
    const std::vector<Vec2> comb{{0, 0}, {5, 0}, {5, 3}, {4, 3}, {4, 1}, {3, 1},
                                 {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
    const Mesh mesh = extrude(comb, -1.0f, 1.0f);
    expect_closed(mesh);
    EXPECT_DOUBLE_EQ(volume_m3(mesh), 2.0 * (5.0 + 3.0 * 2.0));
}

TEST(Shapes, TriangulationHandlesPointsOnStraightEdges) {
    const std::vector<Vec2> square{{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {0, 2}};
    const Mesh mesh = extrude(square, 0.0f, 1.0f);
    expect_closed(mesh);
    EXPECT_DOUBLE_EQ(volume_m3(mesh), 4.0);
}

TEST(Shapes, HeightFieldFacesUpAndFollowsItsFunction) {
    const Mesh mesh = height_field({-1.0f, -2.0f}, {3.0f, 2.0f}, 4, 8,
                                   [](float x, float z) { return x - 2.0f * z; });
    EXPECT_EQ(shape_fault(mesh), "");
    EXPECT_EQ(mesh.triangles.size(), 64u);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3 p = mesh.positions[i];
        EXPECT_FLOAT_EQ(p.y, p.x - 2.0f * p.z);
        EXPECT_EQ(mesh.texcoords[i], Vec2(p.x, p.z));
        EXPECT_NEAR(glm::length(mesh.normals[i] - normalize({-1.0f, 1.0f, 2.0f})), 0.0f, 1e-5f);
    }
}

TEST(Shapes, AppendKeepsTheStreamsOfTheFirst) {
    Mesh mesh = box(Vec3(0.0f), Vec3(1.0f));
    append(mesh, ground(Vec2(-1.0f), Vec2(1.0f)));
    EXPECT_EQ(mesh.positions.size(), 28u);
    EXPECT_EQ(mesh.normals.size(), 28u);
    EXPECT_TRUE(mesh.texcoords.empty());
    EXPECT_EQ(mesh.triangles.back(), UVec3(24, 27, 25));
}

TEST(Shapes, MovedTurnsNormalsWithTheirFaces) {
    const Mesh mesh =
        moved(sphere(1.0f, 24, 12),
              translation({1.0f, 2.0f, 3.0f}) * rotation_x(0.7f) * scaling({2.0f, 1.0f, 0.5f}));
    expect_closed(mesh);
}

TEST(CarvedShell, IsClosedWithItsHoles) {
    const auto ball = [](float radius_m) {
        return [radius_m](Vec3 direction) { return radius_m * direction; };
    };
    // Two round holes: the surface of a shell with two holes through it is a torus.
    const auto outline = [](Vec3 direction) {
        return 0.9f - std::abs(glm::dot(direction, normalize({0.6f, 0.1f, 0.8f})));
    };
    const Mesh mesh = carved_shell(ball(1.0f), ball(0.8f), outline, 64, 32);
    expect_closed(mesh);
    EXPECT_EQ(euler_characteristic(mesh), 0);
    // What is left of each sphere lies between two caps of height 0.1 r: nine tenths.
    const double full = 4.0 / 3.0 * kPiD * (1.0 - 0.8 * 0.8 * 0.8);
    EXPECT_NEAR(volume_m3(mesh) / full, 0.9, 0.01);  // facets, and outlines of 64 directions
}

TEST(CarvedShell, WithoutHolesIsTwoSurfaces) {
    const auto ball = [](Vec3 direction) { return direction; };
    const Mesh solid = star_solid(ball, 32, 16);
    expect_closed(solid);
    EXPECT_EQ(euler_characteristic(solid), 2);
}

}  // namespace
}  // namespace gnomon::scene
