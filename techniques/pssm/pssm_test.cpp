#include <gnomon/error.h>
#include <gnomon/technique.h>

#include "visibility/context_test.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

namespace gnomon {
namespace {

class MapTechniqueTest : public ContextTest {
protected:
    static Frame frame_of(const char* scene_name) {
        const Scene scene = make_builtin_scene(scene_name);
        return {.scene = scene,
                .camera = scene.cameras().at(0),
                .light = scene.lights().at(0),
                .size = {320, 180}};
    }

    /// Share of pixels whose visibility differs by more than a half.
    static double changed(const Visibility& a, const Visibility& b) {
        std::size_t count = 0;
        const std::span<const float> before = a.image().pixels();
        const std::span<const float> after = b.image().pixels();
        for (std::size_t i = 0; i < before.size(); ++i)
            count += std::abs(before[i] - after[i]) > 0.5f ? 1 : 0;
        return static_cast<double>(count) / static_cast<double>(before.size());
    }
};

TEST_F(MapTechniqueTest, CastersThatAreNotDrawnAreNotMissed) {
    for (const char* scene : {"courtyard", "gas-station", "field-small"}) {
        for (const float elevation_deg : {10.0f, 45.0f, 80.0f}) {
            Frame frame = frame_of(scene);
            frame.light = sun(radians(elevation_deg), radians(200.0f));
            for (const char* technique : {"shadow_map", "lispsm", "tsm", "pssm"}) {
                const Visibility culled = make_technique(context(), technique)->render(frame);
                const Visibility all =
                    make_technique(context(), technique, {{"cull_casters", false}})->render(frame);
                // What is left are receivers on the edges of texels, which a ground of no shadow
                // shares.
                EXPECT_LT(changed(culled, all), 2e-4)
                    << technique << ", " << scene << ", " << elevation_deg;
            }
        }
    }
}

TEST_F(MapTechniqueTest, MapsFittedToThePictureErrLessAndMissNoCaster) {
    for (const char* scene : {"courtyard", "field-small", "field-large"}) {
        const Frame frame = frame_of(scene);
        const Visibility truth = trace_visibility(context(), frame, {.samples = 16});
        const ComparisonMask mask = comparison_mask(context(), frame);
        const Visibility parts = make_technique(context(), "shadow_map")->render(frame);
        const Params fitted{{"fit_to", "picture"}};
        const Visibility picture = make_technique(context(), "shadow_map", fitted)->render(frame);
        EXPECT_LT(compare(picture, truth, mask).rmse, compare(parts, truth, mask).rmse) << scene;
        for (const char* technique : {"shadow_map", "pssm"}) {
            const Visibility culled = make_technique(context(), technique, fitted)->render(frame);
            const Visibility all = make_technique(context(), technique,
                                                  {{"fit_to", "picture"}, {"cull_casters", false}})
                                       ->render(frame);
            EXPECT_LT(changed(culled, all), 2e-4) << technique << ", " << scene;
        }
    }
}

TEST_F(MapTechniqueTest, WaysOfDrawingDoNotChangeThePicture) {
    for (const char* scene : {"courtyard", "gas-station", "field-small", "jack-o-lantern"}) {
        Frame frame = frame_of(scene);
        frame.light = sun(radians(35.0f), radians(200.0f));
        for (const char* technique : {"shadow_map", "lispsm", "pssm"}) {
            const Visibility drawn = make_technique(context(), technique)->render(frame);
            for (const auto& [way, value] : {std::pair<const char*, ParamValue>{"faces", "all"},
                                             {"multi_draw", false},
                                             {"layered", true},
                                             {"positions_only", false}}) {
                const Visibility other =
                    make_technique(context(), technique, {{way, value}})->render(frame);
                EXPECT_TRUE(std::ranges::equal(drawn.image().pixels(), other.image().pixels()))
                    << technique << ", " << scene << ", " << way;
            }
        }
    }
}

// Nothing is simplified of meshes that are drawn whole, and a texel's nearest depth is the same in
// whatever order triangles come.
TEST_F(MapTechniqueTest, CastersAsAMeshStoresThemGiveThePictureOfThoseThatAreNotSimplified) {
    const auto expect_same = [](const char* technique, const Frame& frame, Params params) {
        params.set("map_size", 512);
        params.set("caster_error", 0.0);
        const auto drawn_with = [&](bool positions_only, bool optimised_indices, bool cull) {
            params.set("positions_only", positions_only);
            params.set("optimised_indices", optimised_indices);
            params.set("cull_casters", cull);
            return make_technique(context(), technique, params)->render(frame);
        };
        const Visibility drawn = drawn_with(true, true, false);
        EXPECT_LT(std::ranges::min(drawn.image().pixels()), 0.5f);
        const Visibility culled = drawn_with(true, true, true);
        params.set("caster_error", 0.25);
        const Visibility whole_meshes = drawn_with(true, false, false);
        const Visibility as_stored = drawn_with(false, false, false);
        EXPECT_TRUE(std::ranges::equal(drawn.image().pixels(), whole_meshes.image().pixels()));
        EXPECT_TRUE(std::ranges::equal(drawn.image().pixels(), as_stored.image().pixels()));
        // As between casters that are culled and all of them: less is left out of whole meshes.
        EXPECT_LT(changed(culled, drawn_with(false, false, true)), 2e-4);
    };
    for (const char* scene : {"courtyard", "gas-station", "field-small", "jack-o-lantern"}) {
        SCOPED_TRACE(scene);
        Frame frame = frame_of(scene);
        frame.light = sun(radians(35.0f), radians(200.0f));
        for (const char* technique : {"shadow_map", "lispsm", "tsm", "psm", "pssm"}) {
            SCOPED_TRACE(technique);
            expect_same(technique, frame, {});
        }
        expect_same("pssm", frame, {{"content", "moments"}});
        expect_same("pssm", frame, {{"faces", "unlit"}, {"layered", true}});
        frame.light = PointLight{.position_ws = frame.scene.bounds().center() + Vec3(0, 2, 0)};
        expect_same("omni", frame, {});
    }
}

TEST_F(MapTechniqueTest, OnlyThoseWhoWantWholeVerticesKeepThem) {
    const Frame frame = frame_of("courtyard");
    const auto memory_of = [&](bool positions_only, int frames) {
        const auto technique =
            make_technique(context(), "pssm", {{"positions_only", positions_only}});
        for (int i = 0; i < frames; ++i)
            technique->render(frame);
        return technique->last_render().memory_bytes;
    };
    std::uint64_t vertices = 0;
    for (const Mesh& mesh : frame.scene.meshes())
        vertices += mesh.positions.size();
    // Position, normal, texture coordinates, colour.
    constexpr std::uint64_t kVertex_bytes = 12 + 12 + 8 + 4;
    EXPECT_GE(memory_of(false, 1), memory_of(true, 1) + kVertex_bytes * vertices);
    EXPECT_EQ(memory_of(false, 3), memory_of(false, 1));
}

TEST_F(MapTechniqueTest, SimplifiedCastersChangeHardlyAPixel) {
    const Frame frame = frame_of("field-small");
    for (const char* technique : {"shadow_map", "lispsm", "pssm"}) {
        const Visibility simplified = make_technique(context(), technique)->render(frame);
        const Visibility all =
            make_technique(context(), technique, {{"caster_error", 0.0}})->render(frame);
        // A quarter of a texel moves edges by as much: of the pixels on edges a few.
        EXPECT_LT(changed(simplified, all), 2e-3) << technique;
    }
}

// Bytes hold enough of a distance, near a lamp too, and to tell how wide a penumbra is.
TEST_F(MapTechniqueTest, DistancesGiveThePicturesOfDepths) {
    for (const auto& [technique, scene] :
         {std::pair{"pssm", "field-small"}, {"shadow_map", "courtyard"}, {"omni", "torches"}}) {
        Frame frame = frame_of(scene);
        if (const auto* torch = std::get_if<PointLight>(&frame.light))
            frame.light = SphereLight{.center_ws = torch->position_ws};
        for (const std::string filter : {"box_3x3", "pcss"}) {
            Params params{{"filter", filter}};
            const Visibility depths = make_technique(context(), technique, params)->render(frame);
            for (const char* content : {"distance", "packed", "packed_two"}) {
                params.set("content", content);
                const Visibility distances =
                    make_technique(context(), technique, params)->render(frame);
                EXPECT_LT(changed(depths, distances), 2e-4)
                    << technique << ", " << filter << ", " << content;
            }
        }
    }
}

TEST_F(MapTechniqueTest, PsmSeesACasterBehindTheCameraBeyondInfinityOrSlidBack) {
    const Frame frame{.scene = make_builtin_scene("field-small"),
                      .camera = look_at({-9, 1.8f, 50}, {-8, 0.8f, 38}),
                      .light = sun(radians(20.0f), radians(180.0f)),
                      .size = {160, 90}};
    const Visibility truth = trace_visibility(context(), frame, {.samples = 16});
    const ComparisonMask mask = comparison_mask(context(), frame);
    const auto false_lit = [&](const char* camera, bool beyond) {
        const Params params{{"virtual_camera", camera}, {"beyond_infinity", beyond}};
        const auto technique = make_technique(context(), "psm", params);
        return compare(technique->render(frame), truth, mask).false_lit;
    };
    EXPECT_GT(false_lit("none", false), 0.2);
    EXPECT_LT(false_lit("none", true), 0.01);
    EXPECT_LT(false_lit("slide_back", false), 0.02);
}

// Without any bias, in any projection; and what other objects cast stays.
TEST_F(MapTechniqueTest, ObjectIdsEndSelfShadowing) {
    Frame frame = frame_of("cube");
    const auto light = std::get<DirectionalLight>(frame.light);
    const Params bare{{"bias_constant", 0.0},
                      {"bias_slope", 0.0},
                      {"normal_offset", 0.0},
                      {"receiver_plane", false},
                      {"caster_error", 0.0}};
    for (const char* technique : {"shadow_map", "pssm", "lispsm", "tsm", "psm", "omni"}) {
        const bool lamp = std::string_view(technique) == "omni";
        if (lamp) frame.light = PointLight{.position_ws = 6.0f * light.to_light_ws};
        const Visibility truth = trace_visibility(context(), frame);
        const ComparisonMask mask = comparison_mask(context(), frame);
        const auto error = [&](const char* content) {
            Params params = bare;
            params.set("content", content);
            return compare(make_technique(context(), technique, params)->render(frame), truth,
                           mask);
        };
        EXPECT_GT(error("depth").artefact_shadow, 0.05) << technique;
        const Comparison with_ids = error("object_id");
        EXPECT_EQ(with_ids.artefact_shadow, 0.0) << technique;
        EXPECT_EQ(with_ids.artefact_lit, 0.0) << technique;
        EXPECT_LT(with_ids.false_lit + with_ids.false_shadow, 0.002) << technique;
    }
}

TEST_F(MapTechniqueTest, PcssMakesThePenumbraOfALampsSize) {
    const Scene scene = make_builtin_scene("jack-o-lantern");
    for (const float radius_m : {0.05f, 0.1f}) {
        const Frame frame{
            .scene = scene,
            .camera = scene.cameras().at(0),
            .light = SphereLight{.center_ws = {0.6f, 1.2f, 0.5f}, .radius_m = radius_m},
            .size = {320, 180}};
        const Visibility truth = trace_visibility(context(), frame, {.samples = 64});
        const ComparisonMask mask = comparison_mask(context(), frame);
        for (const char* technique : {"omni", "psm"}) {
            const auto rmse = [&](const char* filter) {
                const auto made =
                    make_technique(context(), technique, {{"filter", filter}, {"map_size", 2048}});
                return compare(made->render(frame), truth, mask).rmse;
            };
            EXPECT_LT(rmse("pcss"), 0.6 * rmse("box_3x3")) << technique << ", " << radius_m;
        }
    }
}

TEST_F(MapTechniqueTest, ReusedMapsAreThoseThatWouldBeDrawn) {
    const std::unique_ptr<Technique> reusing =
        make_technique(context(), "pssm", {{"reuse_maps", true}});
    const std::unique_ptr<Technique> drawing = make_technique(context(), "pssm");
    Frame frame = frame_of("field-small");
    const auto expect_same = [&](const char* what) {
        const Visibility reused = reusing->render(frame);
        EXPECT_EQ(changed(reused, drawing->render(frame)), 0.0) << what;
    };
    expect_same("first");
    expect_same("second");
    frame.light = sun(radians(20.0f), radians(80.0f));
    expect_same("another sun");
    frame.camera = look_at({30, 4, 30}, {0, 1, 0});
    expect_same("another view");
    frame.scene = make_builtin_scene("cube");
    expect_same("another scene");
    frame = frame_of("courtyard");
    expect_same("masks");
    frame.ignore_alpha = true;
    expect_same("masks taken for solid");
}

TEST_F(MapTechniqueTest, BlendedSplitsHideTheirSeams) {
    const Frame frame = frame_of("field-large");
    const Visibility truth = trace_visibility(context(), frame, {.samples = 16});
    const ComparisonMask mask = comparison_mask(context(), frame);
    const Visibility cut = make_technique(context(), "pssm")->render(frame);
    const Visibility blended =
        make_technique(context(), "pssm", {{"split_blend", 0.2}})->render(frame);
    EXPECT_FALSE(std::ranges::equal(cut.image().pixels(), blended.image().pixels()));
    // A part of the nearer pixels has the farther split's texels.
    EXPECT_LT(compare(blended, truth, mask).rmse, 1.15 * compare(cut, truth, mask).rmse);
    EXPECT_LT(compare(blended, truth, mask).artefact_lit, 5e-4);
    EXPECT_LT(compare(blended, truth, mask).artefact_shadow, 5e-4);
}

// What the first scheme had: a margin behind the camera, which costs texels and brings no caster
// that is not drawn without it, and a bias for each split.
TEST_F(MapTechniqueTest, AShiftBehindTheCameraCostsTexelsAndMissesNothing) {
    const Frame frame = frame_of("field-small");
    for (const char* fit : {"tight", "stable"}) {
        const Params shifted{{"fit", std::string(fit)}, {"camera_shift", 20.0}};
        const auto least_texel_m = [&](const Visibility& visibility) {
            float least_m = std::numeric_limits<float>::infinity();
            for (const float texel_m : visibility.texel_size_m().pixels()) {
                if (texel_m > 0.0f) least_m = std::min(least_m, texel_m);
            }
            return least_m;
        };
        const Visibility moved = make_technique(context(), "pssm", shifted)->render(frame);
        const Visibility still =
            make_technique(context(), "pssm", {{"fit", std::string(fit)}})->render(frame);
        EXPECT_GT(least_texel_m(moved), 1.1f * least_texel_m(still)) << fit;
        const Visibility truth = trace_visibility(context(), frame, {.samples = 16});
        const Comparison error = compare(moved, truth, comparison_mask(context(), frame));
        EXPECT_LE(error.artefact_lit, 0.001) << fit;
        EXPECT_LE(error.artefact_shadow, 0.0003) << fit;
    }
}

TEST_F(MapTechniqueTest, EachSplitMayHaveABiasOfItsOwn) {
    const Frame frame = frame_of("field-small");
    const auto with = [&](int splits, double split_bias) {
        return make_technique(
                   context(), "pssm",
                   {{"splits", splits}, {"bias_constant", 4.0}, {"split_bias", split_bias}})
            ->render(frame);
    };
    EXPECT_EQ(changed(with(1, 1.0), with(1, 8.0)), 0.0);
    const Visibility alike = with(2, 1.0);
    const Visibility growing = with(2, 8.0);
    const float first_m = *std::ranges::min_element(alike.texel_size_m().pixels(), {},
                                                    [](float m) { return m > 0.0f ? m : 1e9f; });
    double near = 0.0;
    double far = 0.0;
    for (std::size_t i = 0; i < alike.image().pixels().size(); ++i) {
        const bool first = alike.texel_size_m().pixels()[i] == first_m;
        (first ? near : far) +=
            static_cast<double>(std::abs(growing.image().pixels()[i] - alike.image().pixels()[i]));
    }
    EXPECT_EQ(near, 0.0);
    EXPECT_GT(far, 10.0);  // of 57,600 pixels
}

TEST_F(MapTechniqueTest, MoreSplitsErrLess) {
    const Frame frame = frame_of("field-small");
    const Visibility truth = trace_visibility(context(), frame, {.samples = 16});
    const ComparisonMask mask = comparison_mask(context(), frame);
    double before = 1.0;
    for (const int splits : {1, 2, 4}) {
        const Visibility visibility =
            make_technique(context(), "pssm", {{"splits", splits}, {"map_size", 512}})
                ->render(frame);
        const double rmse = compare(visibility, truth, mask).rmse;
        EXPECT_LT(rmse, 0.95 * before) << splits;
        before = rmse;
    }
}

}  // namespace
}  // namespace gnomon
