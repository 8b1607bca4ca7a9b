#include "bake/interval_codes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace gnomon::bake {

namespace {

/// The part of a disc of radius 1 that lies before x.
double disc_before(double x) {
    const double c = std::clamp(x, -1.0, 1.0);
    return 0.5 + (c * std::sqrt(1.0 - c * c) + std::asin(c)) / std::numbers::pi;
}

}  // namespace

std::size_t value_index(const IntervalPage& page, std::size_t texel, std::size_t interval) {
    constexpr std::size_t kPerPair = IntervalPage::kIntervalsPerPair;
    const std::size_t texels = std::size_t{page.side_texels} * page.side_texels;
    return ((interval / kPerPair) * texels + texel) * kPerPair + interval % kPerPair;
}

std::uint64_t close_gaps(LitTimes& intervals, std::size_t most) {
    if (intervals.size() <= most) return 0;
    const auto gap = [&](std::size_t i) { return intervals[i + 1].rise - intervals[i].fall; };
    std::vector<std::size_t> shortest(intervals.size() - 1);
    std::iota(shortest.begin(), shortest.end(), std::size_t{0});
    std::ranges::stable_sort(shortest, {}, gap);
    shortest.resize(intervals.size() - most);
    std::vector<bool> closes(intervals.size() - 1, false);
    std::uint64_t closed = 0;
    for (const std::size_t i : shortest) {
        closes[i] = true;
        closed += static_cast<std::uint64_t>(gap(i));
    }
    LitTimes joined{intervals.front()};
    for (std::size_t i = 1; i < intervals.size(); ++i) {
        if (closes[i - 1]) {
            joined.back().fall = intervals[i].fall;
        } else {
            joined.push_back(intervals[i]);
        }
    }
    intervals = std::move(joined);
    return closed;
}

WindowPlaces window_places(const LightWindow& window) {
    const double at = window.at_step * window.codes_per_step;
    if (!window.ends.closed) return {.at = {at}};
    const double path = window.ends.path_steps * window.codes_per_step;
    return {.at = {at, at < 0.5 * path ? at + path : at - path}, .count = 2};
}

double seen_part(double rise, double fall, double at, double width, bool even) {
    if (!(fall > rise)) return 0.0;
    if (!(width > 0.0)) return at >= rise && at < fall ? 1.0 : 0.0;
    const double half = 0.5 * width;
    if (!even) return disc_before((fall - at) / half) - disc_before((rise - at) / half);
    return std::max(0.0, std::min(fall, at + half) - std::max(rise, at - half)) / width;
}

}  // namespace gnomon::bake
