#pragma once

#include <gnomon/progress.h>

#include "interval/mask.h"
#include "interval/path.h"
#include "interval/tree.h"
#include "trace/receiver.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::interval {

/// A mask for each receiver, one after the other.
struct DayMasks {
    int steps = 0;
    std::vector<std::uint64_t> words;

    std::size_t words_per_mask() const { return (static_cast<std::size_t>(steps) + 63) / 64; }
    Mask mask(std::size_t receiver) const {
        return Mask(words).subspan(receiver * words_per_mask(), words_per_mask());
    }
};

/// Let bake() choose how many receivers are traced together.
inline constexpr int kChooseTile = 0;

/// The steps of the day at which each receiver is lit, on all of TBB's threads. Neighbours in the
/// list should be neighbours in the scene: texels of a chart along a Z-order curve, chart by chart.
/// `texels_per_tile` (1 to TileTracer::kMaxTexels) decides the time and never the result; without
/// it, each thread learns on the way which is fastest. Throws Error{input} for a tile out of
/// range, Error{cancelled}.
DayMasks bake(const Tree& tree, const DayPath& path, std::span<const trace::Receiver> receivers,
              Progress& progress, int texels_per_tile = kChooseTile);

}  // namespace gnomon::interval
