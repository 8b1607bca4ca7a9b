#include "trace/light_sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace gnomon::trace {
namespace {

const Receiver kUpAtOrigin{{0, 0, 0}, {0, 1, 0}, {kNoSurface, 0}};

TEST(Strata, HaveEqualAreasAndTileTheSquareForAnyCount) {
    for (int count = 1; count <= 131; ++count) {
        const Strata strata(count);
        Vec2 next_corner(0.0f);  // of the next stratum in its row
        for (int i = 0; i < count; ++i) {
            const Vec2 low = strata.point(i, {0.0f, 0.0f});
            const Vec2 high = strata.point(i, {1.0f, 1.0f});
            const float tolerance = 1e-6f;  // a few float roundings of numbers below 1
            EXPECT_NEAR((high.x - low.x) * (high.y - low.y), 1.0f / static_cast<float>(count),
                        tolerance)
                << count;
            EXPECT_NEAR(low.x, next_corner.x, tolerance) << count;
            EXPECT_NEAR(low.y, next_corner.y, tolerance) << count;
            const bool row_ends = high.x > 1.0f - tolerance;
            next_corner = row_ends ? Vec2(0.0f, high.y) : Vec2(high.x, low.y);
            // "Nearly square": rows differ by one stratum, so sides by less than a factor of 3.
            const float ratio = (high.x - low.x) / (high.y - low.y);
            EXPECT_LT(std::max(ratio, 1.0f / ratio), 3.001f) << count;
        }
        EXPECT_NEAR(next_corner.y, 1.0f, 1e-6f) << count;
    }
}

TEST(Random2d, IsUniformAndDependsOnEveryArgument) {
    constexpr int kCount = 1 << 16;
    Vec2 mean(0.0f);
    float product = 0.0f;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        const Vec2 u = random_2d(i / 256, i % 256, 7);
        mean += u / static_cast<float>(kCount);
        product += (u.x - 0.5f) * (u.y - 0.5f) / static_cast<float>(kCount);
    }
    // Five standard errors: of a mean of uniform numbers, and of a product of two centred ones.
    const float standard_error = std::sqrt(1.0f / 12.0f / kCount);
    EXPECT_NEAR(mean.x, 0.5f, 5.0f * standard_error);
    EXPECT_NEAR(mean.y, 0.5f, 5.0f * standard_error);
    EXPECT_NEAR(product, 0.0f, 5.0f / 12.0f / std::sqrt(static_cast<float>(kCount)));
    EXPECT_NE(random_2d(1, 2, 3), random_2d(2, 2, 3));
    EXPECT_NE(random_2d(1, 2, 3), random_2d(1, 3, 3));
    EXPECT_NE(random_2d(1, 2, 3), random_2d(1, 2, 4));
}

/// Mean weight of 4096 stratified samples.
template <typename LightType>
double mean_weight(const Receiver& receiver, const LightType& light) {
    const Strata strata(4096);
    double sum = 0.0;
    for (int i = 0; i < strata.count(); ++i) {
        const Vec2 u = strata.point(i, random_2d(0, static_cast<std::uint32_t>(i), 1));
        sum += sample_light(receiver, light, u).weight;
    }
    return sum / strata.count();
}

// The weights below vary by less than a factor of 3 over the light, so that jitter in 4096 strata
// leaves a relative error near 1/4096; this is ten times that.
constexpr double kRelativeTolerance = 2.5e-3;

// Form factors from a small plane to each shape as in J. R. Howell, "A Catalog of Radiation Heat
// Transfer Configuration Factors", 3rd edition (2010).
TEST(SampleLight, DiscHasItsFormFactor) {
    const DiscLight light{.center_ws = {0, 2, 0}, .normal_ws = {0, -1, 0}, .radius_m = 1.0f};
    // Area / pi = 1, and the form factor r² / (r² + h²) = 1 / 5.
    EXPECT_NEAR(mean_weight(kUpAtOrigin, light) / (1.0 / 5.0), 1.0, kRelativeTolerance);
}

TEST(SampleLight, RectangleHasItsFormFactor) {
    const RectLight light{
        .center_ws = {0, 2, 0}, .half_u_ws = {1, 0, 0}, .half_v_ws = {0, 0, 1.5f}};
    // cross(+X, +Z) = -Y: it shines down.
    const double x = 1.0 / 2.0;
    const double y = 1.5 / 2.0;
    const auto side = [](double a, double b) {
        return a / std::sqrt(1.0 + a * a) * std::atan(b / std::sqrt(1.0 + a * a));
    };
    const double form_factor = 2.0 / kPi * (side(x, y) + side(y, x));
    constexpr double kArea = 2.0 * 3.0;
    EXPECT_NEAR(mean_weight(kUpAtOrigin, light) * kArea / kPi / form_factor, 1.0,
                kRelativeTolerance);
}

TEST(SampleLight, SphereHasItsFormFactor) {
    const SphereLight light{.center_ws = {0.9f, 1.6f, 1.2f}, .radius_m = 0.8f};
    const double distance = std::sqrt(0.81 + 2.56 + 1.44);
    const double sine = 0.8 / distance;
    const double solid_angle = 2.0 * kPi * (1.0 - std::sqrt(1.0 - sine * sine));
    const double form_factor = 1.6 / distance * sine * sine;
    EXPECT_NEAR(mean_weight(kUpAtOrigin, light) * solid_angle / kPi / form_factor, 1.0,
                kRelativeTolerance);
}

TEST(SampleLight, SphereSamplesLieOnTheNearSide) {
    const SphereLight light{.center_ws = {3, 4, 5}, .radius_m = 2.0f};
    for (std::uint32_t i = 0; i < 100; ++i) {
        const Vec3 place = sample_light(kUpAtOrigin, light, random_2d(i, 0, 1)).direction_ws;
        // The rim, where the square root magnifies rounding (half of float's digits), included.
        EXPECT_NEAR(glm::distance(place, light.center_ws), 2.0f, 2e-3f);
        EXPECT_LT(glm::length(place), glm::length(light.center_ws));
    }
}

TEST(SampleLight, SunStaysInItsDiscAndFillsIt) {
    const DirectionalLight light = sun(radians(60.0f), radians(30.0f));
    const float cosine = std::cos(0.5f * light.angular_diameter_rad);
    Vec3 mean(0.0f);
    float least = 1.0f;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        const Vec3 direction = sample_light(kUpAtOrigin, light, random_2d(i, 0, 1)).direction_ws;
        EXPECT_NEAR(glm::length(direction), 1.0f, 1e-6f);
        least = std::min(least, glm::dot(direction, light.to_light_ws));
        mean += direction / 1000.0f;
    }
    EXPECT_GE(least, cosine - 1e-6f);  // 1e-6: float's cosines near 1
    EXPECT_LT(least, 1.0f - 0.9f * (1.0f - cosine));
    // Standard error of a mean over a disc of radius a: a / 2 / sqrt(1000) in each direction.
    EXPECT_LT(glm::distance(mean, light.to_light_ws),
              5.0f * 0.25f * light.angular_diameter_rad / std::sqrt(1000.0f));
}

TEST(FacesLight, EndsWithTheLastPartAboveTheHorizon) {
    const auto faces = [](const Light& light) { return faces_light(kUpAtOrigin, light); };
    EXPECT_TRUE(faces(SphereLight{.center_ws = {5, -0.9f, 0}, .radius_m = 1.0f}));
    EXPECT_FALSE(faces(SphereLight{.center_ws = {5, -1.1f, 0}, .radius_m = 1.0f}));
    EXPECT_TRUE(faces(sun(radians(-0.26f), 0.0f)));
    EXPECT_FALSE(faces(sun(radians(-0.27f), 0.0f)));
    EXPECT_FALSE(faces(sun(0.0f, 0.0f, 0.0f)));
    EXPECT_TRUE(faces(sun(radians(0.1f), 0.0f, 0.0f)));
    EXPECT_FALSE(faces(PointLight{.position_ws = {1, 0, 0}}));
    EXPECT_TRUE(faces(PointLight{.position_ws = {1, 0.01f, 0}}));
}

TEST(FacesLight, DiscsAndRectanglesShineToOneSide) {
    const auto faces = [](const Light& light) { return faces_light(kUpAtOrigin, light); };
    EXPECT_TRUE(faces(DiscLight{.center_ws = {0, 2, 0}, .normal_ws = {0, -1, 0}}));
    EXPECT_FALSE(faces(DiscLight{.center_ws = {0, 2, 0}, .normal_ws = {0, 1, 0}}));
    // A disc that stands on edge, its centre below the horizon.
    EXPECT_TRUE(
        faces(DiscLight{.center_ws = {3, -0.4f, 0}, .normal_ws = {-1, 0, 0}, .radius_m = 0.5f}));
    EXPECT_FALSE(
        faces(DiscLight{.center_ws = {3, -0.6f, 0}, .normal_ws = {-1, 0, 0}, .radius_m = 0.5f}));
    RectLight rect{
        .center_ws = {3, -0.4f, 0}, .half_u_ws = {0, 0.5f, 0}, .half_v_ws = {0, 0, -0.5f}};
    EXPECT_TRUE(faces(rect));  // cross(+Y, -Z) = -X
    rect.half_v_ws = -rect.half_v_ws;
    EXPECT_FALSE(faces(rect));
}

TEST(FacesLight, NobodyWhoIsNotThereOrInsideASphere) {
    EXPECT_FALSE(faces_light(Receiver{}, sun(1.0f, 0.0f)));
    EXPECT_FALSE(
        faces_light(kUpAtOrigin, SphereLight{.center_ws = {0, 0.5f, 0}, .radius_m = 1.0f}));
}

}  // namespace
}  // namespace gnomon::trace
