#include "split_distances.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gnomon::pssm {
namespace {

std::vector<DepthRange> view(double near_m, double far_m) {
    return {{near_m, far_m}};
}

TEST(SplitDistances, BeginAndEndWithTheViewAndRise) {
    for (const double lambda : {0.0, 0.3, 1.0}) {
        for (int splits = 1; splits <= 8; ++splits) {
            const std::vector<double> distances_m =
                split_distances(view(0.5, 300.0), splits, lambda);
            ASSERT_EQ(distances_m.size(), static_cast<std::size_t>(splits) + 1);
            EXPECT_EQ(distances_m.front(), 0.5);
            EXPECT_EQ(distances_m.back(), 300.0);
            for (int i = 0; i < splits; ++i)
                EXPECT_LT(distances_m[i], distances_m[i + 1]);
        }
    }
}

TEST(SplitDistances, AreUniformLogarithmicOrBetween) {
    const std::vector<double> uniform = split_distances(view(1.0, 81.0), 4, 0.0);
    const std::vector<double> logarithmic = split_distances(view(1.0, 81.0), 4, 1.0);
    const std::vector<double> half = split_distances(view(1.0, 81.0), 4, 0.5);
    for (int i = 0; i <= 4; ++i) {
        EXPECT_NEAR(uniform[i], 1.0 + 20.0 * i, 1e-12);
        EXPECT_NEAR(logarithmic[i], std::pow(3.0, i), 1e-12);
        EXPECT_NEAR(half[i], 0.5 * (uniform[i] + logarithmic[i]), 1e-12);
    }
}

// Logarithmic ones of 1 to 81 begin at 1, 3, 9 and 27.
TEST(SplitDistances, AreAsManyAsTheFarthestReceiverNeeds) {
    const DepthRange whole{1.0, 81.0};
    EXPECT_EQ(splits_needed(whole, 81.0, 4, 1.0), 4);
    EXPECT_EQ(splits_needed(whole, 26.0, 4, 1.0), 3);
    EXPECT_EQ(splits_needed(whole, 10.0, 4, 1.0), 3);
    EXPECT_EQ(splits_needed(whole, 8.0, 4, 1.0), 2);
    EXPECT_EQ(splits_needed(whole, 2.0, 4, 1.0), 1);
    EXPECT_EQ(splits_needed(whole, 0.5, 4, 1.0), 1);
    EXPECT_EQ(splits_needed(whole, 40.0, 4, 0.0), 2);  // uniform: 1, 21, 41, 61
}

TEST(SplitDistances, LeaveOutWhereNothingIs) {
    const std::vector<DepthRange> occupied{{1.0, 4.0}, {100.0, 400.0}};
    const std::vector<double> logarithmic = split_distances(occupied, 4, 1.0);
    EXPECT_NEAR(logarithmic[1], 2.0, 1e-12);
    EXPECT_NEAR(logarithmic[2], 4.0, 1e-12);
    EXPECT_NEAR(logarithmic[3], 200.0, 1e-9);
    const std::vector<double> uniform = split_distances(occupied, 3, 0.0);
    EXPECT_NEAR(uniform[1], 198.0, 1e-9);  // 101 of 303 metres: 3, and 98 beyond the gap
    EXPECT_NEAR(uniform[2], 299.0, 1e-9);
    EXPECT_EQ(uniform[3], 400.0);
}

}  // namespace
}  // namespace gnomon::pssm
