// Filters that a map's bounds spare: no pixel may tell.

#include "harness.h"
#include "technique/map_technique.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

namespace gnomon::test {
namespace {

constexpr Extent kSize{160, 90};
constexpr int kMapSize = 500;  // whose last tiles are cut

constexpr const char* kScenes[] = {"courtyard", "gas-station", "field-small"};
constexpr float kElevations_deg[] = {50.0f, 12.0f, 30.0f};  // of their suns
constexpr const char* kSunTechniques[] = {"shadow_map", "lispsm", "tsm", "psm", "pssm"};

Params with(Params params, const std::string& name, const ParamValue& value) {
    params.set(name, value);
    return params;
}

class SkipUniformTest : public DeviceTest {
protected:
    static Frame frame_of(const Scene& scene) {
        return {.scene = scene,
                .camera = scene.cameras().at(0),
                .light = scene.lights().at(0),
                .size = kSize};
    }
    static Frame builtin(const char* name) { return frame_of(make_builtin_scene(name)); }

    static std::vector<std::string> choices(const char* technique, const char* param) {
        return find_param(technique, find_technique(technique).params(), param).choices;
    }

    static void expect_same(const char* technique, const Frame& frame, const Params& params = {}) {
        const Visibility skipped = render(technique, frame, with(params, "skip_uniform", "always"));
        const Visibility filtered = render(technique, frame, with(params, "skip_uniform", "never"));
        EXPECT_TRUE(std::ranges::equal(skipped.image().pixels(), filtered.image().pixels()))
            << technique;
    }

    struct Shares {
        double lit = 0.0, dark = 0.0;
    };
    /// What is proven of the receivers that face the light.
    static Shares proven(const char* technique, const Frame& frame, const Params& params) {
        const std::unique_ptr<Technique> shown =
            make_technique(context(), technique, with(params, "skip_uniform", "always"));
        dynamic_cast<MapTechnique&>(*shown).show_proven();
        const Visibility visibility = shown->render(frame);
        const ComparisonMask mask = comparison_mask(context(), frame);
        Shares shares;
        double receivers = 0.0;
        for (std::size_t i = 0; i < visibility.image().pixels().size(); ++i) {
            if (mask.facing.pixels()[i] <= 0.0f) continue;
            ++receivers;
            shares.lit += visibility.image().pixels()[i] == 1.0f ? 1.0 : 0.0;
            shares.dark += visibility.image().pixels()[i] == 0.0f ? 1.0 : 0.0;
        }
        return {shares.lit / receivers, shares.dark / receivers};
    }
};

TEST_F(SkipUniformTest, ChangesNoPixelOfAnyFilter) {
    for (std::size_t i = 0; i < std::size(kScenes); ++i) {
        Frame frame = builtin(kScenes[i]);
        frame.light = sun(radians(kElevations_deg[i]), radians(200.0f));
        for (const char* technique : kSunTechniques) {
            for (const std::string& filter : choices(technique, "filter")) {
                SCOPED_TRACE(std::string(kScenes[i]) + ", " + filter);
                expect_same(technique, frame, {{"filter", filter}, {"map_size", kMapSize}});
            }
        }
    }
}

TEST_F(SkipUniformTest, ChangesNoPixelOfAnyContent) {
    for (const char* scene : kScenes) {
        const Frame frame = builtin(scene);
        for (const char* content : {"distance", "packed", "packed_two", "variance"}) {
            for (const char* filter : {"nearest", "taps_16"}) {
                SCOPED_TRACE(std::string(scene) + ", " + content + ", " + filter);
                expect_same("pssm", frame,
                            {{"content", content},
                             {"filter", std::string(filter)},
                             {"map_size", kMapSize}});
            }
        }
    }
}

TEST_F(SkipUniformTest, ChangesNoPixelOfLightsWithinTheWorld) {
    const Frame lamp = builtin("torches");
    for (const std::string& filter : choices("omni", "filter")) {
        SCOPED_TRACE(filter);
        expect_same("omni", lamp, {{"filter", filter}, {"map_size", 256}});
        expect_same("omni", lamp, {{"filter", filter}, {"projection", "tetrahedral"}});
    }
    expect_same("omni", lamp, {{"filter", "disc"}, {"content", "distance"}});
    Frame spot = builtin("courtyard");
    spot.light = SpotLight{.position_ws = spot.camera.eye_ws() + Vec3(0, 4, 0),
                           .direction_ws = glm::normalize(Vec3(0.1f, -0.8f, -0.6f))};
    for (const std::string& filter : choices("shadow_map", "filter")) {
        SCOPED_TRACE(filter);
        expect_same("shadow_map", spot, {{"filter", filter}, {"map_size", kMapSize}});
    }
}

// Biases that hide receivers from themselves, filters of any reach and number of taps, tiles that
// are the whole map.
TEST_F(SkipUniformTest, ChangesNoPixelOfAnySetting) {
    const Params bare{{"bias_constant", 0.0},    {"bias_slope", 0.0},   {"normal_offset", 0.0},
                      {"receiver_plane", false}, {"caster_error", 0.0}, {"cull_casters", false},
                      {"filter", "taps_16"}};
    const std::vector<Params> settings{bare,
                                       with(bare, "receiver_plane", true),
                                       with(bare, "bias_slope", 4.0),
                                       {{"filter", "taps_16"}, {"filter_taps", 3}},
                                       {{"filter", "disc"}, {"filter_radius", 30.0}},
                                       {{"filter", "disc"}, {"filter_taps", 64}},
                                       {{"filter", "disc"}, {"map_size", 16}},
                                       {{"filter", "footprint"}, {"filter_most", 256.0}},
                                       {{"filter", "pcss"}, {"filter_most", 256.0}},
                                       {{"filter", "pcss"}, {"filter_most", 1.0}}};
    for (const char* scene : kScenes) {
        const Frame frame = builtin(scene);
        for (std::size_t i = 0; i < settings.size(); ++i) {
            SCOPED_TRACE(std::string(scene) + ", setting " + std::to_string(i));
            expect_same("shadow_map", frame, settings[i]);
            expect_same("pssm", frame, settings[i]);
        }
    }
}

TEST_F(SkipUniformTest, KeepsUpWithMapsThatAreReusedAndRedrawn) {
    const std::unique_ptr<Technique> kept = make_technique(
        context(), "pssm", {{"filter", "disc"}, {"skip_uniform", "always"}, {"reuse_maps", true}});
    Frame frame = builtin("field-small");
    const auto expect_kept = [&](const char* what) {
        const Visibility skipped = kept->render(frame);
        const Visibility filtered =
            render("pssm", frame, {{"filter", "disc"}, {"skip_uniform", "never"}});
        EXPECT_TRUE(std::ranges::equal(skipped.image().pixels(), filtered.image().pixels()))
            << what;
    };
    expect_kept("first");
    expect_kept("second");
    frame.light = sun(radians(20.0f), radians(80.0f));
    expect_kept("another sun");
    frame = builtin("courtyard");
    expect_kept("another scene");
    // Too small a picture to make bounds for, at which the map changes.
    const std::unique_ptr<Technique> automatic = make_technique(
        context(), "pssm", {{"filter", "disc"}, {"map_size", 256}, {"reuse_maps", true}});
    Frame large = builtin("courtyard");
    automatic->render(large);
    const auto has_bounds = [&] {
        return std::ranges::count(automatic->last_render().passes, "bounds", &PassTime::name) == 1;
    };
    EXPECT_TRUE(has_bounds());
    large.light = sun(radians(20.0f), radians(80.0f));
    Frame small = large;
    small.size = {16, 9};
    automatic->render(small);
    EXPECT_FALSE(has_bounds());
    const Visibility skipped = automatic->render(large);
    EXPECT_TRUE(has_bounds());
    const Visibility filtered =
        render("pssm", large, {{"filter", "disc"}, {"map_size", 256}, {"skip_uniform", "never"}});
    EXPECT_TRUE(std::ranges::equal(skipped.image().pixels(), filtered.image().pixels()));
}

// Ground that the sun meets at a slant is proven lit, as least and greatest depths alone could not.
TEST_F(SkipUniformTest, ProvesMostOfASceneOfFewEdges) {
    const Scene scene = make_scene({ground(50.0f), box({-4, 2, -4}, {4, 4, 4})});
    const Frame frame{.scene = scene,
                      .camera = top_view({0, 0, 0}, 20.0f, 20.0f),
                      .light = sun(radians(45.0f), radians(30.0f)),
                      .size = kSize};
    for (const char* filter : {"hardware_2x2", "taps_16", "disc", "footprint"}) {
        const Shares shares =
            proven("shadow_map", frame,
                   {{"filter", std::string(filter)}, {"map_size", 1024}, {"cull_casters", false}});
        // All but the tiles along the edges of the box and of its shadow.
        EXPECT_GT(shares.lit, 0.6) << filter;
        EXPECT_GT(shares.dark, 0.03) << filter;
        expect_same("shadow_map", frame, {{"filter", std::string(filter)}, {"map_size", 1024}});
    }
}

}  // namespace
}  // namespace gnomon::test
