#include "interval/adaptive.h"

#include "base/thread_time.h"

#include <algorithm>

namespace gnomon::interval {

namespace {

using trace::Receiver;

/// A square of a Z-order curve, of which all tiles are squares.
constexpr std::size_t kGroup = TileTracer::kMaxTexels;
/// Fewer receivers take too little time to be told from the clock's own.
constexpr std::size_t kLeastTimed = 16;

}  // namespace

/// Some of the receivers, with their masks.
struct AdaptiveTracer::Part {
    std::span<const Receiver> receivers;
    std::span<std::uint64_t> masks;
    std::size_t words;

    std::size_t size() const { return receivers.size(); }
    Part first(std::size_t count) const {
        count = std::min(count, receivers.size());
        return {receivers.first(count), masks.first(count * words), words};
    }
    Part take(std::size_t count) {
        const Part part = first(count);
        receivers = receivers.subspan(part.size());
        masks = masks.subspan(part.size() * words);
        return part;
    }
};

AdaptiveTracer::AdaptiveTracer(const Tree& tree, const DayPath& path)
    : tracer_(tree, path), words_(static_cast<std::size_t>(path.words())) {}

/// Seconds for a receiver.
double AdaptiveTracer::seconds(Part part, int size) {
    const double start = thread_seconds();
    tracer_.trace(part.receivers, size, part.masks);
    return (thread_seconds() - start) / static_cast<double>(part.size());
}

/// False when some tiles were late.
bool AdaptiveTracer::trace_tiles(Part part) {
    bool all_in_time = true;
    while (part.size() > 0) {
        const Part tile = part.first(static_cast<std::size_t>(size_.size()));
        const double most_s = size_.limit_s() * static_cast<double>(tile.size());
        const bool is_limited = size_.size() > 1;
        if (tracer_.trace_within(tile.receivers, tile.masks, is_limited ? most_s : 0.0)) {
            part.take(tile.size());
            continue;
        }
        all_in_time = false;
        size_.was_late(seconds(tile.first(kLeastTimed), 1));
    }
    return all_in_time;
}

void AdaptiveTracer::trace_group(Part group) {
    const TileSize::Trial trial = size_.next_trial();
    double smaller_s = 0.0;
    if (trial == TileSize::Trial::smaller)
        smaller_s = seconds(group.first(kLeastTimed), size_.smaller_size());
    const double start = thread_seconds();
    if (!trace_tiles(group)) return;  // the size may be another
    const double s = (thread_seconds() - start) / static_cast<double>(group.size());
    size_.took(s);
    if (trial == TileSize::Trial::smaller) {
        size_.tried(trial, smaller_s, s);
    } else if (trial == TileSize::Trial::larger) {
        size_.tried(trial, larger_seconds(group, s), s);
    }
}

/// Of a receiver in a larger tile, or so long that `s` is less.
double AdaptiveTracer::larger_seconds(Part group, double s) {
    const auto size = static_cast<std::size_t>(size_.larger_size());
    const Part tried = group.first(std::max(size, kLeastTimed));
    const double start = thread_seconds();
    for (Part rest = tried; rest.size() > 0;) {
        const Part tile = rest.take(size);
        const double most_s = s * static_cast<double>(tile.size());
        if (!tracer_.trace_within(tile.receivers, tile.masks, most_s)) return 2.0 * s;
    }
    return (thread_seconds() - start) / static_cast<double>(tried.size());
}

void AdaptiveTracer::trace(std::span<const Receiver> receivers, std::span<std::uint64_t> masks) {
    Part rest{receivers, masks, words_};
    while (rest.size() > 0)
        trace_group(rest.take(kGroup));
}

}  // namespace gnomon::interval
