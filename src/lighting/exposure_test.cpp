#include "lighting/exposure.h"

#include <gtest/gtest.h>

#include <vector>

namespace gnomon::lighting {
namespace {

/// Grey of that radiance, which is its luminance too.
Vec4 grey(float radiance, float irradiance_over_pi) {
    return {radiance, radiance, radiance, irradiance_over_pi};
}

TEST(Measure, IsNothingWithoutLight) {
    for (const std::vector<Vec4>& pixels : {std::vector<Vec4>{}, {Vec4(0.0f), Vec4(0.0f)}}) {
        const LightLevel level = measure(pixels);
        EXPECT_EQ(level.mean_irradiance_over_pi, 0.0f);
        EXPECT_EQ(level.bright_luminance, 0.0f);
        EXPECT_EQ(default_ambient(level), Vec3(0.0f));
        EXPECT_EQ(default_exposure(level, Vec3(0.0f)), 1.0f);
    }
}

TEST(Measure, LeavesOutWhatNoLightReaches) {
    const std::vector<Vec4> pixels = {grey(0, 0), grey(2, 3), grey(0, 0), grey(4, 5)};
    EXPECT_FLOAT_EQ(measure(pixels).mean_irradiance_over_pi, 4.0f);
}

TEST(Measure, TakesForBrightWhatNearlyAllDoNotExceed) {
    // A highlight on 1 of 100 pixels does not count, a bright tenth does.
    std::vector<Vec4> pixels(100, grey(1, 1));
    pixels[50] = grey(1000, 1);
    EXPECT_FLOAT_EQ(measure(pixels).bright_luminance, 1.0f);
    for (int i = 0; i < 10; ++i)
        pixels[static_cast<std::size_t>(i)] = grey(7, 1);
    EXPECT_FLOAT_EQ(measure(pixels).bright_luminance, 7.0f);
}

TEST(Measure, WeighsColorsAsTheEyeDoes) {
    const std::vector<Vec4> red(3, Vec4(1, 0, 0, 1)), green(3, Vec4(0, 1, 0, 1)),
        blue(3, Vec4(0, 0, 1, 1));
    const float r = measure(red).bright_luminance, g = measure(green).bright_luminance,
                b = measure(blue).bright_luminance;
    EXPECT_FLOAT_EQ(r + g + b, 1.0f);
    EXPECT_GT(g, r);
    EXPECT_GT(r, b);
}

TEST(DefaultAmbient, IsAboutATenthOfTheLight) {
    for (const float scale : {1e-3f, 1.0f, 1e5f}) {
        const Vec3 ambient = default_ambient({.mean_irradiance_over_pi = scale});
        EXPECT_GT(ambient.x, 0.08f * scale);
        EXPECT_LT(ambient.x, 0.15f * scale);
        EXPECT_EQ(ambient.x, ambient.y);
        EXPECT_EQ(ambient.x, ambient.z);
    }
}

TEST(DefaultExposure, MakesTheBrightPartsNearlyWhiteAtAnyScale) {
    for (const float scale : {1e-3f, 1.0f, 1e5f}) {
        const LightLevel level{.mean_irradiance_over_pi = scale, .bright_luminance = 2 * scale};
        const Vec3 ambient(0.5f * scale);
        const float shown = default_exposure(level, ambient) * 2.5f * scale;
        EXPECT_GT(shown, 0.7f);
        EXPECT_LT(shown, 1.0f);
    }
}

}  // namespace
}  // namespace gnomon::lighting
