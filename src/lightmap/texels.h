#pragma once

#include "lightmap/atlas.h"

#include <cstdint>
#include <vector>

namespace gnomon::lightmap {

/// A texel that the surface touches.
struct Texel {
    DVec3 point_ws{0.0};         ///< on its triangle: at the texel's centre if that lies on its
                                 ///< chart, else the chart's point nearest to it on the map
    std::uint32_t triangle = 0;  ///< index into Atlas::triangles
    std::uint32_t facet = 0;     ///< index into Atlas::facets: plane, normal, chart
    std::uint16_t x = 0, y = 0;  ///< of its page
    bool clamped = false;        ///< its centre lies off the chart
};

/// Up to 64 neighbouring texels of one facet: those in a square of 8 x 8.
struct Tile {
    std::uint32_t facet = 0;        ///< its u_ws and v_ws are the tile's axes
    std::uint32_t texel_count = 0;  ///< in [1, kMaxTileTexels]
    std::uint64_t first_texel = 0;  ///< of Texels::texels
    std::uint16_t x = 0, y = 0;     ///< the least texel of the rectangle around them
    std::uint16_t width = 0, height = 0;
    DVec3 center_ws{0.0};  ///< the rectangle's middle, in the facet's plane
};

inline constexpr unsigned kTileSide = 8;
inline constexpr unsigned kMaxTileTexels = kTileSide * kTileSide;

struct Texels {
    std::vector<Texel> texels;  ///< by chart, facet, tile; then by y and x
    std::vector<Tile> tiles;    ///< each texel is in one
};

/// The texels that the atlas's charts touch, each once: no two charts touch the same one. Holes by
/// alpha are not cut out. The same for any number of threads. Throws Error{cancelled}.
Texels make_texels(const Scene& scene, const Atlas& atlas, Progress& progress);
Texels make_texels(const Scene& scene, const Atlas& atlas);

}  // namespace gnomon::lightmap
