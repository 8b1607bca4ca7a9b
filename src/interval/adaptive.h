#pragma once

#include "interval/tile.h"
#include "interval/tile_size.h"

#include <cstdint>
#include <span>

namespace gnomon::interval {

/// TileTracer with tiles of the size that is fastest where it is. Masks depend on nothing of it.
class AdaptiveTracer {
public:
    AdaptiveTracer(const Tree& tree, const DayPath& path);

    void trace(std::span<const trace::Receiver> receivers, std::span<std::uint64_t> masks);

    /// With tiles of a size whatever they take.
    void trace_by(int texels_per_tile, std::span<const trace::Receiver> receivers,
                  std::span<std::uint64_t> masks) {
        tracer_.trace(receivers, texels_per_tile, masks);
    }

private:
    struct Part;

    void trace_group(Part group);
    bool trace_tiles(Part part);
    double seconds(Part part, int size);
    double larger_seconds(Part group, double s);

    TileTracer tracer_;
    TileSize size_;
    std::size_t words_;
};

}  // namespace gnomon::interval
