#pragma once

#include "interval/path.h"
#include "interval/tree.h"
#include "trace/receiver.h"

#include <cstdint>
#include <memory>
#include <span>

namespace gnomon::interval {

struct Walk;

/// Finds the steps at which receivers are lit, neighbours together. One for each thread: it keeps
/// its memory, and the triangles that cast most of the last shadows, which are tried first.
class TileTracer {
public:
    /// Receivers that are done together at most: the bits of a word.
    static constexpr int kMaxTexels = 64;

    /// The tree and the path must live as long, and have the same frame.
    TileTracer(const Tree& tree, const DayPath& path);
    ~TileTracer();
    TileTracer(TileTracer&&) noexcept;
    TileTracer& operator=(TileTracer&&) noexcept;

    /// The masks of the receivers, one after the other, path.words() words each. A step is lit when
    /// the receiver faces the sun and blocks() is true of no triangle: the result depends on
    /// nothing else, whatever is traced together. Where there is no receiver all is lit.
    /// Fastest where neighbours lie in one plane, close together beside what casts their shadows,
    /// at most `texels_per_tile` of them at a time, which is 1 to kMaxTexels.
    void trace(std::span<const trace::Receiver> receivers, int texels_per_tile,
               std::span<std::uint64_t> masks);

    /// The same of at most kMaxTexels receivers together, in at most `most_s` seconds or a little
    /// more; 0 = whatever it takes. False when that was not enough: then the masks are not done.
    bool trace_within(std::span<const trace::Receiver> receivers, std::span<std::uint64_t> masks,
                      double most_s);

private:
    bool trace_tile(std::span<const trace::Receiver> receivers, std::span<std::uint64_t> masks);

    std::unique_ptr<Walk> walk_;
};

}  // namespace gnomon::interval
