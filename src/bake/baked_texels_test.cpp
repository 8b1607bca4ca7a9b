#include "bake/baked_texels.h"

#include "bake/circle_path.h"

#include <gtest/gtest.h>

namespace gnomon::bake {
namespace {

constexpr DVec3 kUp(0.0, 1.0, 0.0);
const DVec3 kPole = glm::normalize(DVec3(0.0, 0.74, -0.67));
const DVec3 kToSun = glm::normalize(DVec3(-0.4, 0.7, 0.5));

// Walls that go on below a ground of two sides: texels there repeat what is above.
TEST(BakedTexels, TheFootOfAWallInASheetOfGroundIsLit) {
    Mesh ground;
    ground.positions = {{-4, 0, -4}, {-4, 0, 4}, {4, 0, 4}, {4, 0, -4}};
    ground.triangles = {{0, 1, 2}, {0, 2, 3}};
    Mesh wall;
    wall.positions = {{1, -0.13f, -1}, {1, -0.13f, 1}, {1, 0.5f, 1}, {1, 0.5f, -1}};
    wall.triangles = {{0, 2, 1}, {0, 3, 2}};
    SceneData data;
    data.materials.push_back({.double_sided = true});
    data.meshes = {ground, wall};
    data.instances.resize(2);
    data.instances[1].mesh = 1;
    const Scene scene(std::move(data));
    const PathThrough through = circle_through(kToSun, kPole, kUp, 100);
    Progress silent;
    const BakedTexels baked = baked_texels(
        scene, through.path, {.texel_size_m = 0.1, .bits = BakeBits::sixteen, .resume_file = {}},
        {.lit_sides_only = true, .fine_parts = 4}, silent);
    const TexelFinder finder(baked);
    const LightOnPath light{.window = {.at_step = 80.0, .width_steps = 1.0, .codes_per_step = 64}};
    const trace::Receiver foot{{1, 0.01f, 0.02f}, {1, 0, 0}, {1, 0}};
    const lightmap::Facet* facet = finder.facet_of(foot);
    ASSERT_NE(facet, nullptr);
    for (const TexelLookup lookup :
         {TexelLookup::nearest, TexelLookup::interpolated, TexelLookup::edges})
        EXPECT_DOUBLE_EQ(finder.visibility(*facet, foot, lookup, light), 1.0);
}

// A cover just above the ground: on one side of its edge it is always dark, on the other always
// lit, so no time tells where between two texels the edge is.
TEST(BakedTexels, FineCellsFindAnEdgeThatStays) {
    constexpr float kEdge_m = 0.033f;
    const auto sheet = [](float least_x, float y) {
        Mesh mesh;
        mesh.positions = {{least_x, y, -2}, {least_x, y, 2}, {2, y, 2}, {2, y, -2}};
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
        return mesh;
    };
    SceneData data;
    data.materials.push_back({.double_sided = true});
    data.meshes = {sheet(-2.0f, 0.0f), sheet(kEdge_m, 0.0005f)};
    data.instances.resize(2);
    data.instances[1].mesh = 1;
    const Scene scene(std::move(data));
    const PathThrough through = circle_through(kToSun, kPole, kUp, 100);
    const LightOnPath light{.window = {.at_step = 50.0, .width_steps = 1.0, .codes_per_step = 64}};
    const auto seen = [&](int fine_parts, float x) {
        Progress silent;
        const BakedTexels baked =
            baked_texels(scene, through.path,
                         {.texel_size_m = 0.1, .bits = BakeBits::sixteen, .resume_file = {}},
                         {.lit_sides_only = true, .fine_parts = fine_parts}, silent);
        const TexelFinder finder(baked);
        const trace::Receiver receiver{{x, 0, 0.02f}, {0, 1, 0}, {0, 0}};
        const lightmap::Facet* facet = finder.facet_of(receiver);
        return facet == nullptr ? -1.0
                                : finder.visibility(*facet, receiver, TexelLookup::edges, light);
    };
    // A part of a cell, within which results are mixed, is 0.025 m.
    EXPECT_DOUBLE_EQ(seen(4, kEdge_m - 0.03f), 1.0);
    EXPECT_DOUBLE_EQ(seen(4, kEdge_m + 0.03f), 0.0);
    EXPECT_GT(seen(1, kEdge_m + 0.03f) + 1.0 - seen(1, kEdge_m - 0.03f), 0.2);
}

}  // namespace
}  // namespace gnomon::bake
