#include "lightmap/atlas.h"

#include "base/parallel.h"
#include "lightmap/estimate.h"
#include "lightmap/packing.h"
#include "lightmap/texcoords.h"
#include "lightmap/unwrap.h"

#include <utility>

namespace gnomon::lightmap {

namespace {

/// Moves an instance's charts from their blocks to their pages and adds them to the atlas.
class Collector {
public:
    Collector(const Packing& packing, Atlas& atlas)
        : next_(packing.placements.begin()), atlas_(atlas) {}

    void add(Unwrapped part) {
        const auto facets_before = static_cast<std::uint32_t>(atlas_.facets.size());
        for (const Block& block : part.blocks) {
            const Placement place = *next_++;
            for (std::uint32_t c = 0; c < block.chart_count; ++c)
                move(part, part.charts[block.first_chart + c], place);
        }
        const auto charts_before = static_cast<std::uint32_t>(atlas_.charts.size());
        const auto triangles_before = static_cast<std::uint32_t>(atlas_.triangles.size());
        for (Chart& chart : part.charts) {
            chart.first_facet += facets_before;
            chart.first_triangle += triangles_before;
            atlas_.charts.push_back(chart);
        }
        for (Facet& facet : part.facets) {
            facet.chart += charts_before;
            facet.first_triangle += triangles_before;
            atlas_.facets.push_back(facet);
        }
        for (PlacedTriangle& triangle : part.triangles) {
            triangle.facet += facets_before;
            atlas_.triangles.push_back(triangle);
        }
    }

private:
    static void move(Unwrapped& part, Chart& chart, Placement place) {
        const dvec2 by(place.x, place.y);
        chart.page = place.page;
        chart.x += place.x;
        chart.y += place.y;
        for (std::uint32_t i = 0; i < chart.triangle_count; ++i) {
            for (dvec2& corner : part.triangles[chart.first_triangle + i].corners_texels)
                corner += by;
        }
        for (std::uint32_t i = 0; i < chart.facet_count; ++i) {
            Facet& facet = part.facets[chart.first_facet + i];
            facet.origin_ws -= by.x * facet.u_ws + by.y * facet.v_ws;
        }
    }

    std::vector<Placement>::const_iterator next_;
    Atlas& atlas_;
};

}  // namespace

Atlas make_atlas(const Scene& scene, const Options& options, Progress& progress) {
    require_fit(scene, options, progress);
    Atlas atlas{.options = options};
    const std::vector<int> sets = choose_texcoords(scene, options, progress, atlas.warnings);
    std::vector<Unwrapped> parts(scene.instances().size());
    parallel_for(
        parts.size(), 1,
        [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                parts[i] = unwrap(scene, static_cast<std::uint32_t>(i),
                                  sets[scene.instances()[i].mesh], options);
            }
        },
        "laying out surfaces", &progress);
    std::vector<Extent> sizes;
    for (const Unwrapped& part : parts) {
        for (const Block& block : part.blocks)
            sizes.push_back(block.size);
    }
    throw_if_cancelled(progress, "packing charts");
    Packing packing = pack(sizes, options.padding_texels, options.max_page_texels);
    Collector collector(packing, atlas);
    for (Unwrapped& part : parts)
        collector.add(std::exchange(part, {}));
    atlas.page_sides_texels = std::move(packing.page_sides);
    return atlas;
}

Atlas make_atlas(const Scene& scene, const Options& options) {
    Progress silent;
    return make_atlas(scene, options, silent);
}

}  // namespace gnomon::lightmap
