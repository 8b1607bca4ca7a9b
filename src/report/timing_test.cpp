#include "report/timing.h"

#include "report/format.h"

#include <gtest/gtest.h>

namespace gnomon::report {
namespace {

TEST(Spread, IsMedianLeastAndGreatest) {
    const Spread odd = spread({5.0, 1.0, 3.0});
    EXPECT_EQ(odd.median, 3.0);
    EXPECT_EQ(odd.min, 1.0);
    EXPECT_EQ(odd.max, 5.0);
    EXPECT_EQ(spread({1.0, 2.0, 4.0, 8.0}).median, 3.0);
    EXPECT_EQ(spread({}).max, 0.0);
}

TEST(Summarize, AddsPassesOfOneNameAndCountsAbsentOnesAsZero) {
    std::vector<RenderStats> stats(3);
    stats[0].passes = {{"draw", 1.0}, {"draw", 2.0}, {"blur", 5.0}};
    stats[1].passes = {{"draw", 4.0}, {"copy", 7.0}};
    stats[2].passes = {{"draw", 5.0}};
    stats[1].memory_bytes = 9;
    const Timing timing = summarize({10.0, 30.0, 20.0}, stats);
    EXPECT_EQ(timing.total_ms.median, 20.0);
    EXPECT_EQ(timing.memory_bytes, 9u);
    ASSERT_EQ(timing.passes.size(), 3u);
    EXPECT_EQ(timing.passes[0].first, "draw");
    EXPECT_EQ(timing.passes[0].second.median, 4.0);
    EXPECT_EQ(timing.passes[0].second.min, 3.0);
    EXPECT_EQ(timing.passes[1].first, "blur");
    EXPECT_EQ(timing.passes[1].second.median, 0.0);
    EXPECT_EQ(timing.passes[2].second.max, 7.0);
}

TEST(ShortNumber, HasThreeDigitsAndTellsZeroFromSmall) {
    EXPECT_EQ(short_number(0.0), "0");
    EXPECT_EQ(short_number(1e-9), "<0.001");
    EXPECT_EQ(short_number(0.0344), "0.034");
    EXPECT_EQ(short_number(0.9999), "1.00");
    EXPECT_EQ(short_number(9.996), "10.0");
    EXPECT_EQ(short_number(1249.6), "1250");
    EXPECT_EQ(short_percent(0.0034), "0.340");
}

TEST(ShortBytes, UsesTheLargestUnitThatFits) {
    EXPECT_EQ(short_bytes(0), "0 B");
    EXPECT_EQ(short_bytes(512 << 10), "512 KiB");
    EXPECT_EQ(short_bytes(std::uint64_t{16} << 20), "16.0 MiB");
}

}  // namespace
}  // namespace gnomon::report
