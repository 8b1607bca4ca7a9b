// Bugs made on purpose: each must show in the measure that is there to find it, and be gone without
// it. A test that fails here means that the measure has gone blind.

#include "harness.h"

#include <glm/ext/matrix_transform.hpp>

#include <cmath>

namespace gnomon {

namespace {

using test::context;

constexpr Extent kSize{256, 192};

/// What rounding and edges alone make, as a share of the pixels.
constexpr double kClean = 0.0005;
/// What nobody overlooks in a picture.
constexpr double kPlain = 0.005;

/// A ground with a slanted board, a ball and a post.
Scene receivers_of_all_slopes() {
    SceneData data =
        test::scene_data({test::ground(3.0f), test::ball({-0.7f, 0.9f, 0.3f}, 0.6f, 24),
                          test::quad({0.3f, 0.2f, 0.9f}, {1.2f, 0, 0}, {0, 0.9f, -1.0f}),
                          test::box({1.7f, -0.01f, -1}, {1.8f, 1.2f, -0.9f})});
    return Scene(std::move(data));
}

Frame frame_of(const Light& light) {
    return {.scene = receivers_of_all_slopes(),
            .camera = look_at({0.8f, 3.0f, 4.6f}, {0.1f, 0.4f, 0.0f}),
            .light = light,
            .size = kSize};
}

Frame sunny() {
    return frame_of(sun(radians(35.0f), radians(290.0f), 0.0f));
}

Frame spotlit() {
    const Vec3 position(-3.5f, 3.2f, 1.0f);
    return frame_of(SpotLight{.position_ws = position,
                              .direction_ws = -normalize(position),
                              .outer_angle_rad = radians(35.0f)});
}

class DeliberateBugs : public test::DeviceTest {
protected:
    /// So coarse that a texel is a few pixels: what is wrong by texels is then seen.
    static Params coarse_map() { return {{"map_size", 256}}; }
};

TEST_F(DeliberateBugs, NoBiasGivesAcne) {
    for (const Frame& frame : {sunny(), spotlit()}) {
        for (const char* filter : {"nearest", "hardware_2x2", "box_4x4"}) {
            SCOPED_TRACE(light_name(frame.light) + ", " + filter);
            Params params = coarse_map();
            params.set("filter", std::string(filter));
            EXPECT_LT(test::compare_with_truth("shadow_map", frame, params).artefact_shadow,
                      kClean);
            params.set("receiver_plane", false);
            params.set("caster_error", 0.0);
            params.set("bias_constant", 0.0);
            params.set("bias_slope", 0.0);
            params.set("normal_offset", 0.0);
            const Comparison error = test::compare_with_truth("shadow_map", frame, params);
            EXPECT_GT(error.artefact_shadow, kPlain);
            EXPECT_GT(error.stray_shadow, kPlain);
        }
    }
}

// Beside hollows, and on walls that a high sun hardly meets, faults are looked for with rays that
// stay on the receiver's plane: what hides them there must not excuse all of a wall.
TEST_F(DeliberateBugs, AcneShowsInHollowsAndOnGrazedWalls) {
    constexpr float kSide_m = 3.0f;
    const auto slope = [](float rise) {  // up from the axis to the right
        return test::quad({0, 0, kSide_m}, {kSide_m, rise * kSide_m, 0}, {0, 0, -2 * kSide_m});
    };
    const auto left = test::quad({-kSide_m, 0, kSide_m}, {kSide_m, 0, 0}, {0, 0, -2 * kSide_m});
    const auto bare = [] {
        Params params = coarse_map();
        params.set("receiver_plane", false);
        for (const char* name : {"caster_error", "bias_constant", "bias_slope", "normal_offset"})
            params.set(name, 0.0);
        return params;
    };
    for (const float rise : {0.4f, 1.0f, 20.0f}) {  // 22°, 45°, 87°
        SCOPED_TRACE(rise);
        Frame frame = sunny();
        frame.scene = Scene(test::scene_data({left, slope(rise)}));
        frame.camera = look_at({-2.5f, 4.0f, 2.0f}, {0.3f, 0.2f, 0.0f});
        frame.light = sun(radians(85.0f), radians(270.0f), 0.0f);  // from the left
        EXPECT_GT(test::compare_with_truth("shadow_map", frame, bare()).artefact_shadow, kPlain);
        EXPECT_EQ(test::compare_with_truth("shadow_map", frame, coarse_map()).artefact_shadow, 0.0);
    }
}

TEST_F(DeliberateBugs, SecondDepthsNeedNoBias) {
    Frame frame = sunny();
    frame.scene = Scene(test::scene_data({test::box({-1, 0, -1}, {1, 0.5f, 1}),  // both close
                                          test::box({-0.3f, 0.9f, -0.3f}, {0.3f, 1.4f, 0.3f})}));
    Params params = coarse_map();
    for (const char* name : {"caster_error", "bias_constant", "bias_slope", "normal_offset"})
        params.set(name, 0.0);
    params.set("receiver_plane", false);
    params.set("faces", std::string("lit"));
    EXPECT_GT(test::compare_with_truth("shadow_map", frame, params).artefact_shadow, kPlain);
    params.set("faces", std::string("unlit"));
    EXPECT_LT(test::compare_with_truth("shadow_map", frame, params).artefact_shadow, kClean);
}

TEST_F(DeliberateBugs, TooMuchBiasDetachesShadows) {
    for (const Frame& frame : {sunny(), spotlit()}) {
        SCOPED_TRACE(light_name(frame.light));
        EXPECT_LT(test::compare_with_truth("shadow_map", frame, coarse_map()).artefact_lit, kClean);
        for (const auto& [name, value] :
             {std::pair{"bias_constant", 100.0}, {"bias_slope", 16.0}, {"normal_offset", 16.0}}) {
            SCOPED_TRACE(name);
            Params params = coarse_map();
            params.set("receiver_plane", false);
            params.set(name, value);
            EXPECT_GT(test::compare_with_truth("shadow_map", frame, params).artefact_lit, kPlain);
        }
    }
}

TEST_F(DeliberateBugs, LostCastersAreLeaks) {
    const Comparison error = test::compare_with_truth("local_illumination", sunny());
    EXPECT_GT(error.artefact_lit, kPlain);
    EXPECT_EQ(error.false_shadow, 0.0);
}

// The other way about: texels as large as a foot are no bug, and are not counted as one.
TEST_F(DeliberateBugs, LackOfResolutionIsNoBug) {
    const Frame frame = sunny();
    const Comparison error =
        test::compare_with_truth("shadow_map", frame, {{"map_size", 24}, {"filter", "box_4x4"}});
    EXPECT_GT(error.stray_lit + error.stray_shadow, kPlain);
    EXPECT_LT(error.artefact_lit, kClean);
    EXPECT_LT(error.artefact_shadow, kClean);
}

TEST_F(DeliberateBugs, MasksTakenForSolidAreFalseShadows) {
    SceneData data =
        test::scene_data({test::ground(3.0f), test::quad({-1, 1, 1}, {2, 0, 0}, {0, 0, -2})});
    Material hole;
    hole.base_color.a = 0.25f;
    hole.alpha_cutoff = 0.5f;
    data.materials.push_back(hole);
    data.meshes[1].material = 1;
    Frame frame = sunny();
    frame.scene = Scene(std::move(data));
    EXPECT_EQ(test::compare_with_truth("shadow_map", frame).false_shadow, 0.0);
    EXPECT_GT(test::compare_with_truth("shadow_volumes", frame).artefact_shadow, kPlain);
}

// Rasterisers move corners by parts of a pixel; unmended, pixels that thereby hang over the edge of
// a surface take the state of what is behind it. That is rare: it takes many views to see some.
TEST_F(DeliberateBugs, UnmendedEdgesAreTorn) {
    constexpr int kViews = 32;
    const auto mending = make_technique(context(), "shadow_volumes");
    const auto tearing = make_technique(context(), "shadow_volumes", {{"mend_edges", false}});
    double mended_stray = 0.0, torn_stray = 0.0;
    for (int view = 0; view < kViews; ++view) {
        Frame frame = sunny();
        const float turn = 2.0f * kPi * static_cast<float>(view) / kViews;
        frame.camera = look_at({4.4f * std::cos(turn), 2.2f, 4.4f * std::sin(turn)}, {0, 0.4f, 0});
        const Visibility truth = trace_visibility(context(), frame);
        const ComparisonMask mask = comparison_mask(context(), frame);
        const Comparison mended = compare(mending->render(frame), truth, mask);
        const Comparison torn = compare(tearing->render(frame), truth, mask);
        mended_stray += mended.stray_lit + mended.stray_shadow;
        torn_stray += torn.stray_lit + torn.stray_shadow;
    }
    EXPECT_EQ(mended_stray, 0.0);
    EXPECT_GT(torn_stray, 0.0);
}

/// How much visibility changes from frame to frame on a path of moves and turns of parts of a
/// texel: the mean over pixels that are judged in both frames. Of the technique, and of the truth.
std::pair<double, double> flicker(const Params& params) {
    constexpr int kFrames = 48;
    const auto technique = make_technique(context(), "pssm", params);
    const Scene scene = make_builtin_scene("field-small");
    Frame frame{.scene = scene,
                .camera = scene.cameras().at(0),
                .light = sun(radians(35.0f), radians(300.0f), 0.0f),
                .size = {256, 144}};
    const Mat4 view_from_world = frame.camera.view_from_world;
    double changed = 0.0, truth_changed = 0.0;
    std::size_t judged = 0;
    Image before, truth_before, facing_before;
    for (int i = 0; i < kFrames; ++i) {
        const auto step = static_cast<float>(i);
        frame.camera.view_from_world =
            glm::rotate(glm::translate(view_from_world, Vec3(0.004f, 0.001f, 0.002f) * step),
                        radians(0.02f) * std::sin(step), Vec3(0, 1, 0));
        const Visibility visibility = technique->render(frame);
        const Visibility truth = trace_visibility(context(), frame);
        const Image facing = comparison_mask(context(), frame).facing;
        for (std::size_t p = 0; i > 0 && p < facing.pixels().size(); ++p) {
            if (facing.pixels()[p] == 0.0f || facing_before.pixels()[p] == 0.0f) continue;
            ++judged;
            changed += std::abs(visibility.image().pixels()[p] - before.pixels()[p]);
            truth_changed += std::abs(truth.image().pixels()[p] - truth_before.pixels()[p]);
        }
        before = visibility.image();
        truth_before = truth.image();
        facing_before = facing;
    }
    const auto count = static_cast<double>(judged);
    return {changed / count, truth_changed / count};
}

// Texels that stay where they are in the world leave the flicker that pixels have by themselves.
TEST_F(DeliberateBugs, TexelsThatMoveFlicker) {
    for (const int map_size : {1024, 2048}) {
        SCOPED_TRACE(map_size);
        const auto [snapped, truth] = flicker({{"fit", "stable"}, {"map_size", map_size}});
        const auto [unsnapped, same] = flicker({{"fit", "tight"}, {"map_size", map_size}});
        EXPECT_EQ(truth, same);
        EXPECT_LT(snapped, 1.1 * truth);
        // The finer the texels, the more of it is the pixels' own.
        EXPECT_GT(unsnapped - snapped, (map_size == 1024 ? 0.2 : 0.05) * truth);
    }
}

// Multiplying the whole picture by visibility takes the ambient light away with the sun's.
TEST_F(DeliberateBugs, SubtractiveShadowsAreTooDark) {
    const Frame frame = sunny();
    const Visibility truth = trace_visibility(context(), frame);
    const LitBy lit[] = {{frame.light, &truth}};
    const Image right = light_picture(context(), frame, lit);
    const Image wrong = light_picture(context(), frame, lit, {.compose = Compose::subtractive});
    const ComparisonMask mask = comparison_mask(context(), frame);
    std::size_t umbra_pixels = 0;
    for (unsigned y = 0; y < kSize.height; ++y) {
        for (unsigned x = 0; x < kSize.width; ++x) {
            const bool umbra = mask.facing.at(x, y) > 0.0f && truth.image().at(x, y) == 0.0f;
            if (!umbra) continue;
            ++umbra_pixels;
            ASSERT_EQ(wrong.at(x, y), 0.0f);
            ASSERT_GT(right.at(x, y), 0.1f);
        }
    }
    EXPECT_GT(umbra_pixels, 1000u);
    EXPECT_GT(flip(right, wrong), kPlain);
}

}  // namespace

}  // namespace gnomon
