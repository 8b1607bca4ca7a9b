#include "lighting/averaged_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace gnomon::lighting {
namespace {

constexpr Vec3 kUp{0, 0, 1};

/// A white light of that irradiance where it arrives, from a unit vector.
StrongVertexLight lit(Vec3 to_light_ws, float irradiance) {
    return {{to_light_ws, 1.0f}, Vec3(irradiance)};
}

float degrees_between(Vec3 a, Vec3 b) {
    return degrees(std::acos(std::min(1.0f, glm::dot(a, b))));
}

TEST(AveragedLight, OppositeLightsGiveNoZeroButStraightUp) {
    const std::vector<StrongVertexLight> lights{lit({1, 0, 0}, 1.0f), lit({-1, 0, 0}, 1.0f)};
    EXPECT_LT(degrees_between(averaged_light_ts(lights, {}, 1.0f), kUp), 0.1f);
    EXPECT_EQ(averaged_light_ts({}, {}, 1.0f), kUp);
}

TEST(AveragedLight, TheStrongestLightDominates) {
    const Vec3 strong = normalize(Vec3(1, 0, 1)), weak = normalize(Vec3(-1, 0, 1));
    const std::vector<StrongVertexLight> lights{lit(strong, 1.0f), lit(weak, 0.1f)};
    const Vec3 average = averaged_light_ts(lights, {}, 1.0f);
    EXPECT_LT(degrees_between(average, strong), 12.0f);
    EXPECT_GT(degrees_between(average, weak), 75.0f);
}

// As a light turns on the direction moves towards it, by steps as small as the light's.
TEST(AveragedLight, FollowsALightThatIsTurnedOn) {
    const Vec3 rising = normalize(Vec3(1, 0, 1));
    float last_deg = degrees_between(kUp, rising);
    for (int step = 1; step <= 100; ++step) {
        const std::vector<StrongVertexLight> lights{lit(rising, 0.01f * static_cast<float>(step))};
        const float off_deg = degrees_between(averaged_light_ts(lights, {}, 1.0f), rising);
        EXPECT_LT(off_deg, last_deg);
        EXPECT_GT(off_deg, last_deg - 5.0f);
        last_deg = off_deg;
    }
    // atan(0.1 sin 45° / (1 + 0.1 cos 45°)): what the bias leaves.
    EXPECT_NEAR(last_deg, degrees(std::atan(0.0707f / 1.0707f)), 0.05f);
}

TEST(AveragedLight, IsInTheSpaceOfTheTangents) {
    const TangentFrame wall{
        .tangent_ws = {0, 0, -1}, .bitangent_ws = {0, 1, 0}, .normal_ws = {1, 0, 0}};
    const std::vector<StrongVertexLight> lights{lit({0, 1, 0}, 1000.0f)};
    const Vec3 average = averaged_light_ts(lights, wall, 1.0f);
    EXPECT_NEAR(average.y, 1.0f, 1e-4f);
    EXPECT_GT(average.z, 0.0f);
    EXPECT_EQ(average.x, 0.0f);
}

TEST(AveragedLight, FlatSurfacesKeepTheirColour) {
    const Vec3 average = normalize(Vec3(3, 1, 2));
    EXPECT_FLOAT_EQ(bump_factor(average, kUp), 1.0f);
    EXPECT_GT(bump_factor(average, normalize(Vec3(0.3f, 0.1f, 1))), 1.0f);
    EXPECT_LT(bump_factor(average, normalize(Vec3(-0.3f, -0.1f, 1))), 1.0f);
    EXPECT_EQ(bump_factor(average, normalize(Vec3(-1, -0.3f, 0.2f))), 0.0f);
    EXPECT_EQ(bump_factor(normalize(Vec3(1, 0, 0.01f)), {1, 0, 0}), kMostBumpFactor);
}

TEST(AveragedLight, IrradianceAddsUpByStrengthShareAndCosine) {
    const std::vector<StrongVertexLight> lights{{{kUp, 0.5f}, {4, 0, 0}},
                                                {{normalize(Vec3(1, 0, 1)), 0.25f}, {0, 8, 0}},
                                                {{{0, 0, -1}, 1.0f}, {0, 0, 9}}};
    const Vec3 sum = vertex_irradiance(lights, kUp);
    EXPECT_FLOAT_EQ(sum.x, 2.0f);
    EXPECT_FLOAT_EQ(sum.y, std::sqrt(2.0f));
    EXPECT_EQ(sum.z, 0.0f) << "from below";
}

TEST(AveragedLight, LightsReachAsFarAsTheirGreatestIntensity) {
    const Vec3 greatest(25, 100, 4);
    const float reach = light_reach_m(greatest, 0.25f);
    EXPECT_FLOAT_EQ(reach, 20.0f);
    const PointLight light{.intensity = greatest};
    EXPECT_FLOAT_EQ(light_attenuation(light, {0, reach, 0}) * greatest.y, 0.25f);
}

TEST(AveragedLight, AttenuationIsThatOfTheLightsKind) {
    const Vec3 below(0, -2, 0), beside(2, 0, 0);
    EXPECT_EQ(light_attenuation(DirectionalLight{}, below), 1.0f);
    EXPECT_FLOAT_EQ(light_attenuation(SphereLight{}, below), 0.25f);
    EXPECT_FLOAT_EQ(light_attenuation(DiscLight{}, below), 0.25f);
    EXPECT_EQ(light_attenuation(DiscLight{}, beside), 0.0f);
    EXPECT_FLOAT_EQ(light_attenuation(DiscLight{}, {2, -2, 0}), 0.125f * std::sqrt(0.5f));
    EXPECT_FLOAT_EQ(
        light_attenuation(RectLight{.half_u_ws = {1, 0, 0}, .half_v_ws = {0, 0, 1}}, {0, 2, 0}),
        0.0f)
        << "cross(u, v) points down";
    EXPECT_FLOAT_EQ(light_attenuation(SpotLight{}, below), 0.25f);
    EXPECT_EQ(light_attenuation(SpotLight{}, beside), 0.0f);
}

/// A roof at y = 1 over the half of the ground where x < 0.
Scene roof() {
    SceneData data;
    data.materials.emplace_back();
    Mesh mesh;
    mesh.positions = {{-10, 1, -10}, {-10, 1, 10}, {0, 1, 10}, {0, 1, -10}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    data.meshes = {mesh};
    data.instances.emplace_back();
    return Scene(std::move(data));
}

trace::Receiver on_ground(float x_m) {
    return {{x_m, 0, 0}, {0, 1, 0}, {trace::kNoSurface, 0}};
}

// Seen from below the roof's edge half of a square light is hidden; the mean direction is to the
// middle of the other half.
TEST(AveragedLight, PointsToWhatIsSeenOfALight) {
    Progress silent;
    const trace::Tracer tracer(roof(), false, silent);
    constexpr float kHeight_m = 20.0f, kHalf_m = 1.0f;
    const RectLight light{
        .center_ws = {0, kHeight_m, 0}, .half_u_ws = {kHalf_m, 0, 0}, .half_v_ws = {0, 0, kHalf_m}};
    const std::vector<trace::Receiver> vertices{on_ground(0.0f), on_ground(-5.0f), on_ground(5.0f)};
    constexpr int kSamples = 1024;
    const std::vector<VertexLight> lights =
        trace_vertex_light(tracer, vertices, light, kSamples, 1, silent);
    // A row of 32 strata is cut by the edge: each errs by a variance of 1/4 at most.
    const double error = 4.0 * std::sqrt(32.0 / 4.0) / kSamples;
    EXPECT_NEAR(lights[0].share * kHeight_m * kHeight_m, 0.5, error);
    EXPECT_NEAR(lights[0].to_light_ws.x, 0.5f * kHalf_m / kHeight_m, error * kHalf_m / kHeight_m);
    EXPECT_NEAR(glm::length(lights[0].to_light_ws), 1.0f, 1e-5f);
    EXPECT_EQ(lights[1].share, 0.0f);
    EXPECT_EQ(lights[1].to_light_ws, Vec3(0.0f));
    EXPECT_FLOAT_EQ(lights[2].share, light_attenuation(light, vertices[2].position_ws));
}

}  // namespace
}  // namespace gnomon::lighting
