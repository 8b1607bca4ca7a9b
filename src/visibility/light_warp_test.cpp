#include "visibility/light_warp.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace gnomon {
namespace {

constexpr unsigned kMapSize = 1024;
constexpr float kMargin = 3.0f;

struct View {
    Box3 bounds;
    Camera camera;
    DirectionalLight light;
    std::vector<DVec3> receivers_ws;
};

/// Along a flat ground, the sun beside it.
View along_ground() {
    View view;
    view.bounds.include(Vec3(-100, 0, -200));
    view.bounds.include(Vec3(100, 8, 10));
    view.camera = look_at({0, 3, 5}, {0, 2, -50}, radians(50.0f));
    view.light.to_light_ws = normalize({0.8f, 1.0f, 0.1f});
    view.receivers_ws = visible_corners(view.camera, {160, 90}, view.bounds);
    return view;
}

TEST(FitWarped, HoldsItsReceivers) {
    const View view = along_ground();
    for (const Warp warp : {Warp::none, Warp::lispsm, Warp::trapezoidal}) {
        const LightFit fit = fit_warped(warp, kDefaultFocus, view.light, view.camera,
                                        view.receivers_ws, view.bounds, kMapSize, kMargin);
        EXPECT_EQ(fit.affine, warp == Warp::none);
        const double inner = 1.0 - 2.0 * static_cast<double>(kMargin) / kMapSize;
        for (const DVec3& p : view.receivers_ws) {
            const glm::dvec4 p_cs = fit.clip_from_world * glm::dvec4(p, 1.0);
            ASSERT_GT(p_cs.w, 0.0);
            EXPECT_LE(std::abs(p_cs.x / p_cs.w), inner + 1e-4);
            EXPECT_LE(std::abs(p_cs.y / p_cs.w), inner + 1e-4);
            EXPECT_GE(p_cs.z / p_cs.w, -1e-6);
            EXPECT_LE(p_cs.z / p_cs.w, 1.0 + 1e-6);
        }
    }
}

TEST(FitWarped, KeepsLightStraight) {
    const View view = along_ground();
    const LightFit fit = fit_warped(Warp::lispsm, kDefaultFocus, view.light, view.camera,
                                    view.receivers_ws, view.bounds, kMapSize, kMargin);
    const glm::dmat4 clip(fit.clip_from_world);
    for (const DVec3& p : view.receivers_ws) {
        const glm::dvec4 low = clip * glm::dvec4(p, 1.0);
        const glm::dvec4 high = clip * glm::dvec4(p + 5.0 * DVec3(view.light.to_light_ws), 1.0);
        EXPECT_NEAR(low.x / low.w, high.x / high.w, 1e-4);
        EXPECT_NEAR(low.y / low.w, high.y / high.w, 1e-4);
        EXPECT_GT(high.z / high.w, low.z / low.w);
    }
}

TEST(FitWarped, HasSmallerTexelsTowardsTheCamera) {
    const View view = along_ground();
    for (const Warp warp : {Warp::lispsm, Warp::trapezoidal}) {
        const LightFit fit = fit_warped(warp, kDefaultFocus, view.light, view.camera,
                                        view.receivers_ws, view.bounds, kMapSize, kMargin);
        const LightFit even = fit_warped(Warp::none, kDefaultFocus, view.light, view.camera,
                                         view.receivers_ws, view.bounds, kMapSize, kMargin);
        EXPECT_LT(fit.texel_size_m({0, 0, 0}), 0.5f * even.texel_size_m({0, 0, 0}));
        EXPECT_GT(fit.texel_size_m({0, 0, -190}), even.texel_size_m({0, 0, -190}));
    }
}

// In a yard whose ground reaches up to the camera the published warps magnify what is before its
// feet and starve the walls.
TEST(FitWarped, HasNoLargerTexelsThanAUniformMapOnTheWhole) {
    View view = along_ground();
    view.bounds = {{-10, 0, -10}, {10, 5, 10}};
    view.camera = look_at({0, 1.7f, 9.0f}, {0, 1.5f, -10}, radians(60.0f));
    view.light.to_light_ws = normalize({0.0f, 0.7f, -1.0f});
    view.receivers_ws = visible_corners(view.camera, {160, 90}, view.bounds);
    for (const Warp warp : {Warp::lispsm, Warp::trapezoidal}) {
        const LightFit fit = fit_warped(warp, kDefaultFocus, view.light, view.camera,
                                        view.receivers_ws, view.bounds, kMapSize, kMargin);
        const LightFit even = fit_warped(Warp::none, kDefaultFocus, view.light, view.camera,
                                         view.receivers_ws, view.bounds, kMapSize, kMargin);
        double gained = 0.0;
        for (const float across : {-8.0f, -3.0f, 3.0f, 8.0f}) {
            for (const Vec3 p : {Vec3(across, 2.5f, -10), Vec3(-10, 2.5f, across - 2.0f),
                                 Vec3(0.3f * across, 0, -6), Vec3(0.3f * across, 0, 2)}) {
                gained += static_cast<double>(std::log(even.texel_size_m(p) / fit.texel_size_m(p)));
            }
        }
        EXPECT_GE(gained, 0.0);
    }
}

TEST(WarpNear, BringsTheTrapezoidsFocusToFourFifths) {
    for (const double focus : {0.1, 0.4, 0.7}) {
        const double length_m = 50.0;
        const double n = warp_near_m(Warp::trapezoidal, focus, 10.0, 60.0, 1.0, length_m);
        // The share of the map up to a place at a distance w from the eye: f (w - n) / (w (f - n)).
        const double f = n + length_m;
        const double w = n + focus * length_m;
        EXPECT_NEAR(f * (w - n) / (w * length_m), 0.8, 1e-12);
    }
}

TEST(FitWarped, IsUniformWhereNothingCanBeGained) {
    View view = along_ground();
    const auto affine = [&](const Camera& camera, Vec3 to_light) {
        const DirectionalLight light{.to_light_ws = to_light};
        return fit_warped(Warp::lispsm, kDefaultFocus, light, camera, view.receivers_ws,
                          view.bounds, kMapSize, kMargin)
            .affine;
    };
    const glm::mat4 world_from_view = glm::inverse(view.camera.view_from_world);
    EXPECT_TRUE(affine(view.camera, Vec3(world_from_view[2])));  // the camera looks along the light
    Camera parallel = view.camera;
    parallel.ortho_height_m = 10.0f;
    parallel.ortho_depth_m = 300.0f;
    EXPECT_TRUE(affine(parallel, view.light.to_light_ws));
    EXPECT_FALSE(affine(view.camera, view.light.to_light_ws));
}

}  // namespace
}  // namespace gnomon
