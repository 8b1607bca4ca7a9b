// The nearest texel of a chart, exactly, by one axis after the other as in A. Meijster,
// J. Roerdink, W. Hesselink, "A General Algorithm for Computing Distance Transforms in Linear
// Time", 2000; without its lower envelope, as the radius is a few texels.

#include "lightmap/dilate.h"

#include "base/parallel.h"

#include <algorithm>

namespace gnomon::lightmap {

namespace {

constexpr std::size_t kRowsPerTask = 64;

}  // namespace

std::vector<std::uint32_t> dilation_sources(const Atlas& atlas, const Texels& texels,
                                            std::uint32_t page, unsigned radius_texels) {
    const int side = static_cast<int>(atlas.page_sides_texels[page]);
    const int radius = static_cast<int>(radius_texels);
    const std::size_t count = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
    const auto at = [&](int x, int y) { return static_cast<std::size_t>(y) * side + x; };
    std::vector<char> covered(count, 0);
    for (const Texel& texel : texels.texels) {
        if (atlas.charts[atlas.facets[texel.facet].chart].page != page) continue;
        covered[at(texel.x, texel.y)] = 1;
    }

    // Of each column: the row of the nearest chart's texel, the upper of two.
    constexpr int kNoRow = -1;
    std::vector<std::int32_t> nearest_rows(count, kNoRow);
    const auto for_rows = [&](const auto& body) {
        parallel_for(static_cast<std::size_t>(side), kRowsPerTask,
                     [&](std::size_t first, std::size_t last) {
                         for (std::size_t y = first; y < last; ++y) {
                             for (int x = 0; x < side; ++x)
                                 body(x, static_cast<int>(y));
                         }
                     });
    };
    for_rows([&](int x, int y) {
        for (int d = 0; d <= radius && nearest_rows[at(x, y)] == kNoRow; ++d) {
            for (const int row : {y - d, y + d}) {
                if (row < 0 || row >= side || covered[at(x, row)] == 0) continue;
                nearest_rows[at(x, y)] = row;
                break;
            }
        }
    });

    std::vector<std::uint32_t> sources(count, kNoTexel);
    for_rows([&](int x, int y) {
        int least = std::numeric_limits<int>::max();
        for (int column = std::max(x - radius, 0); column <= std::min(x + radius, side - 1);
             ++column) {
            const int row = nearest_rows[at(column, y)];
            if (row == kNoRow) continue;
            const int distance2 = (column - x) * (column - x) + (row - y) * (row - y);
            const auto source = static_cast<std::uint32_t>(at(column, row));
            std::uint32_t& best = sources[at(x, y)];
            if (distance2 < least || (distance2 == least && source < best)) best = source;
            least = std::min(least, distance2);
        }
    });
    return sources;
}

}  // namespace gnomon::lightmap
