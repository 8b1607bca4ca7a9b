#pragma once

#include <gnomon/bake.h>

#include "bake/sample_place.h"
#include "bake/texel_edges.h"
#include "lightmap/atlas.h"
#include "trace/receiver.h"

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace gnomon::bake {

/// A cell is the square between the centres of four texels. Those whose texels do not have the same
/// edges of shadows are fine: they have samples of their own, in a grid that reaches their corners.
struct FineCells {
    int parts = 1;  ///< along each side of a cell
    /// The first sample of each fine cell, by its chart and its first texel's place: see find().
    std::unordered_map<std::uint64_t, std::uint32_t> first_samples;
    SamplePlaces places;   ///< of samples; (parts + 1)² for a cell, rows from the top
    IntervalPage samples;  ///< texel i of it is sample i

    std::size_t samples_per_cell() const {
        return static_cast<std::size_t>(parts + 1) * static_cast<std::size_t>(parts + 1);
    }
    /// The cell whose first texel is (x, y) of the chart's page.
    std::optional<std::uint32_t> find(std::uint32_t chart, int x, int y) const;
};

/// The texels of the cell whose first one is (x, y) of the chart's page: past the chart's rectangle
/// the nearest ones in it.
FourTexels texels_around(const lightmap::Chart& chart, std::span<const IntervalPage> pages, int x,
                         int y);

/// Cells that are to be fine, without what their samples see, and where those are: on the surface
/// at or near their places on the page. There are at most two for each cell of the atlas, and fewer
/// parts than wanted, or none, where that would be more.
struct FineSamples {
    FineCells cells;
    std::vector<trace::Receiver> receivers;
};
FineSamples fine_samples(const Scene& scene, const lightmap::Atlas& atlas,
                         std::span<const IntervalPage> pages, int parts, double path_codes);

/// For each sample the one that it repeats: itself, or if it is buried the nearest one of its cell
/// that is not, if there is one.
std::vector<std::uint32_t> open_samples(const FineCells& cells, const std::vector<bool>& buried);

}  // namespace gnomon::bake
