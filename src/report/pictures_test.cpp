#include "report/pictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::report {
namespace {

constexpr float kByte = 1.0f / 255.0f;  // what an 8-bit image can tell apart

Vec3 linear(Vec3 srgb) {
    return {linear_from_srgb(srgb.x), linear_from_srgb(srgb.y), linear_from_srgb(srgb.z)};
}

/// OKLab of a linear sRGB colour: Ottosson's forward matrices, the inverse of those under test.
Vec3 oklab(Vec3 rgb) {
    const float l = std::cbrt(glm::dot(rgb, Vec3(0.4122214708f, 0.5363325363f, 0.0514459929f)));
    const float m = std::cbrt(glm::dot(rgb, Vec3(0.2119034982f, 0.6806995451f, 0.1073969566f)));
    const float s = std::cbrt(glm::dot(rgb, Vec3(0.0883024619f, 0.2817188376f, 0.6299787005f)));
    const Vec3 lms(l, m, s);
    return {glm::dot(lms, Vec3(0.2104542553f, 0.7936177850f, -0.0040720468f)),
            glm::dot(lms, Vec3(1.9779984951f, -2.4285922050f, 0.4505937099f)),
            glm::dot(lms, Vec3(0.0259040371f, 0.7827717662f, -0.8086757660f))};
}

TEST(DifferenceColor, IsNeutralAtZero) {
    const Vec3 color = difference_color(0.0f);
    EXPECT_NEAR(color.x, color.y, kByte);
    EXPECT_NEAR(color.y, color.z, kByte);
}

TEST(DifferenceColor, DarkensEquallyAndEvenlyOnBothSides) {
    // Clamping a colour that sRGB cannot show would bend the line: 0.002 is a tenth of a just
    // noticeable difference of OKLab lightness.
    constexpr float kTolerance = 0.002f;
    const float neutral = oklab(linear(difference_color(0.0f))).x;
    const float end = oklab(linear(difference_color(1.0f))).x;
    for (int i = 0; i <= 20; ++i) {
        const float amount = 0.05f * static_cast<float>(i);
        const float expected = neutral + amount * (end - neutral);
        EXPECT_NEAR(oklab(linear(difference_color(amount))).x, expected, kTolerance) << amount;
        EXPECT_NEAR(oklab(linear(difference_color(-amount))).x, expected, kTolerance) << amount;
    }
    EXPECT_GT(neutral - end, 0.4f) << "a scale of few lightnesses shows few differences";
}

TEST(DifferenceColor, ClampsWhatIsOutOfRange) {
    EXPECT_EQ(difference_color(3.0f), difference_color(1.0f));
    EXPECT_EQ(difference_color(-3.0f), difference_color(-1.0f));
}

// G. M. Machado et al., "A physiologically-based model for simulation of color vision deficiency",
// 2009: linear RGB as seen with no red, no green and no blue cones.
const std::array<std::array<Vec3, 3>, 3> kDeficiencies = {{{{{0.152286f, 1.052583f, -0.204868f},
                                                             {0.114503f, 0.786281f, 0.099216f},
                                                             {-0.003882f, -0.048116f, 1.051998f}}},
                                                           {{{0.367322f, 0.860646f, -0.227968f},
                                                             {0.280085f, 0.672501f, 0.047413f},
                                                             {-0.011820f, 0.042940f, 0.968881f}}},
                                                           {{{1.255528f, -0.076749f, -0.178779f},
                                                             {-0.078411f, 0.930809f, 0.147602f},
                                                             {0.004733f, 0.691367f, 0.303900f}}}}};

TEST(DifferenceColor, KeepsItsSidesApartForColourBlindEyes) {
    // 0.02 in OKLab is about a just noticeable difference; a clear one is five times that.
    constexpr float kClear = 0.1f;
    for (const auto& deficiency : kDeficiencies) {
        const auto seen = [&](float difference) {
            const Vec3 rgb = linear(difference_color(difference));
            const Vec3 seen_rgb(glm::dot(deficiency[0], rgb), glm::dot(deficiency[1], rgb),
                                glm::dot(deficiency[2], rgb));
            return oklab(glm::max(seen_rgb, Vec3(0.0f)));
        };
        EXPECT_GT(glm::length(seen(0.5f) - seen(-0.5f)), kClear);
        EXPECT_GT(glm::length(seen(1.0f) - seen(-1.0f)), kClear);
    }
}

TEST(DifferenceImage, ShowsTheDifferenceAndHatchesWhatIsNotJudged) {
    const Extent size{40, 40};
    Image visibility(size, 1, 1.0f), truth(size, 1, 0.0f), facing(size, 1, 1.0f);
    for (unsigned y = 0; y < 40; ++y) {
        for (unsigned x = 20; x < 40; ++x)
            facing.at(x, y) = 0.0f;
    }
    const Image image = difference_image(visibility, truth, facing);
    const Vec3 bright = difference_color(1.0f);
    float darkest = 1.0f, lightest = 0.0f;
    for (unsigned y = 0; y < 40; ++y) {
        for (int i = 0; i < 3; ++i)
            EXPECT_EQ(image.at(3, y, i), bright[i]);
        EXPECT_EQ(image.at(30, y, 0), image.at(30, y, 1));
        EXPECT_EQ(image.at(30, y, 0), image.at(30, y, 2));
        darkest = std::min(darkest, image.at(30, y, 0));
        lightest = std::max(lightest, image.at(30, y, 0));
    }
    EXPECT_GT(lightest - darkest, 10 * kByte) << "the hatch has two greys";
}

TEST(WorstWindow, FindsTheErrorsAndLeavesOutWhatIsNotJudged) {
    const Extent size{200, 120};
    Image truth(size, 1, 1.0f), visibility(size, 1, 1.0f), facing(size, 1, 1.0f);
    for (unsigned y = 50; y < 60; ++y) {
        for (unsigned x = 130; x < 150; ++x)
            visibility.at(x, y) = 0.25f;
    }
    for (unsigned x = 0; x < 60; ++x) {  // a greater error that does not count
        for (unsigned y = 0; y < 60; ++y) {
            visibility.at(x, y) = 0.0f;
            facing.at(x, y) = 0.0f;
        }
    }
    const Window window = worst_window(visibility, truth, facing, 64);
    EXPECT_LE(window.x, 130u);
    EXPECT_GE(window.x + window.width, 150u);
    EXPECT_LE(window.y, 50u);
    EXPECT_GE(window.y + window.height, 60u);
    EXPECT_EQ(window.width, 64u);
    EXPECT_EQ(window.height, 64u);
    EXPECT_NEAR(window.error_sum, 200 * 0.75, 1e-9);  // exact in float; sums in double
}

TEST(WorstWindow, IsEmptyOfErrorWithoutDifferenceAndFitsSmallImages) {
    const Image one({5, 3}, 1, 1.0f);
    const Window window = worst_window(one, one, one, 64);
    EXPECT_EQ(window.error_sum, 0.0);
    EXPECT_EQ(window.width, 5u);
    EXPECT_EQ(window.height, 3u);
}

TEST(WorstStrip, EnlargesTruthTechniqueAndDifferenceSideBySide) {
    Image truth({4, 4}, 1), visibility({4, 4}, 1), difference({4, 4}, 3);
    truth.at(2, 1) = 0.25f;
    visibility.at(2, 1) = 0.5f;
    difference.at(2, 1, 2) = 0.75f;
    const Image strip = worst_strip(visibility, truth, difference, {2, 1, 2, 2, 1.0}, 4, 8);
    ASSERT_EQ(strip.size(), (Extent{3 * 8 + 2 * 8, 8}));
    for (unsigned y = 0; y < 4; ++y) {
        for (unsigned x = 0; x < 4; ++x) {
            EXPECT_EQ(strip.at(x, y, 0), 0.25f);
            EXPECT_EQ(strip.at(16 + x, y, 1), 0.5f);
            EXPECT_EQ(strip.at(32 + x, y, 2), 0.75f);
        }
    }
    EXPECT_EQ(strip.at(4, 0, 0), 0.0f) << "the next pixel";
    EXPECT_EQ(strip.at(8, 0, 3), 0.0f) << "the gap is transparent";
}

}  // namespace
}  // namespace gnomon::report
