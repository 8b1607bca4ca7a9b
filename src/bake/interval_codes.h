#pragma once

#include <gnomon/bake.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gnomon::bake {

/// When a texel sees the light, in codes: units of a fixed part of a step.
struct CodedInterval {
    std::uint16_t rise = 0, fall = 0;
    bool operator==(const CodedInterval&) const = default;
};

/// Of one texel, in order of time; they do not touch.
using LitTimes = std::vector<CodedInterval>;

/// Where rise and fall of a texel's interval are on a page.
std::size_t value_index(const IntervalPage& page, std::size_t texel, std::size_t interval);

/// Joins neighbours, over the shortest gaps first, until there are at most `most` of them. Returns
/// the codes that were dark and are now lit.
std::uint64_t close_gaps(LitTimes& intervals, std::size_t most);

/// Where on its path, in codes, a window is to be asked for what it sees, which adds up: a window
/// of a closed path is also one path before or after its place.
struct WindowPlaces {
    std::array<double, 2> at{};
    std::size_t count = 1;
};
WindowPlaces window_places(const LightWindow& window);

/// The part of a window of `width` around `at` that lies in [rise, fall): each moment counts alike
/// when `even`, else as much as a disc that covers the window is high there. In [0, 1].
double seen_part(double rise, double fall, double at, double width, bool even);

}  // namespace gnomon::bake
