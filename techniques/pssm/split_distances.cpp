#include "split_distances.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace gnomon::pssm {

namespace {

double length(DepthRange range, bool logarithmic) {
    return logarithmic ? std::log(range.far_m / range.near_m) : range.far_m - range.near_m;
}

/// The distance before which a share of what is occupied lies.
double at_share(std::span<const DepthRange> occupied, double share, bool logarithmic) {
    double before = 0.0;
    for (const DepthRange& range : occupied)
        before += share * length(range, logarithmic);
    for (const DepthRange& range : occupied) {
        const double here = length(range, logarithmic);
        if (before <= here) {
            return logarithmic ? range.near_m * std::exp(before) : range.near_m + before;
        }
        before -= here;
    }
    return occupied.back().far_m;  // but for rounding
}

}  // namespace

std::vector<double> split_distances(std::span<const DepthRange> occupied, int splits,
                                    double lambda) {
    std::vector<double> distances_m{occupied.front().near_m};
    for (int i = 1; i < splits; ++i) {
        const double share = static_cast<double>(i) / splits;
        distances_m.push_back(lambda * at_share(occupied, share, true) +
                              (1.0 - lambda) * at_share(occupied, share, false));
    }
    distances_m.push_back(occupied.back().far_m);
    return distances_m;
}

int splits_needed(DepthRange whole, double farthest_m, int splits, double lambda) {
    const std::vector<double> begins_m =
        split_distances(std::span(&whole, 1), splits, lambda);  // the last one ends the last split
    const auto needed =
        std::ranges::count_if(std::span(begins_m).first(static_cast<std::size_t>(splits)),
                              [&](double begin_m) { return begin_m < farthest_m; });
    return std::max(static_cast<int>(needed), 1);
}

}  // namespace gnomon::pssm
