// Texels of charts: each texel's centre is looked up in its chart's triangles; those that the chart
// touches beside its border take its nearest point.

#include "lightmap/texels.h"

#include "base/parallel.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <span>
#include <tuple>

namespace gnomon::lightmap {

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Which triangle each texel of a chart's rectangle belongs to.
class Owners {
public:
    Owners(const Atlas& atlas, const Chart& chart)
        : atlas_(atlas),
          chart_(chart),
          triangles_(std::size_t{chart.size.width} * chart.size.height, kNone) {
        // The first triangle keeps a centre, should rounding give it to two.
        for_triangles([&](std::uint32_t t, const Corners& corners) {
            for_centres(corners, [&](int y, int begin, int end) {
                for_row(y, begin, end, [&](std::size_t i, dvec2) {
                    if (triangles_[i] == kNone) triangles_[i] = t;
                });
            });
        });
        distances_.assign(triangles_.size(), std::numeric_limits<float>::infinity());
        for (std::size_t i = 0; i < triangles_.size(); ++i) {
            if (triangles_[i] != kNone) distances_[i] = -1.0f;
        }
        for_triangles([&](std::uint32_t t, const Corners& corners) {
            for_touched(corners, [&](int y, int begin, int end) {
                for_row(y, begin, end, [&](std::size_t i, dvec2 center) {
                    if (distances_[i] < 0.0f) return;
                    const dvec2 nearest = weighted(corners, nearest_weights(corners, center));
                    const auto distance = static_cast<float>(glm::distance(nearest, center));
                    if (distance >= distances_[i]) return;
                    distances_[i] = distance;
                    triangles_[i] = t;
                });
            });
        });
    }

    /// Calls visit(texel's x, y on the page, triangle, clamped).
    template <typename Visit>
    void for_texels(const Visit& visit) const {
        std::size_t i = 0;
        for (unsigned y = 0; y < chart_.size.height; ++y) {
            for (unsigned x = 0; x < chart_.size.width; ++x, ++i) {
                if (triangles_[i] == kNone) continue;
                visit(chart_.x + x, chart_.y + y, triangles_[i], distances_[i] >= 0.0f);
            }
        }
    }

    std::size_t count() const {
        return triangles_.size() - static_cast<std::size_t>(std::ranges::count(triangles_, kNone));
    }

private:
    template <typename Visit>
    void for_triangles(const Visit& visit) const {
        for (std::uint32_t i = 0; i < chart_.triangle_count; ++i) {
            const std::uint32_t t = chart_.first_triangle + i;
            visit(t, atlas_.triangles[t].corners_texels);
        }
    }

    template <typename Visit>
    void for_row(int y, int begin, int end, const Visit& visit) const {
        const int row = y - static_cast<int>(chart_.y);
        if (row < 0 || row >= static_cast<int>(chart_.size.height)) return;
        const int left = static_cast<int>(chart_.x);
        const int right = left + static_cast<int>(chart_.size.width);
        for (int x = std::max(begin, left); x < std::min(end, right); ++x) {
            visit(static_cast<std::size_t>(row) * chart_.size.width +
                      static_cast<std::size_t>(x - left),
                  dvec2(x + 0.5, y + 0.5));
        }
    }

    const Atlas& atlas_;
    const Chart& chart_;
    std::vector<std::uint32_t> triangles_;  // of Atlas::triangles
    std::vector<float> distances_;          // of the clamped; < 0 where the centre is covered
};

class ChartTexels {
public:
    ChartTexels(const Scene& scene, const Atlas& atlas) : scene_(scene), atlas_(atlas) {}

    /// Fills the chart's part of the texels, the first of which has the number `first`.
    std::vector<Tile> make(const Chart& chart, std::span<Texel> out, std::uint64_t first) const {
        std::size_t count = 0;
        Owners(atlas_, chart)
            .for_texels([&](unsigned x, unsigned y, std::uint32_t triangle, bool clamped) {
                out[count++] = texel(chart, x, y, triangle, clamped);
            });
        const auto tile_of = [&](const Texel& t) {
            return std::tuple(t.facet, (t.y - chart.y) / kTileSide, (t.x - chart.x) / kTileSide);
        };
        std::ranges::sort(out, [&](const Texel& a, const Texel& b) {
            return std::tuple(tile_of(a), a.y, a.x) < std::tuple(tile_of(b), b.y, b.x);
        });
        std::vector<Tile> tiles;
        for (std::size_t begin = 0; begin < out.size();) {
            std::size_t end = begin + 1;
            while (end < out.size() && tile_of(out[end]) == tile_of(out[begin]))
                ++end;
            tiles.push_back(tile(out.subspan(begin, end - begin), first + begin));
            begin = end;
        }
        return tiles;
    }

private:
    Texel texel(const Chart& chart, unsigned x, unsigned y, std::uint32_t index,
                bool clamped) const {
        const PlacedTriangle& placed = atlas_.triangles[index];
        const Instance& instance = scene_.instances()[chart.instance];
        const Mesh& mesh = scene_.meshes()[instance.mesh];
        const auto weights = nearest_weights(placed.corners_texels, dvec2(x + 0.5, y + 0.5));
        DVec3 point(0.0);
        for (int i = 0; i < 3; ++i) {
            point += weights[static_cast<std::size_t>(i)] *
                     DVec3(mesh.positions[mesh.triangles[placed.triangle][i]]);
        }
        return {.point_ws = DVec3(glm::dmat4(instance.world_from_local) * glm::dvec4(point, 1.0)),
                .triangle = index,
                .facet = placed.facet,
                .x = static_cast<std::uint16_t>(x),
                .y = static_cast<std::uint16_t>(y),
                .clamped = clamped};
    }

    Tile tile(std::span<const Texel> texels, std::uint64_t first) const {
        const auto [left, right] = std::ranges::minmax(texels, {}, &Texel::x);
        Tile tile{.facet = texels.front().facet,
                  .texel_count = static_cast<std::uint32_t>(texels.size()),
                  .first_texel = first,
                  .x = left.x,
                  .y = texels.front().y};
        tile.width = static_cast<std::uint16_t>(right.x + 1 - left.x);
        tile.height = static_cast<std::uint16_t>(texels.back().y + 1 - tile.y);
        tile.center_ws = atlas_.facets[tile.facet].point_ws(
            {tile.x + 0.5 * tile.width, tile.y + 0.5 * tile.height});
        return tile;
    }

    const Scene& scene_;
    const Atlas& atlas_;
};

}  // namespace

Texels make_texels(const Scene& scene, const Atlas& atlas, Progress& progress) {
    const std::size_t count = atlas.charts.size();
    std::vector<std::uint64_t> firsts(count + 1, 0);
    const auto for_charts = [&](std::string_view task, const auto& body) {
        parallel_for(
            count, 1,
            [&](std::size_t first, std::size_t last) {
                for (std::size_t c = first; c < last; ++c)
                    body(c);
            },
            task, &progress);
    };
    // Twice, so that the texels are allocated once.
    for_charts("counting texels",
               [&](std::size_t c) { firsts[c + 1] = Owners(atlas, atlas.charts[c]).count(); });
    for (std::size_t c = 0; c < count; ++c)
        firsts[c + 1] += firsts[c];
    Texels result;
    result.texels.resize(firsts[count]);
    std::vector<std::vector<Tile>> tiles(count);
    const ChartTexels maker(scene, atlas);
    for_charts("placing texels", [&](std::size_t c) {
        const std::span<Texel> part(result.texels.data() + firsts[c], firsts[c + 1] - firsts[c]);
        tiles[c] = maker.make(atlas.charts[c], part, firsts[c]);
    });
    for (const std::vector<Tile>& part : tiles)
        result.tiles.insert(result.tiles.end(), part.begin(), part.end());
    return result;
}

Texels make_texels(const Scene& scene, const Atlas& atlas) {
    Progress silent;
    return make_texels(scene, atlas, silent);
}

}  // namespace gnomon::lightmap
