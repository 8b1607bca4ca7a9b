#include "interval/mask.h"

#include "interval/test_days.h"

#include <gtest/gtest.h>

namespace gnomon::interval {
namespace {

using Words = std::vector<std::uint64_t>;

TEST(Intervals, AreTheRunsOfLitSteps) {
    EXPECT_TRUE(intervals(Words{0, 0}).empty());
    EXPECT_EQ(intervals(Words{0b0111'0010}), (std::vector<Interval>{{1, 2}, {4, 7}}));
    const std::uint64_t all = ~std::uint64_t{0};
    EXPECT_EQ(intervals(Words{all, all}), (std::vector<Interval>{{0, 128}}));
    EXPECT_EQ(intervals(Words{all << 63, 1, all}), (std::vector<Interval>{{63, 65}, {128, 192}}));
}

TEST(Intervals, HoldAllLitStepsAndNoOther) {
    Random random(1);
    for (int repeat = 0; repeat < 100; ++repeat) {
        Words mask(4);
        for (std::uint64_t& word : mask) {
            for (int bit = 0; bit < 64; ++bit)
                word |= std::uint64_t{random.between(0, 1) < 0.3f} << bit;
        }
        Words again(4);
        int count = 0;
        for (const auto& [rise, fall] : intervals(mask)) {
            ASSERT_LT(rise, fall);
            count += fall - rise;
            for (int step = rise; step < fall; ++step)
                again[static_cast<unsigned>(step) / 64] |= std::uint64_t{1} << (step % 64);
        }
        EXPECT_EQ(again, mask);
        EXPECT_EQ(count, lit_steps(mask));
    }
}

TEST(Transpose, SwapsRowsAndColumns) {
    Words bits(64), before(64);
    for (unsigned i = 0; i < 64; ++i)
        before[i] = bits[i] = 0x9e3779b97f4a7c15 * (i + 1);
    transpose(std::span<std::uint64_t, 64>(bits));
    for (unsigned i = 0; i < 64; ++i) {
        for (unsigned j = 0; j < 64; ++j)
            ASSERT_EQ(bits[i] >> j & 1, before[j] >> i & 1);
    }
}

}  // namespace
}  // namespace gnomon::interval
