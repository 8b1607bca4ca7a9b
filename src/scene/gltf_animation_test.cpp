#include "scene/gltf_animation.h"

#include "scene/caster_changes.h"
#include "scene/load_test_scene.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gnomon::scene {
namespace {

using nlohmann::json;

TEST(SampleKeys, StepsBlendsAndClamps) {
    const std::vector<float> times{1, 3};
    const std::vector<float> values{10, 20};
    const auto at = [&](Interpolation how, double t) {
        return sample_keys(times, values, 1, how, false, t).at(0);
    };
    EXPECT_EQ(at(Interpolation::linear, 0.0), 10.0);
    EXPECT_EQ(at(Interpolation::linear, 1.5), 12.5);
    EXPECT_EQ(at(Interpolation::linear, 9.0), 20.0);
    EXPECT_EQ(at(Interpolation::step, 2.9), 10.0);
    EXPECT_EQ(at(Interpolation::step, 3.0), 20.0);
}

TEST(SampleKeys, CubicSplineIsExactForACubic) {
    // f(t) = t³ at 1 and 3 with f'(t) = 3t²: a Hermite spline between them is f itself.
    const std::vector<float> times{1, 3};
    const std::vector<float> values{3, 1, 3, 27, 27, 27};
    EXPECT_NEAR(sample_keys(times, values, 1, Interpolation::cubic_spline, false, 2.0).at(0), 8.0,
                1e-12);
    EXPECT_EQ(sample_keys(times, values, 1, Interpolation::cubic_spline, false, 0.0).at(0), 1.0);
}

TEST(SampleKeys, RotationsGoAlongTheShorterArc) {
    // From 0° to 90° about Z, the second quaternion with its sign flipped, which is the same turn.
    const auto half = static_cast<float>(std::sqrt(0.5));
    const std::vector<double> q =
        sample_keys({0, 1}, {0, 0, 0, 1, 0, 0, -half, -half}, 4, Interpolation::linear, true, 0.5);
    EXPECT_NEAR(std::abs(q[3]), std::cos(kPi / 8), 1e-6);
    EXPECT_NEAR(q[2] / q[3], std::tan(kPi / 8), 1e-6);
}

// A channel that moves `path` of node `node` over times 0 and 2.
void animate_node(TestGltf& gltf, int node, const std::string& path, const std::string& type,
                  int components, const std::vector<float>& values) {
    const int input = gltf.floats("SCALAR", 1, {0, 2});
    const int output = gltf.floats(type, components, values);
    json& animation = gltf.json["animations"][0];
    animation["samplers"].push_back({{"input", input}, {"output", output}});
    animation["channels"].push_back({{"sampler", animation["samplers"].size() - 1},
                                     {"target", {{"node", node}, {"path", path}}}});
}

TEST(GltfAnimation, NodesAreWhereTheTimeHasThem) {
    TestGltf gltf;
    gltf.add_triangle();
    animate_node(gltf, 0, "translation", "VEC3", 3, {0, 0, 0, 8, 0, 0});
    const auto x_at = [&](double time_s) {
        return corner_in_file(gltf.load({.animation_time_s = time_s}), 0, 0, 0).x;
    };
    EXPECT_NEAR(x_at(0.0), 0.0, kRounding);
    EXPECT_NEAR(x_at(0.5), 2.0, kRounding);
    EXPECT_NEAR(x_at(100.0), 8.0, kRounding);
}

TEST(GltfAnimation, AnAnimationThatIsNotThereIsAnError) {
    TestGltf gltf;
    gltf.add_triangle();
    EXPECT_EQ(gltf.error({.animation = 3}), "") << "there is none to choose from";
    animate_node(gltf, 0, "translation", "VEC3", 3, {0, 0, 0, 8, 0, 0});
    EXPECT_NE(gltf.error({.animation = 1}).find("no animation 1"), std::string::npos);
    EXPECT_NE(gltf.error({.animation = -1}).find("no animation -1"), std::string::npos);
}

TEST(GltfAnimation, DamagedChannelsAreLeftOut) {
    TestGltf gltf;
    gltf.add_triangle();
    animate_node(gltf, 0, "translation", "VEC2", 2, {0, 0, 8, 0});
    animate_node(gltf, 0, "rotation", "VEC4", 4, {0, 0, 0, 1});
    animate_node(gltf, 0, "colour", "VEC3", 3, {0, 0, 0, 8, 0, 0});
    animate_node(gltf, 0, "scale", "VEC3", 3, {2, 2, 2, 2, 2, 2});
    const Scene scene = gltf.load({.animation_time_s = 1.0});
    EXPECT_TRUE(has_warning(scene, "damaged animation channel"));
    expect_near(corner_in_file(scene, 0, 0, 1), {2, 0, 0}, kRounding);
}

TEST(GltfAnimation, MorphTargetsMoveVertices) {
    TestGltf gltf;
    const int positions = gltf.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int up = gltf.vec3({0, 0, 0, 0, 0, 0, 0, 2, 0});
    const int out = gltf.vec3({0, 0, 4, 0, 0, 4, 0, 0, 4});
    gltf.mesh({{"attributes", {{"POSITION", positions}}},
               {"targets", {{{"POSITION", up}}, {{"POSITION", out}}}}});
    gltf.json["meshes"][0]["weights"] = {0.5, 0};
    // Node 1 overrides the mesh's weights.
    gltf.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"weights", {0, 1}}}};
    gltf.json["scenes"][0]["nodes"] = {0, 1};
    const Scene still = gltf.load();
    EXPECT_EQ(still.meshes().size(), 2u);
    expect_near(corner_in_file(still, 0, 0, 2), {0, 2, 0}, kRounding);
    expect_near(corner_in_file(still, 1, 0, 2), {0, 1, 4}, kRounding);

    animate_node(gltf, 0, "weights", "SCALAR", 1, {0, 0, 1, 0.5});
    const Scene moved = gltf.load({.animation_time_s = 1.0});
    expect_near(corner_in_file(moved, 0, 0, 2), {0, 2, 1}, kRounding);
}

// A triangle whose corners follow joint 0, joint 1, and both by halves. Joint 1 is at (0, 1, 0),
// and turns by 180° about Z in two seconds, by way of 90°.
TestGltf skinned_triangle(double offset_m = 0.0) {
    TestGltf gltf;
    const int positions = gltf.vec3({0, 0, 0, 0, 2, 0, 0, 2, 0});
    const int view = gltf.view(std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0});
    const int joints = gltf.accessor(
        {{"bufferView", view}, {"componentType", 5121}, {"count", 3}, {"type", "VEC4"}});
    const int weights = gltf.floats("VEC4", 4, {1, 0, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0, 0});
    gltf.mesh(
        {{"attributes", {{"POSITION", positions}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}});
    const int binds = gltf.floats("MAT4", 16, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                               1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1});
    gltf.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", binds}}};
    // The skinned node's own transform must not count.
    gltf.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {50, 50, 50}}},
                          {{"children", {2}}, {"translation", {offset_m, 0, 0}}},
                          {{"translation", {0, 1, 0}}}};
    gltf.json["scenes"][0]["nodes"] = {0, 1};
    animate_node(gltf, 2, "rotation", "VEC4", 4, {0, 0, 0, 1, 0, 0, 1, 0});
    return gltf;
}

TEST(GltfAnimation, SkinsFollowTheirJoints) {
    TestGltf gltf = skinned_triangle();
    const Scene rest = gltf.load();
    expect_near(corner_in_file(rest, 0, 0, 1), {0, 2, 0}, kRounding);
    EXPECT_EQ(rest.instances().at(0).world_from_local, Mat4(1.0f));
    const Scene bent = gltf.load({.animation_time_s = 1.0});
    expect_near(corner_in_file(bent, 0, 0, 0), {0, 0, 0}, kRounding);
    expect_near(corner_in_file(bent, 0, 0, 1), {-1, 1, 0}, kRounding);
    expect_near(corner_in_file(bent, 0, 0, 2), {-0.5, 1.5, 0}, kRounding);
    EXPECT_TRUE(bent.warnings().empty());
}

// Beside it stands a triangle that rests.
TEST(GltfAnimation, PosesOfASkinAreToldFromWhatRests) {
    TestGltf gltf = skinned_triangle();
    gltf.json["nodes"].push_back({{"mesh", 0}});
    gltf.json["scenes"][0]["nodes"] = {0, 1, 3};
    const Scene rest = gltf.load();
    ASSERT_EQ(rest.instances().size(), 2u);
    EXPECT_EQ(changed_casters(rest, gltf.load({.animation_time_s = 1.0})),
              std::vector<std::uint32_t>{0});
    EXPECT_EQ(changed_casters(rest, gltf.load()), std::vector<std::uint32_t>{});
}

TEST(GltfAnimation, SkinsFarFromTheOriginLoseNothing) {
    TestGltf gltf = skinned_triangle(500000.0);
    const Scene bent = gltf.load({.animation_time_s = 1.0});
    expect_near(corner_in_file(bent, 0, 0, 2), {499999.5, 1.5, 0}, kRounding);
}

TEST(GltfAnimation, ImpossibleJointsAreAWarning) {
    TestGltf gltf = skinned_triangle();
    gltf.json["skins"][0]["joints"] = {1};
    const Scene scene = gltf.load();
    EXPECT_TRUE(has_warning(scene, "impossible joints"));
    EXPECT_EQ(scene.triangle_count(), 1u);
}

}  // namespace
}  // namespace gnomon::scene
