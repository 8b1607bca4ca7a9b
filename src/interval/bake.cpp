#include "interval/bake.h"

#include "base/check.h"
#include "base/parallel.h"
#include "interval/tile.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <chrono>

namespace gnomon::interval {

namespace {

using Clock = std::chrono::steady_clock;
using trace::Receiver;

/// Receivers that one task does: some milliseconds of work.
constexpr std::size_t kReceiversPerTask = 1 << 12;

constexpr std::array<int, 4> kTileSizes = {1, 16, 32, 64};
/// A trial of another size: its receivers, two tiles of the largest, or fewer singly, which are by
/// far the slowest where neighbours share anything.
constexpr std::array<std::size_t, 4> kTrials = {16, 64, 64, 128};
/// Receivers between two trials: at first, and after trials in vain.
constexpr std::size_t kLeastPause = 256, kGreatestPause = 1 << 14;

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

/// A thread's tracer, and the size of tiles that has been fastest of late. Next sizes are tried
/// now and then, the seldomer the longer nothing changes.
class AdaptiveTracer {
public:
    AdaptiveTracer(const Tree& tree, const DayPath& path) : tracer_(tree, path) {}

    void trace(const Part& part, int texels_per_tile) {
        tracer_.trace(part.receivers, texels_per_tile, part.masks);
    }
    void trace(Part part) {
        while (!part.receivers.empty()) {
            const Part usual = part.next(pause_);
            const double usual_s = seconds_per_receiver(usual, size_);
            up_ = size_ == 0 || (size_ + 1 < kTileSizes.size() && !up_);
            const std::size_t other = up_ ? size_ + 1 : size_ - 1;
            const Part trial = part.next(kTrials[other]);
            if (trial.receivers.empty()) break;
            const bool better = seconds_per_receiver(trial, other) < usual_s;
            if (better) size_ = other;
            pause_ = better ? kLeastPause : std::min(2 * pause_, kGreatestPause);
        }
    }

private:
    double seconds_per_receiver(const Part& part, std::size_t size) {
        const auto start = Clock::now();
        trace(part, kTileSizes[size]);
        return std::chrono::duration<double>(Clock::now() - start).count() /
               static_cast<double>(part.receivers.size());
    }

    TileTracer tracer_;
    std::size_t size_ = 1;  ///< index into kTileSizes
    std::size_t pause_ = kLeastPause;
    bool up_ = false;  ///< the last trial was of a larger size
};

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
    parallel_for(
        receivers.size(), kReceiversPerTask,
        [&](std::size_t first, std::size_t last) {
            const Part part{receivers.subspan(first, last - first),
                            std::span(masks.words).subspan(first * words, (last - first) * words),
                            words};
            if (texels_per_tile == kChooseTile) {
                tracers.local().trace(part);
            } else {
                tracers.local().trace(part, texels_per_tile);
            }
        },
        "baking the sun", &progress);
    return masks;
}

}  // namespace gnomon::interval
