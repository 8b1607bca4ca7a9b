#pragma once

#include "lightmap/atlas.h"
#include "lightmap/charts.h"
#include "lightmap/surface.h"

#include <cstdint>
#include <vector>

namespace gnomon::lightmap {

/// Charts that are packed as one rectangle.
struct Block {
    Extent size;
    std::uint32_t first_chart = 0, chart_count = 0;
};

/// An instance laid out in texels, not yet on a page: each chart's place, its triangles' corners
/// and its facets' maps are those within its block.
struct Unwrapped {
    std::vector<Block> blocks;
    std::vector<Chart> charts;
    std::vector<Facet> facets;
    std::vector<PlacedTriangle> triangles;
};

/// `texcoord_set`: that of the mesh which gives the charts, -1 = none.
/// Throws Error{input} when a triangle is larger than a page.
Unwrapped unwrap(const Scene& scene, std::uint32_t instance, int texcoord_set,
                 const Options& options);

/// The linear map that takes a face's corners on the map to those in the world.
Facet facet_of(const Face& face, const Corners& corners_texels);

/// The greatest side of a chart, so that it fits a page with its padding.
double max_chart_m(const Options& options);
ChartLimits chart_limits(const Options& options);

}  // namespace gnomon::lightmap
