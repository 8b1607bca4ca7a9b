#include "lightmap/texcoords.h"

#include "lightmap/scenes_test.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace gnomon::lightmap {
namespace {

/// Two squares of 1 m that do not meet in the world, side by side on the map: `u` is where the
/// second begins; each is a quarter wide.
Mesh two_squares(float u) {
    Mesh mesh = scene::ground(Vec2(0), Vec2(1));
    scene::append(mesh, scene::ground({3, 0}, {4, 1}));
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3 p = mesh.positions[i];
        const float start = i < mesh.positions.size() / 2 ? 0.25f * p.x : u + 0.25f * (p.x - 3.0f);
        mesh.lightmap_texcoords.emplace_back(start, 0.25f * p.z);
    }
    mesh.texcoords.clear();
    return named(mesh, "roof");
}

TexcoordFaults faults_of(const Mesh& mesh, int set = 1) {
    const Scene scene = scene_of({mesh});
    return check_texcoords(mesh, set, Surface(scene, 0, false).faces(), {.texel_size_m = 0.1});
}

std::string warning_of(const Mesh& mesh) {
    const Atlas atlas = make_atlas(scene_of({mesh}), {.texel_size_m = 0.1});
    EXPECT_EQ(atlas.warnings.size(), 1u);
    EXPECT_TRUE(std::ranges::all_of(atlas.charts, [](auto& c) { return c.texcoord_set == -1; }));
    return atlas.warnings.empty() ? "" : atlas.warnings.front();
}

TEST(Texcoords, ALightMapIsKept) {
    const Mesh mesh = two_squares(0.5f);
    EXPECT_TRUE(faults_of(mesh).none());
    const Atlas atlas = make_atlas(scene_of({mesh}), {.texel_size_m = 0.1});
    EXPECT_TRUE(atlas.warnings.empty());
    ASSERT_EQ(atlas.charts.size(), 2u);
    for (const Chart& chart : atlas.charts) {
        EXPECT_EQ(chart.texcoord_set, 1);
        EXPECT_EQ(chart.size, (Extent{10, 10})) << "1 m at 0.1 m";
    }
    // A quarter of the map is 1 m: the second square lies as far from the first as it did.
    EXPECT_EQ(atlas.charts[1].x - atlas.charts[0].x, 20u);
    EXPECT_EQ(make_atlas(scene_of({mesh}), {.texel_size_m = 0.1, .keep_texcoords = false})
                  .charts[0]
                  .texcoord_set,
              -1);
}

TEST(Texcoords, OverlapIsCounted) {
    EXPECT_EQ(faults_of(two_squares(0.125f)).overlapping, 4u);
    EXPECT_EQ(warning_of(two_squares(0.0f)),
              "mesh \"roof\": 4 triangles overlap, 4 are within 2 texels of another island in "
              "TEXCOORD_1: it gets coordinates of its own");
}

TEST(Texcoords, IslandsKeepThePadding) {
    // A texel is 0.025 wide; squares end at 0.25.
    EXPECT_TRUE(faults_of(two_squares(0.30f)).none()) << "2 clear texels";
    const TexcoordFaults faults = faults_of(two_squares(0.275f));
    EXPECT_EQ(faults.crowded, 4u) << "1 clear texel";
    EXPECT_EQ(faults.overlapping, 0u);
    EXPECT_EQ(warning_of(two_squares(0.275f)),
              "mesh \"roof\": 4 triangles are within 2 texels of another island in TEXCOORD_1: it "
              "gets coordinates of its own");
}

TEST(Texcoords, CoordinatesOutsideTheMapAreCounted) {
    EXPECT_EQ(faults_of(two_squares(0.9f)).outside, 2u);
    EXPECT_EQ(faults_of(two_squares(0.75f)).outside, 0u) << "1 is on the map";
    EXPECT_EQ(warning_of(two_squares(0.9f)),
              "mesh \"roof\": 2 triangles lie outside [0, 1] in TEXCOORD_1: it gets coordinates of "
              "its own");
}

TEST(Texcoords, FlippedTrianglesAreCounted) {
    // A strip of three squares; the last corners are folded back over the second.
    Mesh strip = scene::height_field(Vec2(0), {3, 1}, 3, 1, [](float, float) { return 0.0f; });
    strip.name = "roof";
    strip.texcoords.clear();
    for (const Vec3 p : strip.positions)
        strip.lightmap_texcoords.emplace_back(0.25f * (p.x == 3.0f ? 1.5f : p.x), 0.25f * p.z);
    const TexcoordFaults faults = faults_of(strip);
    EXPECT_EQ(faults.flipped, 2u);
    EXPECT_EQ(faults.overlapping, 4u);
    EXPECT_NE(warning_of(strip).find("2 triangles are flipped"), std::string::npos);

    // An island that is mirrored as a whole folds nothing.
    Mesh mirrored = two_squares(0.5f);
    for (std::size_t i = mirrored.positions.size() / 2; i < mirrored.positions.size(); ++i)
        mirrored.lightmap_texcoords[i].x = 1.25f - mirrored.lightmap_texcoords[i].x;
    EXPECT_TRUE(faults_of(mirrored).none());
}

TEST(Texcoords, TrianglesWithoutAreaOnTheMapAreCounted) {
    Mesh mesh = two_squares(0.5f);
    for (std::size_t i = mesh.positions.size() / 2; i < mesh.positions.size(); ++i)
        mesh.lightmap_texcoords[i].y = 0.0f;
    EXPECT_EQ(faults_of(mesh).no_area, 2u);
    EXPECT_NE(warning_of(mesh).find("2 triangles have no area"), std::string::npos);
    mesh.lightmap_texcoords.assign(mesh.positions.size(), Vec2(0.5f));
    EXPECT_EQ(faults_of(mesh).no_area, 4u) << "all at one point";
    // Without area in the world they need none on the map.
    Mesh line = two_squares(0.5f);
    line.positions[0] = line.positions[1];
    line.lightmap_texcoords[0] = line.lightmap_texcoords[1];
    EXPECT_EQ(faults_of(line).no_area, 0u);
}

TEST(Texcoords, TheTexturesSetServesWhenSetOneDoesNot) {
    Mesh mesh = two_squares(0.0f);
    mesh.texcoords = two_squares(0.5f).lightmap_texcoords;
    const Atlas atlas = make_atlas(scene_of({mesh}), {.texel_size_m = 0.1});
    EXPECT_EQ(atlas.charts.at(0).texcoord_set, 0);
    ASSERT_EQ(atlas.warnings.size(), 1u);
    EXPECT_NE(atlas.warnings[0].find("TEXCOORD_1: its texture's coordinates serve"),
              std::string::npos);
}

TEST(Texcoords, AMapLargerThanAPageIsNamed) {
    const Atlas atlas =
        make_atlas(scene_of({two_squares(0.75f)}), {.texel_size_m = 0.1, .max_page_texels = 32});
    ASSERT_EQ(atlas.warnings.size(), 1u);
    EXPECT_EQ(atlas.warnings[0],
              "mesh \"roof\": TEXCOORD_1 would be 40 texels wide, more than a page of 32: it gets "
              "coordinates of its own");
}

TEST(Texcoords, EveryInstanceHasTheWantedTexelsOnTheAverage) {
    const Scene scene = placed(two_squares(0.5f), {Mat4(1.0f), scene::scaling(Vec3(3.0f))});
    const Atlas atlas = make_atlas(scene, {.texel_size_m = 0.1});
    ASSERT_EQ(atlas.charts.size(), 4u);
    EXPECT_EQ(atlas.charts[0].size, (Extent{10, 10}));
    EXPECT_EQ(atlas.charts[2].size, (Extent{30, 30}));
    for (const Facet& facet : atlas.facets)
        EXPECT_NEAR(glm::length(glm::cross(facet.u_ws, facet.v_ws)), 0.01, 1e-9);
}

}  // namespace
}  // namespace gnomon::lightmap
