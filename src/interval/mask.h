#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::interval {

/// The steps of a day at which a texel is lit: step k is bit k % 64 of word k / 64. Bits past the
/// last step are 0.
using Mask = std::span<const std::uint64_t>;

inline bool is_lit(Mask mask, int step) {
    return (mask[static_cast<unsigned>(step) / 64] >> (static_cast<unsigned>(step) % 64) & 1) != 0;
}

/// Steps [rise, fall) that are lit.
struct Interval {
    int rise = 0;
    int fall = 0;
    bool operator==(const Interval&) const = default;
};

/// The mask's runs of lit steps, earliest first; between two of them at least one step is dark.
std::vector<Interval> intervals(Mask mask);

/// Number of lit steps.
int lit_steps(Mask mask);

/// Transposes 64 x 64 bits in place: bit i of word j becomes bit j of word i.
void transpose(std::span<std::uint64_t, 64> bits);

}  // namespace gnomon::interval
