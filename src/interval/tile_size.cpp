#include "interval/tile_size.h"

#include <algorithm>

namespace gnomon::interval {

namespace {

/// Weight of the last receivers in what is typical, and of what single ones took before.
constexpr double kNew = 0.3;
constexpr double kKept = 0.98;
/// Limits, in what is typical and in what single receivers take: as few tiles are given up as can
/// be, and those that are have not cost much more than single receivers.
constexpr double kMostTypical = 4.0, kMostSingle = 1.5;
/// What another size has to win: trials on few receivers differ by less.
constexpr double kWins = 0.9;
/// Groups of receivers between trials, at most: they then cost about a hundredth.
constexpr int kLongestWait = 64;

}  // namespace

bool TileSize::Wait::over() {
    if (--left > 0) return false;
    left = groups;
    return true;
}

void TileSize::Wait::longer() {
    groups = std::min(2 * groups, kLongestWait);
    left = groups;
}

double TileSize::limit_s() const {
    return std::max(kMostTypical * typical_s_, kMostSingle * single_s_);
}

TileSize::Trial TileSize::next_trial() {
    if (at_ > 0 && smaller_.over()) return Trial::smaller;
    if (at_ + 1 < kSizes.size() && larger_.over()) return Trial::larger;
    return Trial::none;
}

void TileSize::took(double s) {
    typical_s_ = typical_s_ == 0.0 ? s : (1.0 - kNew) * typical_s_ + kNew * s;
    single_s_ = at_ == 0 ? std::max(typical_s_, kKept * single_s_) : kKept * single_s_;
}

void TileSize::was_late(double single_s) {
    const double least = limit_s() / kMostSingle;
    single_s_ = single_s;
    if (single_s > least) return;
    typical_s_ = std::min(typical_s_, single_s);
    move_to(at_ - 1);
}

void TileSize::tried(Trial trial, double other_s, double s) {
    const bool wins = other_s < kWins * s;
    if (trial == Trial::larger) {
        wins ? move_to(at_ + 1) : larger_.longer();
    } else {
        wins ? move_to(at_ - 1) : smaller_.longer();
    }
}

/// Goes on in the same way soon, and not back at once.
void TileSize::move_to(std::size_t at) {
    constexpr int kSoon = 1, kNotAtOnce = 4;
    const bool grows = at > at_;
    (grows ? larger_ : smaller_) = {kSoon, kSoon};
    (grows ? smaller_ : larger_) = {kNotAtOnce, kNotAtOnce};
    at_ = at;
}

}  // namespace gnomon::interval
