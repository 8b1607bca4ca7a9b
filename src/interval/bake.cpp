#include "interval/bake.h"

#include "base/check.h"
#include "base/parallel.h"
#include "interval/adaptive.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

namespace gnomon::interval {

namespace {

using trace::Receiver;

/// Receivers that one task does: some milliseconds of work.
constexpr std::size_t kBlock = 2048;

}  // namespace

DayMasks bake(const Tree& tree, const DayPath& path, std::span<const Receiver> receivers,
              Progress& progress, int texels_per_tile) {
    if (texels_per_tile < kChooseTile || texels_per_tile > TileTracer::kMaxTexels) {
        fail_input("texels per tile: {}; it must be 1 to {}, or {} for the fastest",
                   texels_per_tile, TileTracer::kMaxTexels, kChooseTile);
    }
    DayMasks masks;
    masks.steps = path.steps();
    const std::size_t words = masks.words_per_mask();
    masks.words.resize(receivers.size() * words);
    tbb::enumerable_thread_specific<AdaptiveTracer> tracers(
        [&] { return AdaptiveTracer(tree, path); });
    parallel_for((receivers.size() + kBlock - 1) / kBlock, 1,
                 [&](std::size_t block, std::size_t) {
                     const std::size_t first = block * kBlock;
                     const std::size_t last = std::min(first + kBlock, receivers.size());
                     const std::span<const Receiver> some = receivers.subspan(first, last - first);
                     const auto found =
                         std::span(masks.words).subspan(first * words, (last - first) * words);
                     if (texels_per_tile == kChooseTile) {
                         tracers.local().trace(some, found);
                     } else {
                         tracers.local().trace_by(texels_per_tile, some, found);
                     }
                 },
                 "baking the sun", &progress);
    return masks;
}

}  // namespace gnomon::interval
