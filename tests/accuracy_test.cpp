// How near the techniques come to the ground truth on the built-in scenes, and on larger ones where
// they are, asserted by numbers. On failure the difference is left as a picture in the build
// folder.

#include "harness.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace gnomon::test {
namespace {

constexpr Extent kSize{320, 180};
constexpr int kReferenceSamples = 64;

struct Judged {
    Frame frame;
    Image visibility, truth;
    ComparisonMask mask;
    Comparison error;
};

Judged judge(const Frame& frame, const std::string& technique, const Params& params = {}) {
    const Visibility truth = trace_visibility(context(), frame, {.samples = kReferenceSamples});
    const Visibility visibility = make_technique(context(), technique, params)->render(frame);
    const ComparisonMask mask = comparison_mask(context(), frame);
    return {frame, visibility.image(), truth.image(), mask, compare(visibility, truth, mask)};
}

/// Red where the technique is darker than the truth, blue where it is lighter.
void leave_picture(const Judged& judged, const std::string& name) {
    Image picture(judged.frame.size, 3);
    for (unsigned y = 0; y < picture.height(); ++y) {
        for (unsigned x = 0; x < picture.width(); ++x) {
            const float difference = judged.visibility.at(x, y) - judged.truth.at(x, y);
            const bool counts = judged.mask.facing.at(x, y) > 0.0f;
            const float grey = counts ? 0.2f + 0.6f * judged.truth.at(x, y) : 0.1f;
            picture.at(x, y, 0) = grey - (counts ? difference : 0.0f);
            picture.at(x, y, 1) = grey;
            picture.at(x, y, 2) = grey + (counts ? difference : 0.0f);
        }
    }
    write_png(name + ".png", picture);
    ADD_FAILURE() << "the difference is in " << std::filesystem::absolute(name + ".png").string();
}

Frame builtin_frame(const Scene& scene, const Light& light, bool ignore_alpha) {
    return {.scene = scene,
            .camera = scene.cameras().at(0),
            .light = light,
            .size = kSize,
            .ignore_alpha = ignore_alpha};
}

/// The same light with hard shadows.
Light hard(Light light) {
    if (auto* sun = std::get_if<DirectionalLight>(&light)) sun->angular_diameter_rad = 0.0f;
    return light;
}

bool on_truth_edge(const Judged& judged, unsigned x, unsigned y) {
    const bool lit = judged.truth.at(x, y) > 0.5f;
    for (unsigned v = y > 0 ? y - 1 : 0; v <= std::min(y + 1, kSize.height - 1); ++v) {
        for (unsigned u = x > 0 ? x - 1 : 0; u <= std::min(x + 1, kSize.width - 1); ++u) {
            if ((judged.truth.at(u, v) > 0.5f) != lit) return true;
        }
    }
    return false;
}

/// False pixels that no edge of the truth touches.
int detached_pixels(const Judged& judged) {
    int count = 0;
    for (unsigned y = 0; y < kSize.height; ++y) {
        for (unsigned x = 0; x < kSize.width; ++x) {
            const bool wrong = std::abs(judged.visibility.at(x, y) - judged.truth.at(x, y)) > 0.5f;
            if (!wrong || judged.mask.facing.at(x, y) == 0.0f) continue;
            if (!on_truth_edge(judged, x, y)) ++count;
        }
    }
    return count;
}

class BuiltinScene : public DeviceTest, public testing::WithParamInterface<std::string> {};

// Volumes are exact; with hard lights and solid masks every pixel away from the truth's edges is
// right.
TEST_P(BuiltinScene, ShadowVolumesAreExact) {
    const Scene scene = make_builtin_scene(GetParam());
    constexpr std::size_t kMaxLights = 4;  // of the torches' sixteen
    for (std::size_t i = 0; i < std::min(scene.lights().size(), kMaxLights); ++i) {
        const Judged judged =
            judge(builtin_frame(scene, hard(scene.lights()[i]), true), "shadow_volumes");
        EXPECT_EQ(judged.error.stray_lit, 0.0) << "light " << i;
        EXPECT_EQ(judged.error.stray_shadow, 0.0) << "light " << i;
        EXPECT_EQ(detached_pixels(judged), 0) << "light " << i;
        // From the other side: edges are where centres of pixels fall, so that few differ at all.
        EXPECT_LT(judged.error.false_lit + judged.error.false_shadow, 1e-3) << "light " << i;
        if (HasFailure()) leave_picture(judged, fmt::format("volumes_{}_{}", GetParam(), i));
    }
}

// Without any tuning: neither acne nor leaks nor lost casters beyond what the texels explain.
TEST_P(BuiltinScene, ShadowMapHasNoArtefactsAtDefaults) {
    const Scene scene = make_builtin_scene(GetParam());
    if (!std::holds_alternative<DirectionalLight>(scene.lights().at(0))) {
        GTEST_SKIP() << GetParam() << " has no sun";
    }
    const Judged judged = judge(builtin_frame(scene, scene.lights()[0], false), "shadow_map");
    EXPECT_LE(judged.error.artefact_shadow, 0.0003);
    EXPECT_LE(judged.error.artefact_lit, 0.001);
    // From the other side: a map of 2048 does differ, at the edges.
    EXPECT_GT(judged.error.rmse, 0.0);
    if (HasFailure()) leave_picture(judged, fmt::format("map_{}", GetParam()));
}

/// A part of bench/bias_sweep: what it prints for all suns and filters, at one azimuth, by default
/// and with the filter that knows how wide the sun is. The other is judged by a sun without width.
void expect_no_artefacts_of_splits(const Scene& scene, const std::string& name) {
    for (const float elevation_deg : {5.0f, 15.0f, 35.0f, 60.0f, 85.0f}) {
        for (const std::string filter : {"box_3x3", "pcss"}) {
            const Light light = sun(radians(elevation_deg), radians(120.0f));
            const Judged judged =
                judge(builtin_frame(scene, filter == "pcss" ? light : hard(light), false), "pssm",
                      {{"filter", filter}});
            EXPECT_LE(judged.error.artefact_shadow, 0.0003) << filter << " at " << elevation_deg;
            EXPECT_LE(judged.error.artefact_lit, 0.001) << filter << " at " << elevation_deg;
            EXPECT_GT(judged.error.rmse, 0.0) << filter << " at " << elevation_deg;
            if (testing::Test::HasFailure())
                leave_picture(judged, fmt::format("pssm_{}_{}", filter, name));
        }
    }
}

TEST_P(BuiltinScene, SplitsHaveNoArtefactsUnderOtherSuns) {
    const Scene scene = make_builtin_scene(GetParam());
    if (!std::holds_alternative<DirectionalLight>(scene.lights().at(0))) {
        GTEST_SKIP() << GetParam() << " has no sun";
    }
    expect_no_artefacts_of_splits(scene, GetParam());
}

// Lamps: a cube, a tetrahedron, perspective cubes, and two paraboloids.
TEST_P(BuiltinScene, MapsOfLampsHaveNoArtefacts) {
    const Scene scene = make_builtin_scene(GetParam());
    if (!std::holds_alternative<PointLight>(scene.lights().at(0))) {
        GTEST_SKIP() << GetParam() << " has no lamp first";
    }
    for (const auto& [technique, params] : std::vector<std::pair<std::string, Params>>{
             {"omni", {}},
             {"omni", {{"projection", "tetrahedral"}}},
             {"psm", {}},
             {"psm", {{"content", "packed_two"}}},
             {"psm", {{"content", "moments"}, {"map_size", 1024}}},
             {"dual_paraboloid", {}}}) {
        const Judged judged =
            judge(builtin_frame(scene, scene.lights()[0], false), technique, params);
        EXPECT_LE(judged.error.artefact_shadow, 0.0003) << technique;
        EXPECT_LE(judged.error.artefact_lit, 0.001) << technique;
        EXPECT_GT(judged.error.rmse, 0.0) << technique;
        if (HasFailure()) leave_picture(judged, fmt::format("{}_{}", technique, GetParam()));
    }
}

// What is blurred may bleed light, so much and no more.
TEST_P(BuiltinScene, BlurredMapsBleedLittleLight) {
    const Scene scene = make_builtin_scene(GetParam());
    if (!std::holds_alternative<DirectionalLight>(scene.lights().at(0))) {
        GTEST_SKIP() << GetParam() << " has no sun";
    }
    for (const auto& [content, most_lit] : {std::pair{"variance", 0.001},
                                            {"exponential_variance", 0.0005},
                                            {"moments", 0.0005},
                                            {"exponential", 0.005}}) {
        const Judged judged = judge(builtin_frame(scene, scene.lights()[0], false), "shadow_map",
                                    {{"content", std::string(content)}});
        EXPECT_LE(judged.error.artefact_shadow, 0.0005) << content;
        EXPECT_LE(judged.error.artefact_lit, most_lit) << content;
        if (HasFailure()) leave_picture(judged, fmt::format("{}_{}", content, GetParam()));
    }
}

TEST_P(BuiltinScene, RayTracedHardShadowsAreTheTruth) {
    const Scene scene = make_builtin_scene(GetParam());
    const Judged judged =
        judge(builtin_frame(scene, hard(scene.lights().at(0)), false), "ray_traced");
    EXPECT_EQ(judged.error.rmse, 0.0);
}

TEST_P(BuiltinScene, LocalIlluminationMissesShadowsOnly) {
    const Scene scene = make_builtin_scene(GetParam());
    const Judged judged =
        judge(builtin_frame(scene, scene.lights().at(0), false), "local_illumination");
    EXPECT_EQ(judged.error.false_shadow, 0.0);
    EXPECT_GT(judged.error.false_lit, 0.005);  // every scene has shadows
}

std::vector<std::string> builtin_names() {
    std::vector<std::string> names;
    for (const BuiltinSceneInfo& info : builtin_scenes())
        names.emplace_back(info.name);
    return names;
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
    std::string name = info.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(All, BuiltinScene, testing::ValuesIn(builtin_names()), test_name);

/// Of the folder of larger scenes.
struct SceneFile {
    std::string label, path;
    UpAxis up = UpAxis::y;
};

std::ostream& operator<<(std::ostream& out, const SceneFile& file) {
    return out << file.path;
}

class LargerScene : public DeviceTest, public testing::WithParamInterface<SceneFile> {};

TEST_P(LargerScene, SplitsHaveNoArtefacts) {
    const char* const folder = std::getenv("GNOMON_SCENES");
    if (folder == nullptr) GTEST_SKIP() << "GNOMON_SCENES is not set";
    const auto file = std::filesystem::path(folder) / GetParam().path;
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
    const Scene scene = load_scene(file.string(), {.up = GetParam().up});
    expect_no_artefacts_of_splits(scene, GetParam().label);
}

INSTANTIATE_TEST_SUITE_P(All, LargerScene,
                         testing::Values(SceneFile{"terrain", "low-poly-terrain/terrain.glb"},
                                         SceneFile{"city_block", "delft-city-block/testarea.obj",
                                                   UpAxis::z},
                                         SceneFile{"game_map", "zdm2-game-map/zdm2.obj"},
                                         SceneFile{"voxel_castle", "lost-empire/lost_empire.obj"},
                                         SceneFile{"pine", "scrub-pine/scrubPine.obj"},
                                         SceneFile{"ship", "dutch-ship/dutch_ship_medium_1k.gltf"},
                                         SceneFile{"monkey", "suzanne/Suzanne.gltf"},
                                         SceneFile{"figure", "cesium-man/CesiumMan.glb"},
                                         SceneFile{"helmet", "flight-helmet/FlightHelmet.gltf"},
                                         SceneFile{"teapot", "teapot/teapot.obj"}),
                         [](const auto& test) { return test.param.label; });

}  // namespace
}  // namespace gnomon::test
