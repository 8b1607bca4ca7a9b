#include <gnomon/metrics.h>
#include <gnomon/technique.h>
#include <gnomon/visibility.h>

#include "raster/small_scene_test.h"
#include "visibility/context_test.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace gnomon {
namespace {

using raster::quad;

class DualParaboloidTest : public ContextTest {
protected:
    static Visibility render(const Frame& frame, const Params& params = {}) {
        return make_technique(context(), "dual_paraboloid", params)->render(frame);
    }
    static Comparison judged(const Frame& frame, const Params& params = {}) {
        return compare(render(frame, params), trace_visibility(context(), frame),
                       comparison_mask(context(), frame));
    }
};

/// A room of one mesh, 6 m wide and 3 m high, seen so that its far wall fills the picture.
Frame far_wall(const Light& light) {
    constexpr float kHalf_m = 3.0f, kHeight_m = 3.0f;
    Mesh room;
    for (unsigned i = 0; i < 8; ++i) {
        room.positions.emplace_back((i & 1) != 0 ? kHalf_m : -kHalf_m,
                                    (i & 2) != 0 ? kHeight_m : 0.0f,
                                    (i & 4) != 0 ? kHalf_m : -kHalf_m);
    }
    room.triangles = {{0, 3, 2}, {0, 1, 3}, {4, 7, 5}, {4, 6, 7}, {0, 5, 1}, {0, 4, 5},
                      {2, 7, 6}, {2, 3, 7}, {0, 6, 4}, {0, 2, 6}, {1, 7, 3}, {1, 5, 7}};
    return {.scene = Scene(raster::scene_data({room})),
            .camera = look_at({0.2f, 1.4f, 2.0f}, {0.0f, 1.5f, -kHalf_m}, radians(25.0f)),
            .light = light,
            .size = {96, 64}};
}

// No acne, near and far, up to 84° from the lamp, and no seam where the layers meet, which is at
// the lamp's height: to the last bit, without a bias to tune.
TEST_F(DualParaboloidTest, AWallShadowsNothingOfItself) {
    for (const char* filter : {"nearest", "bilinear_2x2", "box_3x3"}) {
        for (const int size : {256, 1024}) {
            for (const float away_m : {0.2f, 0.6f, 3.0f}) {
                SCOPED_TRACE(std::string(filter) + ", " + std::to_string(size) + " texels, " +
                             std::to_string(away_m) + " m from the wall");
                const PointLight lamp{.position_ws = {0.3f, 1.5f, -3.0f + away_m}};
                const Visibility visibility =
                    render(far_wall(lamp), {{"filter", std::string(filter)}, {"map_size", size}});
                for (const float value : visibility.image().pixels())
                    ASSERT_EQ(value, 1.0f);
            }
        }
    }
}

/// A plate whose near edge subtends 130° at the lamp, over a ground.
Frame plate(const Light& light) {
    return {.scene =
                Scene(raster::scene_data({quad({-8, 0, 8}, {16, 0, 0}, {0, 0, -16}),
                                          quad({-2.2f, 1.0f, 1.6f}, {4.4f, 0, 0}, {0, 0, -1.2f})})),
            .camera = look_at({0, 7, 6}, {0, 0, 1.5f}),
            .light = light,
            .size = {192, 128}};
}

TEST_F(DualParaboloidTest, SubdividedEdgesAreWhereTheyMustBe) {
    const Frame frame = plate(PointLight{.position_ws = {0, 2, 0}});
    const Comparison bent = judged(frame);
    EXPECT_EQ(bent.artefact_lit, 0.0);
    EXPECT_EQ(bent.artefact_shadow, 0.0);
    EXPECT_GT(bent.rmse, 0.0);
    // A chord of 4 m instead of an arc.
    const Comparison straight = judged(frame, {{"subdivide", false}});
    EXPECT_GT(straight.artefact_lit + straight.artefact_shadow, 0.01);
}

// The widest spot there is fills one layer's half-space.
// Of a rail's triangles one edge is short: inner pieces must be as even as those along it.
TEST_F(DualParaboloidTest, AThinRailsShadowIsStraight) {
    const Frame frame{
        .scene = Scene(raster::scene_data({quad({-6, -2, -3}, {12, 0, 0}, {0, 6, 0}),
                                           quad({-4, 0.5f, -1.5f}, {8, 0, 0}, {0, 0.05f, 0})})),
        .camera = look_at({0, 1, 3}, {0, 1, -3}, radians(60.0f)),
        .light = PointLight{.position_ws = {0, 0, 0}},
        .size = {320, 180}};
    const Comparison error = judged(frame, {{"map_size", 1024}});
    EXPECT_LT(error.false_lit + error.false_shadow, 0.001);  // 0.014 where they were not
}

TEST_F(DualParaboloidTest, ASpotOfAHalfSpaceIsOneLayer) {
    SpotLight spot{.position_ws = {0, 2, 0}, .outer_angle_rad = radians(90.0f)};
    const auto technique = make_technique(context(), "dual_paraboloid");
    const auto bytes = [&](const Light& light) {
        technique->render(plate(light));
        return technique->last_render().memory_bytes;
    };
    const std::uint64_t of_spot = bytes(spot);
    EXPECT_NEAR(static_cast<double>(bytes(PointLight{.position_ws = {0, 2, 0}})) /
                    static_cast<double>(of_spot),
                2.0, 0.01);  // but for the matrices
    for (const Vec3 direction_ws : {Vec3(0, -1, 0), Vec3(0.6f, -0.8f, 0), Vec3(0, 0, 1)}) {
        spot.direction_ws = direction_ws;
        const Comparison error = judged(plate(spot));
        EXPECT_GT(error.pixels, 1000u);
        EXPECT_EQ(error.artefact_lit, 0.0);
        EXPECT_EQ(error.artefact_shadow, 0.0);
    }
}

}  // namespace
}  // namespace gnomon
