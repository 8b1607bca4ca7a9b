#include "bake/interval_codes.h"

#include <gtest/gtest.h>

namespace gnomon::bake {
namespace {

TEST(IntervalCodes, ShortestGapsCloseFirst) {
    const std::vector<CodedInterval> all{{0, 10}, {12, 20}, {50, 60}, {61, 70}, {90, 99}};
    std::vector<CodedInterval> few = all;
    EXPECT_EQ(close_gaps(few, 5), 0u);
    EXPECT_EQ(few, all);
    EXPECT_EQ(close_gaps(few, 3), 3u);
    EXPECT_EQ(few, (std::vector<CodedInterval>{{0, 20}, {50, 70}, {90, 99}}));
    EXPECT_EQ(close_gaps(few, 1), 50u);
    EXPECT_EQ(few, (std::vector<CodedInterval>{{0, 99}}));
}

TEST(IntervalCodes, AWindowSeesWhatOverlapsIt) {
    EXPECT_DOUBLE_EQ(seen_part(10, 20, 15, 4, true), 1.0);
    EXPECT_DOUBLE_EQ(seen_part(10, 20, 10, 4, true), 0.5);
    EXPECT_DOUBLE_EQ(seen_part(10, 20, 21, 4, true), 0.25);
    EXPECT_DOUBLE_EQ(seen_part(10, 20, 30, 4, true), 0.0);
    EXPECT_DOUBLE_EQ(seen_part(65535, 0, 15, 4, true), 0.0);
}

// The disc's half is seen when the edge is in its middle, and less than a quarter of it when a
// quarter of its width is.
TEST(IntervalCodes, ADiscIsThinAtItsEnds) {
    EXPECT_DOUBLE_EQ(seen_part(10, 20, 10, 4, false), 0.5);
    EXPECT_NEAR(seen_part(10, 20, 9, 4, false), 0.195501, 1e-6);  // a segment of height r / 2
    EXPECT_DOUBLE_EQ(seen_part(10, 20, 15, 4, false), 1.0);
    const double parts = seen_part(0, 9, 10, 4, false) + seen_part(9, 11, 10, 4, false) +
                         seen_part(11, 30, 10, 4, false);
    EXPECT_NEAR(parts, 1.0, 1e-12);
}

TEST(IntervalCodes, APointIsSeenOrNot) {
    EXPECT_EQ(seen_part(10, 20, 10, 0, true), 1.0);
    EXPECT_EQ(seen_part(10, 20, 20, 0, false), 0.0);
}

}  // namespace
}  // namespace gnomon::bake
