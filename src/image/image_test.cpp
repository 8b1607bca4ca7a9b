#include <gnomon/error.h>
#include <gnomon/image.h>

#include <gtest/gtest.h>

namespace gnomon {
namespace {

TEST(Image, IsRowMajorWithInterleavedChannels) {
    Image image({3, 2}, 2, 0.5f);
    ASSERT_EQ(image.pixels().size(), 12u);
    EXPECT_EQ(image.pixels()[11], 0.5f);
    image.at(1, 1, 1) = 7.0f;
    EXPECT_EQ(image.pixels()[9], 7.0f);  // (1 * 3 + 1) * 2 + 1
}

TEST(Image, RefusesSizesAndChannelsOutsideTheRange) {
    EXPECT_THROW(Image({0, 1}, 1), Error);
    EXPECT_THROW(Image({1, 0}, 1), Error);
    EXPECT_THROW(Image({65'537, 1}, 1), Error);
    EXPECT_THROW(Image({1, 1}, 0), Error);
    EXPECT_THROW(Image({1, 1}, 5), Error);
    EXPECT_NO_THROW(Image({65'536, 1}, 1));
    EXPECT_TRUE(Image().empty());
}

TEST(Srgb, HasTheStandardsValues) {
    EXPECT_EQ(srgb_from_linear(0.0f), 0.0f);
    // 1.055 - 0.055 and the powers round in float: a few units in the last place of 1.
    constexpr float kTolerance = 4e-7f;
    EXPECT_NEAR(srgb_from_linear(1.0f), 1.0f, kTolerance);
    EXPECT_NEAR(srgb_from_linear(0.5f), 0.735356983f, kTolerance);
    EXPECT_NEAR(linear_from_srgb(0.5f), 0.214041140f, kTolerance);
    EXPECT_NEAR(srgb_from_linear(0.002f), 0.02584f, kTolerance);  // the linear toe
}

TEST(Srgb, InvertsItself) {
    for (int i = 0; i <= 1000; ++i) {
        const float value = static_cast<float>(i) / 1000.0f;
        // The standard's two pieces meet only to 1e-7 or so; the rest is float rounding.
        EXPECT_NEAR(linear_from_srgb(srgb_from_linear(value)), value, 1e-6f);
    }
}

}  // namespace
}  // namespace gnomon
