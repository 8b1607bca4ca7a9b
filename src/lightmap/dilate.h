#pragma once

#include "lightmap/texels.h"

#include <cassert>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace gnomon::lightmap {

/// The texels of no chart near which there is none.
inline constexpr std::uint32_t kNoTexel = std::numeric_limits<std::uint32_t>::max();

/// For each texel of a page, row by row, the number on the page of the texel of a chart that gives
/// it its value: its own if a chart touches it, else the nearest one that is at most
/// `radius_texels` away along each axis, else kNoTexel. Of equally near ones the first by row and
/// column. With the atlas's padding as radius, look-ups anywhere on a chart find values all around
/// it.
std::vector<std::uint32_t> dilation_sources(const Atlas& atlas, const Texels& texels,
                                            std::uint32_t page, unsigned radius_texels);

/// Gives the texels around charts the values of their sources. `page` has a value per texel.
template <typename T>
void dilate(std::span<T> page, std::span<const std::uint32_t> sources) {
    assert(page.size() == sources.size());
    for (std::size_t i = 0; i < page.size(); ++i) {
        // Sources are texels of charts, which keep their values: the order does not matter.
        if (sources[i] != kNoTexel && sources[i] != i) page[i] = page[sources[i]];
    }
}

}  // namespace gnomon::lightmap
