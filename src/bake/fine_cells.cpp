// Where a shadow's edge ends, or lies along the light's path, neighbouring texels differ and no
// time tells where between them it is: only samples there do. Our own, as adaptive shadow maps
// refine texels at edges: R. Fernando, S. Fernandez, K. Bala, D. Greenberg, "Adaptive Shadow Maps",
// SIGGRAPH 2001.

#include "bake/fine_cells.h"

#include "bake/texel_receivers.h"
#include "lightmap/coverage.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace gnomon::bake {

namespace {

using lightmap::dvec2;

/// Samples keep this from borders of the surface, where others meet it and rays run along them.
constexpr double kFromBorder_texels = 0.1;

/// For each cell, fine or not: under trees nearly all are fine, and have fewer parts instead.
constexpr std::size_t kMostSamples = 2;

std::uint64_t key_of(std::uint32_t chart, int x, int y) {
    // Cells begin at texel -1; a page has less than 2^16 texels along its side.
    return std::uint64_t{chart} << 32 | static_cast<std::uint64_t>(y + 1) << 16 |
           static_cast<std::uint64_t>(x + 1);
}

/// A cell with the triangles of its chart that touch it.
struct Cell {
    int x = 0, y = 0;
    std::vector<std::uint32_t> triangles;  ///< of the atlas
};

/// The triangles of the chart's cells, in order of rows.
std::vector<Cell> touched_cells(const lightmap::Atlas& atlas, const lightmap::Chart& chart) {
    const int first_x = static_cast<int>(chart.x) - 1;
    const int first_y = static_cast<int>(chart.y) - 1;
    const int width = static_cast<int>(chart.size.width) + 1;
    const int height = static_cast<int>(chart.size.height) + 1;
    std::vector<Cell> cells(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (std::uint32_t t = 0; t < chart.triangle_count; ++t) {
        lightmap::Corners corners = atlas.triangles[chart.first_triangle + t].corners_texels;
        for (dvec2& corner : corners)
            corner -= 0.5;  // a cell begins at a texel's centre
        lightmap::for_touched(corners, [&](int y, int x_begin, int x_end) {
            if (y < first_y || y >= first_y + height) return;
            for (int x = std::max(x_begin, first_x); x < std::min(x_end, first_x + width); ++x) {
                Cell& cell = cells[static_cast<std::size_t>((y - first_y) * width + (x - first_x))];
                cell.x = x;
                cell.y = y;
                cell.triangles.push_back(chart.first_triangle + t);
            }
        });
    }
    std::erase_if(cells, [](const Cell& cell) { return cell.triangles.empty(); });
    return cells;
}

/// A point of a cell's triangles.
struct OnSurface {
    dvec2 place{0.0};
    std::uint32_t triangle = 0;
};

/// The one at a place of the page, or if that is beside them nearly the nearest one.
OnSurface nearest_on(const lightmap::Atlas& atlas, const Cell& cell, dvec2 place) {
    OnSurface best;
    dvec2 middle(0.0);
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t triangle : cell.triangles) {
        const lightmap::Corners& corners = atlas.triangles[triangle].corners_texels;
        const dvec2 nearest =
            lightmap::weighted(corners, lightmap::nearest_weights(corners, place));
        const double apart = glm::distance(nearest, place);
        if (apart >= least) continue;
        least = apart;
        best = {nearest, triangle};
        middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    }
    if (least > lightmap::kBorder_texels) {
        const double way = glm::distance(best.place, middle);
        best.place += (middle - best.place) * std::min(1.0, kFromBorder_texels / way);
    }
    return best;
}

void add_samples(const Scene& scene, const lightmap::Atlas& atlas, const Cell& cell,
                 FineSamples& out) {
    const int parts = out.cells.parts;
    for (int row = 0; row <= parts; ++row) {
        for (int column = 0; column <= parts; ++column) {
            const dvec2 place = dvec2(cell.x, cell.y) + 0.5 + dvec2(column, row) / double(parts);
            const OnSurface found = nearest_on(atlas, cell, place);
            const lightmap::Corners& corners = atlas.triangles[found.triangle].corners_texels;
            out.cells.places.push_back(coded_place(found.place - place));
            out.receivers.push_back(receiver_on(scene, atlas, found.triangle,
                                                lightmap::nearest_weights(corners, found.place)));
        }
    }
}

}  // namespace

std::optional<std::uint32_t> FineCells::find(std::uint32_t chart, int x, int y) const {
    const auto found = first_samples.find(key_of(chart, x, y));
    if (found == first_samples.end()) return std::nullopt;
    return found->second;
}

FourTexels texels_around(const lightmap::Chart& chart, std::span<const IntervalPage> pages, int x,
                         int y) {
    const std::size_t side = pages[chart.page].side_texels;
    const auto within = [](int place, unsigned first, unsigned count) {
        const auto begin = static_cast<int>(first);
        return static_cast<std::size_t>(
            std::clamp(place, begin, begin + static_cast<int>(count) - 1));
    };
    FourTexels texels{};
    for (int i = 0; i < 4; ++i) {
        texels[static_cast<std::size_t>(i)] = within(y + i / 2, chart.y, chart.size.height) * side +
                                              within(x + i % 2, chart.x, chart.size.width);
    }
    return texels;
}

FineSamples fine_samples(const Scene& scene, const lightmap::Atlas& atlas,
                         std::span<const IntervalPage> pages, int parts, double path_codes) {
    std::vector<std::pair<std::uint32_t, Cell>> fine;  // with their charts
    std::size_t all = 0;
    for (std::uint32_t c = 0; c < atlas.charts.size(); ++c) {
        const lightmap::Chart& chart = atlas.charts[c];
        for (Cell& cell : touched_cells(atlas, chart)) {
            ++all;
            const FourTexels texels = texels_around(chart, pages, cell.x, cell.y);
            if (have_same_edges(pages[chart.page], texels, path_codes)) continue;
            fine.emplace_back(c, std::move(cell));
        }
    }
    FineSamples result;
    result.cells.parts = parts;
    const auto samples = [&] { return fine.size() * result.cells.samples_per_cell(); };
    while (result.cells.parts > 1 && samples() > kMostSamples * all)
        --result.cells.parts;
    if (result.cells.parts == 1) return result;
    for (const auto& [chart, cell] : fine) {
        result.cells.first_samples.emplace(key_of(chart, cell.x, cell.y),
                                           static_cast<std::uint32_t>(result.receivers.size()));
        add_samples(scene, atlas, cell, result);
    }
    return result;
}

std::vector<std::uint32_t> open_samples(const FineCells& cells, const std::vector<bool>& buried) {
    std::vector<std::uint32_t> result(buried.size());
    const std::size_t side = static_cast<std::size_t>(cells.parts) + 1;
    for (std::size_t i = 0; i < buried.size(); ++i) {
        result[i] = static_cast<std::uint32_t>(i);
        if (!buried[i]) continue;
        const std::size_t first = i - i % cells.samples_per_cell();
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t other = first; other < first + cells.samples_per_cell(); ++other) {
            if (buried[other]) continue;
            const dvec2 apart = dvec2((other - first) % side, (other - first) / side) -
                                dvec2((i - first) % side, (i - first) / side);
            if (glm::length(apart) >= least) continue;
            least = glm::length(apart);
            result[i] = static_cast<std::uint32_t>(other);
        }
    }
    return result;
}

}  // namespace gnomon::bake
