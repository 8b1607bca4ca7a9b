#include <gnomon/error.h>
#include <gnomon/technique.h>

#include "raster/small_scene_test.h"
#include "visibility/context_test.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gnomon {
namespace {

constexpr const char* kFilters[] = {"nearest", "hardware_2x2", "box_3x3", "box_4x4", "dithered_4"};

class ShadowMapTest : public ContextTest {
protected:
    /// The least and the greatest value.
    static std::pair<float, float> range(const Visibility& visibility) {
        const std::span<const float> values = visibility.image().pixels();
        const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
        return {*least, *greatest};
    }
    static Visibility render(const Frame& frame, const Params& params) {
        return make_technique(context(), "shadow_map", params)->render(frame);
    }
};

/// A plane, 20 m wide, that nothing shadows but itself; turned so that no axis of the map is one of
/// its own.
Frame plane_frame(const Light& light) {
    SceneData data = raster::scene_data({raster::wall(Vec3(0), 20)});
    return {.scene = Scene(std::move(data)),
            .camera = look_at({3, 4, 9}, {0.3f, 0.2f, 0}),
            .light = light,
            .size = {96, 54}};
}

/// The light's angle from the plane's normal.
DirectionalLight sun_at(float angle_deg) {
    const float height = std::cos(radians(angle_deg));
    const float side = std::sin(radians(angle_deg));
    return {.to_light_ws = {0.8f * side, 0.6f * side, height}};
}

/// Calls check(frame, params) for each filter, two sizes of map, and the sun at each angle.
template <typename Check>
void for_each_plane(std::initializer_list<float> angles_deg, const Check& check) {
    for (const char* filter : kFilters) {
        for (const int size : {32, 512}) {
            for (const float angle_deg : angles_deg) {
                SCOPED_TRACE(std::string(filter) + ", " + std::to_string(size) + " texels, " +
                             std::to_string(angle_deg) + " degrees");
                check(plane_frame(sun_at(angle_deg)),
                      Params{{"filter", std::string(filter)},
                             {"map_size", size},
                             {"cull_casters", false}});  // the plane can only shadow itself
            }
        }
    }
}

Params with_bias(Params params, double slope, double normal_offset) {
    params.set("bias_slope", slope);
    params.set("normal_offset", normal_offset);
    params.set("receiver_plane", false);
    return params;
}

// The page of the technique says why: of 1, the one or the other is what a plane's depth changes by
// over the texels that decide; of kWholeReach, over all that the filter reads.
constexpr double kWholeReach = 4.0 / 3.0;
const std::pair<float, float> kAllLit(1.0f, 1.0f);

TEST_F(ShadowMapTest, HasNoAcneOnAPlaneByTheNormalOffset) {
    for_each_plane({0, 30, 60, 80, 88}, [](const Frame& frame, const Params& params) {
        EXPECT_EQ(range(render(frame, with_bias(params, 0, kWholeReach))), kAllLit);
    });
}

TEST_F(ShadowMapTest, HasNoAcneOnAPlaneByTheSlopeBias) {
    // Up to 84 degrees.
    for_each_plane({0, 30, 60, 80}, [](const Frame& frame, const Params& params) {
        EXPECT_EQ(range(render(frame, with_bias(params, kWholeReach, 0))), kAllLit);
    });
}

TEST_F(ShadowMapTest, HasNoAcneOnAPlaneByComparingWithIt) {
    for_each_plane({0, 30, 60, 80, 88}, [](const Frame& frame, const Params& params) {
        Params plane = with_bias(params, 0, 0);
        plane.set("receiver_plane", true);
        plane.set("bias_constant", 0.05);  // for rounding
        plane.set("caster_error", 0.0);
        EXPECT_EQ(range(render(frame, plane)), kAllLit);
    });
}

TEST_F(ShadowMapTest, HasHardlyAnyAcneOnAPlaneByDefault) {
    for_each_plane({0, 30, 60, 80}, [](const Frame& frame, const Params& params) {
        const auto [least, greatest] = range(render(frame, params));
        // The outermost texels of the filter weigh little; of `nearest` there is but one.
        const bool nearest = params.values().at("filter") == ParamValue(std::string("nearest"));
        EXPECT_GE(least, nearest ? 1.0f : 0.95f);
        EXPECT_EQ(greatest, 1.0f);
    });
}

TEST_F(ShadowMapTest, DrawsNoPlaneThatCanOnlyShadowItself) {
    Params none = with_bias({{"map_size", 32}}, 0, 0);
    none.set("bias_constant", 0);
    none.set("caster_error", 0);
    EXPECT_EQ(range(render(plane_frame(sun_at(60)), none)), kAllLit);
}

TEST_F(ShadowMapTest, HasAcneWithoutBias) {
    for_each_plane({30, 60, 80, 88}, [](const Frame& frame, const Params& params) {
        Params none = with_bias(params, 0, 0);
        none.set("bias_constant", 0);
        none.set("caster_error", 0);
        EXPECT_LT(range(render(frame, none)).first, 0.8f);
    });
}

TEST_F(ShadowMapTest, HasNoAcneOnAPlaneUnderASpot) {
    for (const char* filter : kFilters) {
        for (const float x : {0.0f, 4.0f, 12.0f}) {
            const Vec3 position(x, 1.0f, 3.0f);
            const SpotLight spot{.position_ws = position,
                                 .direction_ws = normalize(-position),
                                 .outer_angle_rad = radians(40.0f)};
            const Params params{{"filter", std::string(filter)}, {"map_size", 256}};
            EXPECT_EQ(range(render(plane_frame(spot), with_bias(params, 0, kWholeReach))), kAllLit)
                << filter << ", " << x;
        }
    }
}

TEST_F(ShadowMapTest, HasNoStepsWithinAFilteredEdge) {
    // The corner of a board over a plane, seen from between the two by a parallel camera.
    SceneData data =
        raster::scene_data({raster::wall(Vec3(0), 20), raster::wall({5.02f, 5.03f, 1}, 10)});
    Frame frame{.scene = Scene(std::move(data)),
                .camera = look_at({0, 0, 0.5f}, {0, 0, 0}),
                .light = sun_at(0.0f),
                .size = {64, 64}};
    frame.camera.ortho_height_m = 1.0f;
    frame.camera.ortho_depth_m = 1.0f;
    // What a filter's weights change by over one texel.
    const std::vector<std::pair<std::string, float>> slopes = {
        {"hardware_2x2", 1.0f}, {"box_3x3", 0.5f}, {"box_4x4", 1.0f / 3.0f}};
    for (const auto& [filter, slope] : slopes) {
        const Visibility visibility = render(frame, {{"filter", filter}, {"map_size", 20}});
        EXPECT_EQ(range(visibility), std::pair(0.0f, 1.0f));
        const float texels_per_pixel = 1.0f / 64.0f / visibility.texel_size_m().at(5, 5);
        ASSERT_LT(texels_per_pixel, 0.5f);
        const float most = 1.001f * slope * texels_per_pixel;
        const Image& values = visibility.image();
        for (unsigned y = 0; y + 1 < 64; ++y) {
            for (unsigned x = 0; x + 1 < 64; ++x) {
                EXPECT_LE(std::abs(values.at(x + 1, y) - values.at(x, y)), most) << filter;
                EXPECT_LE(std::abs(values.at(x, y + 1) - values.at(x, y)), most) << filter;
            }
        }
    }
}

TEST_F(ShadowMapTest, TellsTheSizeAndReachOfItsTexels) {
    const Frame frame = plane_frame(sun_at(30.0f));
    float previous_radius = 0.0f;
    for (const char* filter : kFilters) {
        const Visibility coarse =
            render(frame, {{"filter", std::string(filter)}, {"map_size", 256}});
        const Visibility fine =
            render(frame, {{"filter", std::string(filter)}, {"map_size", 1024}});
        const std::span<const float> coarse_m = coarse.texel_size_m().pixels();
        const std::span<const float> fine_m = fine.texel_size_m().pixels();
        ASSERT_EQ(coarse_m.size(), std::size_t{96} * 54);
        for (std::size_t i = 0; i < coarse_m.size(); ++i) {
            if (coarse_m[i] == 0.0f) continue;  // no receiver
            // Four times the texels over the same place, but for a margin of at most 5 on each
            // side.
            EXPECT_GE(coarse_m[i] / fine_m[i], 4.0f);
            EXPECT_LE(coarse_m[i] / fine_m[i], (1024.0f - 10.0f) / (256.0f - 10.0f));
        }
        EXPECT_GT(coarse.filter_radius_texels(), previous_radius) << filter;
        previous_radius = coarse.filter_radius_texels();
    }
}

TEST_F(ShadowMapTest, RefusesTheLightsThatItCannotShadow) {
    EXPECT_THROW(render(plane_frame(PointLight{}), {}), Error);
    EXPECT_THROW(render(plane_frame(SphereLight{}), {}), Error);
    SpotLight wide;
    wide.outer_angle_rad = radians(85.0f);
    EXPECT_THROW(render(plane_frame(wide), {}), Error);
}

TEST_F(ShadowMapTest, RefusesBadParameters) {
    const Frame frame = plane_frame(sun_at(0.0f));
    for (const Params& params :
         std::vector<Params>{{{"map_size", 15}},
                             {{"map_size", 16'385}},
                             {{"map_size", 1024.5}},
                             {{"filter", std::string("gaussian")}},
                             {{"bias_constant", -0.1}},
                             {{"normal_offset", std::numeric_limits<double>::quiet_NaN()}},
                             {{"bias", 1.0}}}) {
        EXPECT_THROW(render(frame, params), Error);
    }
    EXPECT_NO_THROW(render(frame, {{"map-size", 16}}));
}

}  // namespace
}  // namespace gnomon
