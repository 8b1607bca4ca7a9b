#include "interval/bake.h"

#include "base/check.h"
#include "base/parallel.h"
#include "interval/tile.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>

namespace gnomon::interval {

namespace {

using Clock = std::chrono::steady_clock;
using trace::Receiver;

constexpr std::array<int, 3> kTileSizes = {1, 16, 64};
/// Receivers of a trial of each size: few singly, which are by far the slowest where neighbours
/// share anything. Each size starts at a multiple of itself, where squares of a Z-order curve do.
constexpr std::array<std::size_t, 3> kTrials = {16, 48, 64};
/// Receivers that one task does, and for which a size is chosen: charts differ. Some milliseconds
/// of work, of which trials are a sixteenth.
constexpr std::size_t kBlock = 2048;
/// Where neighbours are far apart, tiles take many times as long as single receivers, the larger
/// the longer: after one that took so much longer than the best none is tried.
constexpr double kHopeless = 2.0;

/// Part of a list of receivers with its masks.
struct Part {
    std::span<const Receiver> receivers;
    std::span<std::uint64_t> masks;
    std::size_t words;

    Part next(std::size_t count) {
        count = std::min(count, receivers.size());
        const Part part{receivers.first(count), masks.first(count * words), words};
        receivers = receivers.subspan(count);
        masks = masks.subspan(count * words);
        return part;
    }
};

/// Does a part with the size of tiles that was fastest at its start.
void trace_timed(TileTracer& tracer, Part part) {
    double best_s = std::numeric_limits<double>::infinity();
    int best_size = kTileSizes[0];
    for (std::size_t i = 0; i < kTileSizes.size() && !part.receivers.empty(); ++i) {
        const Part trial = part.next(kTrials[i]);
        const auto start = Clock::now();
        tracer.trace(trial.receivers, kTileSizes[i], trial.masks);
        const double s = std::chrono::duration<double>(Clock::now() - start).count() /
                         static_cast<double>(trial.receivers.size());
        if (s > kHopeless * best_s) break;
        if (s < best_s) best_size = kTileSizes[i];
        best_s = std::min(best_s, s);
    }
    tracer.trace(part.receivers, best_size, part.masks);
}

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
    tbb::enumerable_thread_specific<TileTracer> tracers([&] { return TileTracer(tree, path); });
    parallel_for((receivers.size() + kBlock - 1) / kBlock, 1,
                 [&](std::size_t block, std::size_t) {
                     const std::size_t first = block * kBlock;
                     const std::size_t last = std::min(first + kBlock, receivers.size());
                     const Part part{
                         receivers.subspan(first, last - first),
                         std::span(masks.words).subspan(first * words, (last - first) * words),
                         words};
                     if (texels_per_tile == kChooseTile) {
                         trace_timed(tracers.local(), part);
                     } else {
                         tracers.local().trace(part.receivers, texels_per_tile, part.masks);
                     }
                 },
                 "baking the sun", &progress);
    return masks;
}

}  // namespace gnomon::interval
