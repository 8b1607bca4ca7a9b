#include <gnomon/bake.h>

#include "bake/baked_texels.h"
#include "bake/buried.h"
#include "bake/interval_codes.h"
#include "bake/lit_times.h"
#include "bake/texel_receivers.h"
#include "base/check.h"
#include "lightmap/dilate.h"

#include <algorithm>
#include <utility>

namespace gnomon {

namespace {

constexpr std::size_t kIntervalsPerPair = 4;
constexpr int kMostPairs = 16;

void check(const BakePath& path, const BakeOptions& options) {
    const int most_steps = options.bits == BakeBits::eight ? 255 : 1023;
    if (path.to_light_ws.empty()) fail_input("bake: the light is never up: {}", path.summary);
    if (path.steps() > most_steps) {
        fail_input("bake: {} steps; with {} bits there can be at most {}", path.steps(),
                   static_cast<int>(options.bits), most_steps);
    }
    if (options.most_pairs < 1 || options.most_pairs > kMostPairs) {
        fail_input("bake: {} pairs of textures; there can be 1 to {}", options.most_pairs,
                   kMostPairs);
    }
}

/// When each texel sees the light, one after the other.
struct TexelIntervals {
    std::vector<bake::LitTimes> texels;  ///< `most` intervals of each, at most
    std::size_t most = 0;
    std::vector<bool> buried;  ///< of each texel: it is inside of a solid
    BakeReport report;
};

/// Closes gaps until the texels have at most `allowed` intervals each, and counts.
TexelIntervals limited(std::vector<bake::LitTimes> times, int path_codes, std::size_t allowed) {
    TexelIntervals result{.texels = std::move(times), .buried = {}, .report = {}};
    BakeReport& report = result.report;
    std::uint64_t closed = 0;
    std::size_t most = 0;
    for (bake::LitTimes& texel : result.texels) {
        report.lit_texels += texel.empty() ? 0 : 1;
        report.intervals += texel.size();
        most = std::max(most, texel.size());
        if (texel.size() > allowed) report.closed_gaps += texel.size() - allowed;
        closed += bake::close_gaps(texel, allowed);
    }
    report.most_intervals = static_cast<int>(most);
    result.most = std::min(most, allowed);
    report.texels = result.texels.size();
    const double all = static_cast<double>(report.texels) * path_codes;
    report.closed_share = all > 0.0 ? static_cast<double>(closed) / all : 0.0;
    return result;
}

/// Only what never sees the light can be buried.
void find_buried(const Scene& scene, const BakePath& path,
                 std::span<const trace::Receiver> receivers, TexelIntervals& intervals,
                 Progress& progress) {
    std::vector<std::uint32_t> dark;
    for (std::uint32_t i = 0; i < intervals.texels.size(); ++i) {
        if (intervals.texels[i].empty()) dark.push_back(i);
    }
    const std::vector<bool> found =
        bake::are_buried(scene, receivers, dark, path.to_light_ws, progress);
    intervals.buried.assign(intervals.texels.size(), false);
    for (std::size_t i = 0; i < dark.size(); ++i) {
        intervals.buried[dark[i]] = found[i];
        intervals.report.buried_texels += found[i] ? 1 : 0;
    }
}

IntervalPage blank_page(unsigned side, int pairs) {
    IntervalPage page{.side_texels = side, .pairs = pairs, .rises = {}, .falls = {}};
    const std::size_t values = std::size_t{side} * side * kIntervalsPerPair * pairs;
    page.rises.assign(values, IntervalPage::kNoRise);
    page.falls.assign(values, 0);
    return page;
}

std::size_t value_index(const IntervalPage& page, std::size_t texel, std::size_t interval) {
    const std::size_t per_pair = std::size_t{page.side_texels} * page.side_texels;
    return ((interval / kIntervalsPerPair) * per_pair + texel) * kIntervalsPerPair +
           interval % kIntervalsPerPair;
}

void put(IntervalPage& page, std::size_t texel, const bake::LitTimes& intervals) {
    for (std::size_t i = 0; i < intervals.size(); ++i) {
        page.rises[value_index(page, texel, i)] = intervals[i].rise;
        page.falls[value_index(page, texel, i)] = intervals[i].fall;
    }
}

/// Gives places of buried texels the first neighbour that is not.
void move_out_buried(std::vector<std::uint32_t>& owner, unsigned side,
                     const std::vector<bool>& buried) {
    const std::vector<std::uint32_t> before = owner;
    const auto is_open = [&](std::uint32_t texel) {
        return texel != lightmap::kNoTexel && !buried[texel];
    };
    const auto last = static_cast<int>(side) - 1;
    for (std::size_t place = 0; place < owner.size(); ++place) {
        if (before[place] == lightmap::kNoTexel || is_open(before[place])) continue;
        const auto x = static_cast<int>(place % side);
        const auto y = static_cast<int>(place / side);
        for (int i = 0; i < 9; ++i) {
            const int u = std::clamp(x + i % 3 - 1, 0, last);
            const int v = std::clamp(y + i / 3 - 1, 0, last);
            const std::uint32_t other =
                before[static_cast<std::size_t>(v) * side + static_cast<std::size_t>(u)];
            if (!is_open(other)) continue;
            owner[place] = other;
            break;
        }
    }
}

std::vector<IntervalPage> pages_of(const lightmap::Atlas& atlas, const lightmap::Texels& texels,
                                   const TexelIntervals& intervals) {
    constexpr std::uint32_t kNone = lightmap::kNoTexel;
    std::vector<IntervalPage> pages;
    std::vector<std::vector<std::uint32_t>> owner;  // the texel of each place
    const std::size_t most = std::max<std::size_t>(intervals.most, 1);
    const int pairs = static_cast<int>((most + kIntervalsPerPair - 1) / kIntervalsPerPair);
    for (const unsigned side : atlas.page_sides_texels) {
        pages.push_back(blank_page(side, pairs));
        owner.emplace_back(std::size_t{side} * side, kNone);
    }
    for (std::uint32_t i = 0; i < texels.texels.size(); ++i) {
        const lightmap::Texel& texel = texels.texels[i];
        const std::uint32_t page = atlas.charts[atlas.facets[texel.facet].chart].page;
        owner[page][std::size_t{texel.y} * pages[page].side_texels + texel.x] = i;
    }
    for (std::uint32_t p = 0; p < pages.size(); ++p) {
        move_out_buried(owner[p], pages[p].side_texels, intervals.buried);
        const std::vector<std::uint32_t> sources =
            lightmap::dilation_sources(atlas, texels, p, atlas.options.padding_texels);
        lightmap::dilate(std::span(owner[p]), sources);
        for (std::size_t place = 0; place < owner[p].size(); ++place) {
            if (owner[p][place] != kNone) put(pages[p], place, intervals.texels[owner[p][place]]);
        }
    }
    return pages;
}

}  // namespace

namespace bake {

BakedTexels baked_texels(const Scene& scene, const BakePath& path, const BakeOptions& options,
                         Progress& progress) {
    check(path, options);
    BakedTexels baked;
    baked.atlas = lightmap::make_atlas(
        scene,
        {.texel_size_m = options.texel_size_m, .memory_limit_bytes = options.memory_limit_bytes},
        progress);
    const lightmap::Texels texels = lightmap::make_texels(scene, baked.atlas, progress);
    const std::vector<trace::Receiver> receivers = texel_receivers(baked.atlas, texels);
    TexelIntervals intervals =
        limited(lit_times(scene, path, options, receivers, progress),
                path.steps() * codes_per_step(options.bits),
                kIntervalsPerPair * static_cast<std::size_t>(options.most_pairs));
    find_buried(scene, path, receivers, intervals, progress);
    baked.pages = pages_of(baked.atlas, texels, intervals);
    baked.report = std::move(intervals.report);
    baked.report.warnings = baked.atlas.warnings;
    return baked;
}

}  // namespace bake

IntervalBake bake_intervals(const Scene& scene, const BakePath& path, const BakeOptions& options,
                            Progress& progress) {
    bake::BakedTexels baked = bake::baked_texels(scene, path, options, progress);
    IntervalBake result;
    result.scene = lightmap::with_lightmap(scene, baked.atlas);
    result.mesh_pages = lightmap::lightmapped_pages(scene, baked.atlas);
    result.path = path;
    result.bits = options.bits;
    result.pages = std::move(baked.pages);
    result.report = std::move(baked.report);
    return result;
}

double interval_visibility(const IntervalPage& page, unsigned x, unsigned y,
                           const LightWindow& window) {
    const std::size_t texel = std::size_t{y} * page.side_texels + x;
    const double codes = window.codes_per_step;
    double seen = 0.0;
    for (std::size_t i = 0; i < kIntervalsPerPair * static_cast<std::size_t>(page.pairs); ++i) {
        const std::size_t at = value_index(page, texel, i);
        seen += bake::seen_part(page.rises[at], page.falls[at], window.at_step * codes,
                                window.width_steps * codes, window.even);
    }
    return std::min(seen, 1.0);
}

}  // namespace gnomon
