#include <gnomon/error.h>
#include <gnomon/metrics.h>

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>

namespace gnomon {
namespace {

using Colour = std::array<unsigned, 3>;  // 8 bits a channel
using Formula = std::function<Colour(unsigned x, unsigned y)>;

constexpr Extent kSize = {96, 64};

Image picture(const Formula& formula, Extent size = kSize) {
    Image image(size, 3);
    for (unsigned y = 0; y < size.height; ++y) {
        for (unsigned x = 0; x < size.width; ++x) {
            const Colour colour = formula(x, y);
            for (int c = 0; c < 3; ++c) {
                image.at(x, y, c) =
                    static_cast<float>(colour[static_cast<std::size_t>(c)]) / 255.0f;
            }
        }
    }
    return image;
}

struct Pair {
    const char* name;
    Formula reference;
    Formula test;
    double mean_67;  // at 67 pixels per degree
    double mean_30;
    std::array<float, 3> map_67;  // at pixels (0, 0), (40, 31) and (95, 63)
};

bool speck(unsigned x, unsigned y) {
    return x % 16 == 8 && y % 16 == 8;
}

// The expected values are those of NVIDIA's package flip-evaluator 1.7 from PyPI,
// evaluate(reference, test, "LDR", applyMagma=False, parameters={"ppd": 67 or 30}), of these
// formulas as float32 / 255.
const std::array<Pair, 4> kPairs = {{
    {"texture",
     [](unsigned x, unsigned y) {
         return Colour{(7 * x + 3 * y) % 256, (5 * x + 11 * y) % 256, x * y % 256};
     },
     [](unsigned x, unsigned y) {
         return Colour{(7 * x + 3 * y + 9) % 256, (5 * x + 11 * y) % 256, (x * y + 2 * x) % 256};
     },
     0.2142813,
     0.3643354,
     {0.045049f, 0.235468f, 0.230661f}},
    {"edge",
     [](unsigned x, unsigned y) {
         return 2 * x + y < 100 ? Colour{204, 191, 179} : Colour{26, 26, 31};
     },
     [](unsigned x, unsigned y) {
         return 2 * x + y < 104 ? Colour{204, 191, 179} : Colour{26, 26, 31};
     },
     0.0521448,
     0.0396007,
     {0.0f, 0.160011f, 0.0f}},
    {"points",
     [](unsigned, unsigned) {
         return Colour{128, 120, 100};
     },
     [](unsigned x, unsigned y) {
         return speck(x, y) ? Colour{255, 255, 255} : Colour{128, 120, 100};
     },
     0.0232102,
     0.0143946,
     {0.000079f, 0.003235f, 0.000291f}},
    {"ramps",
     [](unsigned x, unsigned y) {
         return Colour{2 * x, 3 * y, 255 - 2 * x};
     },
     [](unsigned x, unsigned y) {
         return Colour{255 - 2 * x, 3 * y, 2 * x};
     },
     0.6818425,
     0.6797394,
     {0.967054f, 0.742097f, 0.951105f}},
}};

TEST(Flip, EqualsTheReferenceImplementation) {
    // Both round in float, in another order: 1e-6 in a mean. The exponents 0.7 and 0.5 enlarge that
    // in pixels whose colours are nearly alike: 1e-5. Five times as much leaves room for other
    // mathematical libraries.
    constexpr double kMeanTolerance = 5e-6;
    constexpr float kPixelTolerance = 5e-5f;
    for (const Pair& pair : kPairs) {
        SCOPED_TRACE(pair.name);
        const Image reference = picture(pair.reference);
        const Image test = picture(pair.test);
        EXPECT_NEAR(flip(reference, test), pair.mean_67, kMeanTolerance);
        EXPECT_NEAR(flip(reference, test, 30.0f), pair.mean_30, kMeanTolerance);
        const Image map = flip_map(reference, test);
        EXPECT_NEAR(map.at(0, 0), pair.map_67[0], kPixelTolerance);
        EXPECT_NEAR(map.at(40, 31), pair.map_67[1], kPixelTolerance);
        EXPECT_NEAR(map.at(95, 63), pair.map_67[2], kPixelTolerance);
    }
}

TEST(Flip, IsZeroForOnePictureAndSymmetric) {
    const Image a = picture(kPairs[0].reference);
    const Image b = picture(kPairs[0].test);
    EXPECT_EQ(flip(a, a), 0.0);
    EXPECT_EQ(flip(a, b), flip(b, a));
}

TEST(Flip, IsOneForTheColoursFarthestApart) {
    // By definition of the scale; the difference is a ratio of two equal numbers but for rounding.
    const Image green = picture([](unsigned, unsigned) { return Colour{0, 255, 0}; });
    const Image blue = picture([](unsigned, unsigned) { return Colour{0, 0, 255}; });
    EXPECT_NEAR(flip(green, blue), 1.0, 1e-5);
}

TEST(Flip, HandlesPicturesSmallerThanItsFilters) {
    const auto grey = [](unsigned value) {
        return picture([=](unsigned, unsigned) { return Colour{value, value, value}; }, {1, 1});
    };
    // A constant picture looks the same at any size.
    const auto wide_grey = [](unsigned value) {
        return picture([=](unsigned, unsigned) { return Colour{value, value, value}; });
    };
    EXPECT_NEAR(flip(grey(80), grey(160)), flip(wide_grey(80), wide_grey(160)), 1e-6);
}

TEST(Flip, ClampsColoursToTheDisplay) {
    Image bright({8, 8}, 3, 5.0f);
    EXPECT_EQ(flip(bright, Image({8, 8}, 3, 1.0f)), 0.0);
}

TEST(Flip, RefusesWhatItCannotCompare) {
    const Image image({8, 8}, 3);
    Image nan({8, 8}, 3);
    nan.at(3, 3, 1) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(flip(image, Image({8, 9}, 3)), Error);
    EXPECT_THROW(flip(image, Image({8, 8}, 1)), Error);
    EXPECT_THROW(flip(Image(), Image()), Error);
    EXPECT_THROW(flip(image, nan), Error);
    EXPECT_THROW(flip(image, image, 0.0f), Error);
    EXPECT_THROW(flip(image, image, std::numeric_limits<float>::quiet_NaN()), Error);
}

}  // namespace
}  // namespace gnomon
