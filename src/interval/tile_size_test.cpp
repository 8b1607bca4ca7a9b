#include "interval/tile_size.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gnomon::interval {
namespace {

/// What a receiver takes in tiles of a size, least with `best`, where it is 1.
double seconds(int size, double best) {
    return 1.0 + std::abs(std::log2(size / best));
}

/// A group of receivers.
TileSize::Trial trace(TileSize& size, double best) {
    const TileSize::Trial trial = size.next_trial();
    while (size.size() > 1 && seconds(size.size(), best) > size.limit_s())
        size.was_late(seconds(1, best));
    const double s = seconds(size.size(), best);
    size.took(s);
    if (trial == TileSize::Trial::smaller && size.size() > 1) {
        size.tried(trial, seconds(size.smaller_size(), best), s);
    } else if (trial == TileSize::Trial::larger && size.size() < 64) {
        size.tried(trial, seconds(size.larger_size(), best), s);
    }
    return trial;
}

TEST(TileSize, FindsTheBestSoon) {
    for (const int best : TileSize::kSizes) {
        TileSize size;
        for (int group = 0; group < 8; ++group)
            trace(size, best);
        EXPECT_EQ(size.size(), best);
    }
}

TEST(TileSize, FollowsWhatIsBest) {
    TileSize size;
    for (const int best : {1, 64, 16, 1, 64, 1, 16, 1}) {
        for (int group = 0; group < 200; ++group)
            trace(size, best);
        EXPECT_EQ(size.size(), best);
    }
}

TEST(TileSize, TilesThatAreLateGetMoreTimeOrBecomeSmaller) {
    TileSize size;
    while (size.size() < 16)
        trace(size, 16.0);
    for (int group = 0; group < 200; ++group)
        size.took(1.0);
    EXPECT_NEAR(size.limit_s(), 4.0, 0.5);
    size.was_late(100.0);  // all takes long here
    EXPECT_EQ(size.size(), 16);
    EXPECT_GT(size.limit_s(), 100.0);
    size.was_late(100.0);
    EXPECT_EQ(size.size(), 1);
}

TEST(TileSize, TrialsBecomeFew) {
    TileSize size;
    int trials = 0;
    for (int group = 0; group < 1000; ++group) {
        const bool is_trial = trace(size, 16) != TileSize::Trial::none;
        trials += group >= 500 && is_trial ? 1 : 0;
    }
    EXPECT_LE(trials, 20);
}

}  // namespace
}  // namespace gnomon::interval
