#include <gnomon/error.h>
#include <gnomon/vertex_lighting.h>

#include "raster/small_scene_test.h"
#include "visibility/context_test.h"

#include <cmath>
#include <string>
#include <vector>

namespace gnomon {
namespace {

constexpr Extent kSize{16, 16};
/// Of a display value, as in light_picture_test.
constexpr float kTolerance = 1e-3f;
const Vec3 kGrey(linear_from_srgb(188 / 255.0f));

/// A wall of 4 m in the plane z = 0 that faces +Z, whose vertices' normals are all the same.
SceneData wall_data(Vec3 shading_normal = {0, 0, 1}) {
    SceneData data = raster::scene_data({raster::wall(Vec3(0), 4)});
    data.materials[0].base_color = Vec4(kGrey, 1.0f);
    data.meshes[0].normals.assign(data.meshes[0].positions.size(), shading_normal);
    return data;
}

/// Seen from +Z by a parallel camera; a pixel is 1/8 m wide, the picture's middle is the origin.
Frame frame_of(SceneData data) {
    Frame frame{.scene = Scene(std::move(data)), .size = kSize};
    frame.camera = look_at({0, 0, 5}, {0, 0, 0});
    frame.camera.ortho_height_m = 2.0f;
    frame.camera.ortho_depth_m = 10.0f;
    return frame;
}

DirectionalLight sun_at(float angle_deg, Vec3 irradiance = Vec3(2.0f)) {
    return {.to_light_ws = {std::sin(radians(angle_deg)), 0.0f, std::cos(radians(angle_deg))},
            .irradiance = irradiance};
}

float shown(float radiance) {
    return srgb_from_linear(std::min(1.0f, radiance));
}

class VertexLightingTest : public ContextTest {
protected:
    static VertexLighting traced(const Frame& frame, const std::vector<Light>& lights,
                                 const VertexLightingOptions& options = {.edge_m = 0.5}) {
        Progress silent;
        return VertexLighting(frame.scene, lights, options, silent);
    }

    /// With light alone, as it is.
    static Image picture(const Frame& frame, const VertexLighting& lighting,
                         const std::vector<Light>& lights,
                         VertexShading shading = VertexShading::averaged) {
        return vertex_lit_picture(context(), frame, lighting, lights,
                                  {.ambient = Vec3(0.0f), .exposure = 1.0f}, shading);
    }

    static std::string message_of(const Frame& frame, const VertexLighting& lighting,
                                  const std::vector<Light>& lights,
                                  const LightingOptions& options = {}) {
        try {
            vertex_lit_picture(context(), frame, lighting, lights, options);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            return error.what();
        }
        return {};
    }
};

TEST_F(VertexLightingTest, IsLambertsOnAFlatSurface) {
    const Frame frame = frame_of(wall_data());
    for (const float angle : {0.0f, 30.0f, 60.0f}) {
        const std::vector<Light> lights{sun_at(angle)};
        const Image image = picture(frame, traced(frame, lights), lights);
        const float radiance = kGrey.x / kPi * 2.0f * std::cos(radians(angle));
        for (const unsigned i : {0u, 7u, 15u})
            EXPECT_NEAR(image.at(i, 15 - i, 0), shown(radiance), kTolerance);
    }
}

TEST_F(VertexLightingTest, TurnsTheAveragedLightOnTheShadingNormal) {
    // One light of the mean luminance: L = (l + (0, 0, 0.1)) / length.
    for (const float tilt : {-0.6f, 0.3f, 0.6f}) {
        const Vec3 bump = normalize(Vec3(tilt, 0.0f, 0.8f));
        const Frame frame = frame_of(wall_data(bump));
        const std::vector<Light> lights{sun_at(45.0f)};
        const VertexLighting lighting = traced(frame, lights);
        const float side = std::sqrt(0.5f);
        const float flat = kGrey.x / kPi * 2.0f * side;
        const float up = side + kAveragedLightBias;
        const float factor = std::max(0.0f, bump.x * side + bump.z * up) / up;
        EXPECT_NEAR(picture(frame, lighting, lights).at(4, 4, 0), shown(flat * factor), kTolerance);
        EXPECT_NEAR(picture(frame, lighting, lights, VertexShading::flat).at(4, 4, 0), shown(flat),
                    kTolerance);
    }
    // No more than twice.
    const Frame steep = frame_of(wall_data(normalize(Vec3(1, 0, 0.1f))));
    const std::vector<Light> low{sun_at(80.0f)};
    EXPECT_NEAR(picture(steep, traced(steep, low), low).at(4, 4, 0),
                shown(kMostBumpFactor * kGrey.x / kPi * 2.0f * std::cos(radians(80.0f))),
                kTolerance);
}

TEST_F(VertexLightingTest, ColoursAreFreeUpToThoseThatWereTraced) {
    const Frame frame = frame_of(wall_data());
    const std::vector<Light> most{sun_at(0.0f, {2, 2, 2}),
                                  PointLight{.position_ws = {0, 0, 2}, .intensity = Vec3(4.0f)}};
    const VertexLighting lighting = traced(frame, most, {.edge_m = 0.05});
    std::vector<Light> now{sun_at(0.0f, {1.0f, 0.5f, 0.0f}),
                           PointLight{.position_ws = {0, 0, 2}, .intensity = {0, 0, 4}}};
    const Image image = picture(frame, lighting, now);
    EXPECT_NEAR(image.at(8, 8, 0), shown(kGrey.x / kPi), kTolerance);
    EXPECT_NEAR(image.at(8, 8, 1), shown(kGrey.x / kPi * 0.5f), kTolerance);
    EXPECT_NEAR(image.at(8, 8, 2), shown(kGrey.x / kPi * 1.0f), 3 * kTolerance) << "4 / 2 m²";

    now[0] = sun_at(0.0f, {2.1f, 0, 0});
    EXPECT_NE(message_of(frame, lighting, now).find("2.1"), std::string::npos);
    now[0] = sun_at(1.0f);
    EXPECT_NE(message_of(frame, lighting, now).find("not as it was traced"), std::string::npos);
    now.pop_back();
    EXPECT_NE(message_of(frame, lighting, now).find("2 were traced"), std::string::npos);
}

TEST_F(VertexLightingTest, ShadowsAreRampsOfACell) {
    // A screen before the left half, in the light's way and not in the eye's.
    SceneData data = wall_data();
    SceneData screen = raster::scene_data({raster::wall(Vec3(-2.0f, 0.0f, 6.0f), 4)});
    screen.meshes[0].normals.assign(4, Vec3(0, 0, 1));
    data.meshes.push_back(screen.meshes[0]);
    data.instances.push_back(data.instances[0]);
    data.instances.back().mesh = 1;
    const Frame frame = frame_of(std::move(data));
    const std::vector<Light> lights{sun_at(0.0f)};
    const float lit = shown(kGrey.x / kPi * 2.0f);
    const Image coarse = picture(frame, traced(frame, lights, {.edge_m = 0.0}), lights);
    const Image fine = picture(frame, traced(frame, lights, {.edge_m = 0.05}), lights);
    std::size_t between_coarse = 0, between_fine = 0;
    for (unsigned x = 0; x < 16; ++x) {
        const auto between = [&](float v) { return v > 0.05f && v < lit - 0.05f; };
        between_coarse += between(coarse.at(x, 5, 0)) ? 1 : 0;
        between_fine += between(fine.at(x, 5, 0)) ? 1 : 0;
    }
    EXPECT_NEAR(fine.at(0, 5, 0), 0.0f, kTolerance);
    EXPECT_NEAR(fine.at(15, 5, 0), lit, kTolerance);
    EXPECT_GE(between_coarse, 8u);
    EXPECT_LE(between_fine, 1u);
}

TEST_F(VertexLightingTest, TakesNothingFromBehindAWall) {
    // A sheet that stands upright on what is seen: one side of it is dark, and the other, lit one
    // has vertices on both sides.
    SceneData data = wall_data();
    SceneData side = raster::scene_data(
        {raster::quad({0.1f, -2.0f, 0.0f}, {0.0f, 4.0f, 0.0f}, {0.0f, 0.0f, 3.0f})});
    data.meshes.push_back(side.meshes[0]);
    data.instances.push_back(data.instances[0]);
    data.instances.back().mesh = 1;
    const Frame frame = frame_of(std::move(data));
    const std::vector<Light> lights{sun_at(45.0f)};  // from +X: dark for x in (-2.9, 0.1)
    const float lit = shown(kGrey.x / kPi * 2.0f * std::sqrt(0.5f));
    // Pixel 9 is at x = 0.19; vertices are half a metre apart.
    const Image with = picture(frame, traced(frame, lights, {.edge_m = 0.8}), lights);
    const Image without =
        picture(frame, traced(frame, lights, {.edge_m = 0.8, .walls = false}), lights);
    for (unsigned y = 0; y < kSize.height; ++y) {
        EXPECT_NEAR(with.at(9, y, 0), lit, kTolerance) << y;
        EXPECT_LT(without.at(9, y, 0), lit - 0.02f) << y;
    }
}

TEST_F(VertexLightingTest, LeavesOutVerticesBeyondALightsReach) {
    const Frame frame = frame_of(wall_data());
    const PointLight lamp{.position_ws = {-0.9f, 0, 0.1f}, .intensity = Vec3(1.0f)};
    const std::vector<Light> lights{lamp};
    // 1 / 1 m²
    const VertexLighting lighting =
        traced(frame, lights, {.edge_m = 0.02, .least_irradiance = 1.0f});
    const Image image = picture(frame, lighting, lights);
    EXPECT_GT(image.at(2, 8, 0), 0.1f);
    EXPECT_EQ(image.at(15, 8, 0), 0.0f) << "1.8 m away";
    const Image all = picture(frame, traced(frame, lights, {.edge_m = 0.02}), lights);
    EXPECT_GT(all.at(15, 8, 0), 0.02f);
}

TEST_F(VertexLightingTest, RefusesBadInput) {
    const Frame frame = frame_of(wall_data());
    const std::vector<Light> lights{sun_at(0.0f)};
    const VertexLighting lighting = traced(frame, lights);
    EXPECT_NE(message_of(frame_of(wall_data()), lighting, lights), "") << "another scene";
    EXPECT_NE(message_of(frame, lighting, lights, {.compose = Compose::subtractive}), "");
    EXPECT_NE(message_of(frame, lighting, lights, {.exposure = -1.0f}), "");
    Progress silent;
    for (const VertexLightingOptions& bad : {VertexLightingOptions{.edge_m = -1.0},
                                             {.most_vertices = 0},
                                             {.samples = 0},
                                             {.least_irradiance = NAN}})
        EXPECT_THROW(VertexLighting(frame.scene, lights, bad, silent), Error);
    EXPECT_THROW(trace_vertex_lights(frame.scene, {}, lights, 65537, silent), Error);
}

TEST_F(VertexLightingTest, TellsWhatItHolds) {
    const Frame frame = frame_of(wall_data());
    const VertexLighting lighting = traced(frame, {sun_at(0.0f)}, {.edge_m = 0.0});
    EXPECT_EQ(lighting.vertices(), 6u) << "two triangles";
    EXPECT_GE(lighting.memory_bytes(), 6u * 32u);
    EXPECT_EQ(lighting.edge_m(), 0.0);
}

}  // namespace
}  // namespace gnomon
