#include "visibility/light_view.h"

#include <gnomon/error.h>

#include "visibility/light_fit_test.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>

namespace gnomon {
namespace {

using namespace test;

struct RandomSpot {
    SpotLight light;
    Box3 bounds;
};

RandomSpot random_spot(Random& random) {
    const float scale_m = std::pow(10.0f, random.uniform(-1.0f, 2.0f));
    RandomSpot spot;
    spot.light.position_ws = scale_m * random.point(Vec3(-2), Vec3(2));
    spot.light.direction_ws = random.direction();
    spot.light.outer_angle_rad = radians(random.uniform(1.0f, 80.0f));
    spot.bounds.include(Vec3(-scale_m));
    spot.bounds.include(Vec3(scale_m));
    return spot;
}

TEST(SpotView, HoldsItsConeWithinItsMargin) {
    Random random(7);
    for (unsigned i = 0; i < kViews; ++i) {
        const auto [light, bounds] = random_spot(random);
        const LightFit fit = fit_view(spot_view(light), bounds, kMapSize, kMarginTexels);
        ASSERT_TRUE(is_finite(fit));
        double reach = 0.0;
        const Vec3 across = normalize(glm::cross(light.direction_ws, random.direction()));
        const Vec3 other = glm::cross(light.direction_ws, across);
        constexpr int kRimPoints = 360;
        for (int k = 0; k < kRimPoints; ++k) {
            const float turn = 2.0f * kPi * static_cast<float>(k) / kRimPoints;
            const Vec3 radial = std::cos(turn) * across + std::sin(turn) * other;
            const Vec3 rim =
                light.position_ws +
                bounds.diagonal() * (std::cos(light.outer_angle_rad) * light.direction_ws +
                                     std::sin(light.outer_angle_rad) * radial);
            const Projected at = project(fit, DVec3(rim));
            reach = std::max({reach, std::abs(at.ndc.x), std::abs(at.ndc.y)});
        }
        // The rim touches the margin; it is sampled each degree, and computed in float.
        EXPECT_NEAR(reach, kInnerNdc, 1e-4);
    }
}

TEST(SpotView, HasReversedDepthWithoutAFarPlane) {
    Random random(8);
    for (unsigned i = 0; i < kViews; ++i) {
        const auto [light, bounds] = random_spot(random);
        const LightFit fit = fit_view(spot_view(light), bounds, kMapSize, kMarginTexels);
        double before = 1.0;
        for (const double fraction : {1e-3, 1e-2, 0.1, 1.0, 10.0, 1e3}) {
            const DVec3 p =
                DVec3(light.position_ws) + fraction * bounds.diagonal() * DVec3(light.direction_ws);
            const double depth = project(fit, p).ndc.z;
            EXPECT_LT(depth, before);
            EXPECT_GT(depth, 0.0);
            before = depth;
        }
    }
}

TEST(SpotView, KnowsTheSizeOfItsTexels) {
    Random random(9);
    for (unsigned i = 0; i < kViews; ++i) {
        const auto [light, bounds] = random_spot(random);
        const LightFit fit = fit_view(spot_view(light), bounds, kMapSize, kMarginTexels);
        const Vec3 across = normalize(glm::cross(light.direction_ws, random.direction()));
        const float distance_m = bounds.diagonal() * random.uniform(0.1f, 2.0f);
        const Vec3 p = light.position_ws + distance_m * (light.direction_ws + 0.3f * across);
        const Vec3 aside = normalize(glm::cross(light.direction_ws, random.direction()));
        const double texel_m = fit.texel_size_m(p);
        EXPECT_NEAR(texels_moved(fit, DVec3(p), 10.0 * texel_m * DVec3(aside)), 10.0, 1e-2);
    }
    SpotLight light;
    EXPECT_EQ(fit_view(spot_view(light), {}, kMapSize, 0).texel_size_m({0, 5, 0}),
              0.0f);  // behind it
}

TEST(SpotView, RefusesConesThatNoMapHolds) {
    SpotLight light;
    light.outer_angle_rad = radians(80.0f);
    EXPECT_NO_THROW(fit_view(spot_view(light), {}, kMapSize, kMarginTexels));
    light.outer_angle_rad = radians(81.0f);
    try {
        fit_view(spot_view(light), {}, kMapSize, kMarginTexels);
        FAIL() << "a cone of 162° was fitted";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_NE(std::string(error.what()).find("160"), std::string::npos) << error.what();
    }
}

bool within(const LightView& view, DVec3 p_ws) {
    return std::ranges::all_of(view.planes(), [&](const glm::dvec4& plane) {
        return glm::dot(DVec3(plane), p_ws) + plane.w >= -1e-12;
    });
}

// What the look-up relies on: a point lies in the view along whose axis it is farthest.
TEST(FaceViews, ShareTheDirectionsByTheirAxes) {
    Random random(10);
    const DVec3 position(3.0, -2.0, 0.5);
    for (const std::vector<LightView>& views :
         {cube_views(position), tetrahedron_views(position)}) {
        for (int i = 0; i < 1000; ++i) {
            const DVec3 direction(random.direction());
            const auto along = [&](const LightView& view) {
                return glm::dot(view.forward_ws, direction);
            };
            const LightView& view = *std::ranges::max_element(views, {}, along);
            EXPECT_TRUE(within(view, position + direction));
        }
    }
}

TEST(FaceViews, FitTheReceiversWithinTheirMargin) {
    Random random(11);
    for (unsigned i = 0; i < kViews; ++i) {
        const std::vector<LightView> views =
            i % 2 == 0 ? cube_views(DVec3(0.0)) : tetrahedron_views(DVec3(0.0));
        const LightView& view = views[i % views.size()];
        std::vector<DVec3> receivers_ws;
        while (receivers_ws.size() < 5) {
            const DVec3 p = 4.0 * DVec3(random.direction());
            if (within(view, p)) receivers_ws.push_back(p);
        }
        Box3 bounds;
        bounds.include(Vec3(-5));
        bounds.include(Vec3(5));
        const LightFit fit = fit_view(fitted(view, receivers_ws), bounds, kMapSize, kMarginTexels);
        DVec3 low(1.0), high(-1.0);
        for (const DVec3& p : receivers_ws) {
            low = glm::min(low, project(fit, p).ndc);
            high = glm::max(high, project(fit, p).ndc);
        }
        for (int axis = 0; axis < 2; ++axis) {
            EXPECT_NEAR(low[axis], -kInnerNdc, 1e-4);
            EXPECT_NEAR(high[axis], kInnerNdc, 1e-4);
        }
    }
}

}  // namespace
}  // namespace gnomon
