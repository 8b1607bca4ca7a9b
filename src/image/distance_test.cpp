#include "image/distance.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace gnomon::image {
namespace {

double brute_force(std::span<const std::uint8_t> mask, Extent size, unsigned x, unsigned y) {
    double nearest = std::numeric_limits<double>::infinity();
    for (unsigned j = 0; j < size.height; ++j) {
        for (unsigned i = 0; i < size.width; ++i) {
            if (mask[j * size.width + i] == 0) continue;
            const double dx = static_cast<double>(i) - x;
            const double dy = static_cast<double>(j) - y;
            nearest = std::min(nearest, dx * dx + dy * dy);
        }
    }
    return nearest;
}

TEST(SquaredDistance, EqualsBruteForceExactly) {
    std::mt19937 random(1);
    for (const Extent size : {Extent{1, 1}, Extent{37, 1}, Extent{1, 41}, Extent{53, 47}}) {
        for (const unsigned one_in : {1u, 2u, 9u, 100u, 1000u}) {
            std::vector<std::uint8_t> mask(size.width * size.height);
            for (std::uint8_t& value : mask)
                value = random() % one_in == 0 ? 1 : 0;
            const std::vector<double> distance = squared_distance_px2(mask, size);
            for (unsigned y = 0; y < size.height; ++y) {
                for (unsigned x = 0; x < size.width; ++x) {
                    ASSERT_EQ(distance[y * size.width + x], brute_force(mask, size, x, y))
                        << x << ", " << y << " of " << size.width << "x" << size.height;
                }
            }
        }
    }
}

TEST(SquaredDistance, IsInfiniteWithoutASetPixel) {
    const std::vector<std::uint8_t> mask(6, 0);
    for (const double value : squared_distance_px2(mask, {3, 2})) {
        EXPECT_EQ(value, std::numeric_limits<double>::infinity());
    }
}

TEST(SquaredDistance, IsExactBeyondFloatPrecision) {
    constexpr unsigned kWidth = 65'536;
    std::vector<std::uint8_t> mask(2 * kWidth, 0);
    mask[0] = 1;
    const std::vector<double> distance = squared_distance_px2(mask, {kWidth, 2});
    EXPECT_EQ(distance.back(), 65'535.0 * 65'535.0 + 1.0);
}

}  // namespace
}  // namespace gnomon::image
