#include <gnomon/bake.h>

#include "bake/baked_texels.h"
#include "bake/buried.h"
#include "bake/interval_codes.h"
#include "bake/light_day.h"
#include "bake/open_points.h"
#include "bake/texel_receivers.h"
#include "base/check.h"
#include "lightmap/dilate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gnomon {

namespace {

constexpr std::size_t kIntervalsPerPair = IntervalPage::kIntervalsPerPair;

void check(const BakePath& path, const BakeOptions& options) {
    if (path.to_light_ws.empty()) fail_input("bake: the light is never up: {}", path.summary);
    if (path.steps() > most_steps(options.bits)) {
        fail_input("bake: {} steps; with {} bits there can be at most {}", path.steps(),
                   static_cast<int>(options.bits), most_steps(options.bits));
    }
    if (options.most_pairs < 1 || options.most_pairs > IntervalPage::kMostPairs) {
        fail_input("bake: {} pairs of textures; there can be 1 to {}", options.most_pairs,
                   IntervalPage::kMostPairs);
    }
}

/// When each texel sees the light, one after the other.
struct TexelIntervals {
    std::vector<bake::LitTimes> texels;  ///< `most` intervals of each, at most
    std::size_t most = 0;
    BakeReport report;
};

/// Closes gaps until the texels have at most `allowed` intervals each, and counts.
TexelIntervals limited(std::vector<bake::LitTimes> times, int path_codes, std::size_t allowed) {
    TexelIntervals result{.texels = std::move(times), .report = {}};
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

/// Adds what the finer samples of texels lost to what the texels did.
void add_closed(const BakeReport& samples, BakeReport& texels) {
    const double all = static_cast<double>(texels.texels + samples.texels);
    texels.closed_gaps += samples.closed_gaps;
    texels.closed_share = (texels.closed_share * static_cast<double>(texels.texels) +
                           samples.closed_share * static_cast<double>(samples.texels)) /
                          std::max(all, 1.0);
}

/// What is under a ground can see the light past its edge when that is lowest, for this part of the
/// path at most.
constexpr double kMostLitBelow = 0.02;

/// Only what never sees the light, or hardly ever, can be buried.
std::vector<bool> find_buried(const bake::LightDay& light, const bake::TexelDay& day,
                              Progress& progress) {
    const int most = static_cast<int>(kMostLitBelow * light.codes());
    std::vector<std::uint32_t> dark;
    for (std::uint32_t i = 0; i < day.receivers.size(); ++i) {
        int lit = 0;
        for (const bake::CodedInterval& interval : day.times[i])
            lit += interval.fall - interval.rise;
        if (lit <= most) dark.push_back(i);
    }
    const std::vector<bool> found =
        bake::are_buried(light.scene(), day.receivers, dark, light.path().to_light_ws, progress);
    std::vector<bool> buried(day.receivers.size(), false);
    for (std::size_t i = 0; i < dark.size(); ++i)
        buried[dark[i]] = found[i];
    return buried;
}

IntervalPage blank_page(unsigned side, int pairs) {
    IntervalPage page{.side_texels = side, .pairs = pairs, .rises = {}, .falls = {}};
    const std::size_t values = std::size_t{side} * side * kIntervalsPerPair * pairs;
    page.rises.assign(values, IntervalPage::kNoRise);
    page.falls.assign(values, 0);
    return page;
}

void put(IntervalPage& page, std::size_t texel, const bake::LitTimes& intervals) {
    for (std::size_t i = 0; i < intervals.size(); ++i) {
        const std::size_t at = bake::value_index(page, texel, i);
        page.rises[at] = intervals[i].rise;
        page.falls[at] = intervals[i].fall;
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

int pairs_for(const TexelIntervals& intervals) {
    const std::size_t most = std::max<std::size_t>(intervals.most, 1);
    return static_cast<int>((most + kIntervalsPerPair - 1) / kIntervalsPerPair);
}

/// Which texel each place of a page repeats.
using Owners = std::vector<std::uint32_t>;

std::vector<Owners> owners_of(const lightmap::Atlas& atlas, const lightmap::Texels& texels,
                              const std::vector<bool>& buried) {
    std::vector<Owners> owners;
    for (const unsigned side : atlas.page_sides_texels)
        owners.emplace_back(std::size_t{side} * side, lightmap::kNoTexel);
    for (std::uint32_t i = 0; i < texels.texels.size(); ++i) {
        const lightmap::Texel& texel = texels.texels[i];
        const std::uint32_t page = atlas.charts[atlas.facets[texel.facet].chart].page;
        owners[page][std::size_t{texel.y} * atlas.page_sides_texels[page] + texel.x] = i;
    }
    for (std::uint32_t p = 0; p < owners.size(); ++p) {
        move_out_buried(owners[p], atlas.page_sides_texels[p], buried);
        const std::vector<std::uint32_t> sources =
            lightmap::dilation_sources(atlas, texels, p, atlas.options.padding_texels);
        lightmap::dilate(std::span(owners[p]), sources);
    }
    return owners;
}

std::vector<IntervalPage> pages_of(const lightmap::Atlas& atlas, const std::vector<Owners>& owners,
                                   const TexelIntervals& intervals) {
    const int pairs = pairs_for(intervals);
    std::vector<IntervalPage> pages;
    for (std::size_t p = 0; p < owners.size(); ++p) {
        pages.push_back(blank_page(atlas.page_sides_texels[p], pairs));
        for (std::size_t place = 0; place < owners[p].size(); ++place) {
            if (owners[p][place] == lightmap::kNoTexel) continue;
            put(pages[p], place, intervals.texels[owners[p][place]]);
        }
    }
    return pages;
}

/// Where each place's texel asks, from the place's own centre.
std::vector<bake::SamplePlaces> places_of(const bake::BakedTexels& baked,
                                          const lightmap::Texels& texels,
                                          const std::vector<trace::Receiver>& receivers,
                                          const std::vector<Owners>& owners) {
    std::vector<bake::SamplePlaces> pages;
    for (std::size_t p = 0; p < owners.size(); ++p) {
        const unsigned side = baked.atlas.page_sides_texels[p];
        bake::SamplePlaces page(owners[p].size());
        for (std::size_t place = 0; place < owners[p].size(); ++place) {
            const std::uint32_t texel = owners[p][place];
            if (texel == lightmap::kNoTexel) continue;
            const glm::dvec2 center(static_cast<double>(place % side) + 0.5,
                                    static_cast<double>(place / side) + 0.5);
            const lightmap::Facet& facet = baked.atlas.facets[texels.texels[texel].facet];
            page[place] = bake::coded_place(
                bake::page_place(facet, DVec3(receivers[texel].position_ws)) - center);
        }
        pages.push_back(std::move(page));
    }
    return pages;
}

std::size_t allowed_intervals(const BakeOptions& options) {
    return kIntervalsPerPair * static_cast<std::size_t>(options.most_pairs);
}

bake::FineCells fine_cells(const lightmap::Atlas& atlas, const std::vector<IntervalPage>& pages,
                           int parts, const bake::LightDay& light, const BakeOptions& options,
                           BakeReport& report, Progress& progress) {
    bake::FineSamples samples =
        bake::fine_samples(light.scene(), atlas, pages, parts, light.codes());
    bake::FineCells cells = std::move(samples.cells);
    bake::TexelDay day{.receivers = std::move(samples.receivers), .times = {}, .buried = {}};
    day.times = light.times(day.receivers, progress);
    const std::vector<std::uint32_t> sources =
        bake::open_samples(cells, find_buried(light, day, progress));
    const TexelIntervals intervals =
        limited(std::move(day.times), light.codes(), allowed_intervals(options));
    add_closed(intervals.report, report);
    const auto side = static_cast<unsigned>(
        std::ceil(std::sqrt(static_cast<double>(std::max<std::size_t>(sources.size(), 1)))));
    cells.samples = blank_page(side, pairs_for(intervals));
    for (std::size_t i = 0; i < sources.size(); ++i)
        put(cells.samples, i, intervals.texels[sources[i]]);
    return cells;
}

/// The pieces of memory that a texel's list of times grows through; measured.
constexpr std::uint64_t kList_bytes = 64;

/// What is held of a texel besides the light map's part, when all texels are done: its receiver,
/// and the list of its times. Trees of the scene take no more than the light map's own work on
/// triangles, which is done by then.
constexpr std::uint64_t kTexel_bytes =
    sizeof(trace::Receiver) + sizeof(bake::LitTimes) + kList_bytes;

/// Of a place on a page: its texel, where that asks, and all intervals that it may have.
std::uint64_t place_bytes(const BakeOptions& options) {
    const std::uint64_t intervals = allowed_intervals(options);
    return sizeof(std::uint32_t) + sizeof(bake::SamplePlace) +
           intervals * sizeof(bake::CodedInterval);
}

}  // namespace

namespace bake {

BakedTexels baked_texels(const Scene& scene, const BakePath& path, const BakeOptions& options,
                         const LookupOptions& lookup, Progress& progress) {
    check(path, options);
    BakedTexels baked;
    baked.atlas = lightmap::make_atlas(
        scene,
        {.texel_size_m = options.texel_size_m,
         .memory_limit_bytes = options.memory_limit_bytes,
         .more_texel_bytes = kTexel_bytes,
         .more_place_bytes = place_bytes(options),
         .texel_option = options.texel_option,
         .to_light_ws = lookup.lit_sides_only ? path.to_light_ws : std::vector<DVec3>()},
        progress);
    const lightmap::Texels texels = lightmap::make_texels(scene, baked.atlas, progress);
    const LightDay light(scene, path, options, progress);
    TexelDay day{.receivers = texel_receivers(baked.atlas, texels), .times = {}, .buried = {}};
    day.times = light.kept_times(day.receivers, progress);
    day.buried = find_buried(light, day, progress);
    move_to_open(baked.atlas, texels, light, day, progress);
    TexelIntervals intervals =
        limited(std::move(day.times), light.codes(), allowed_intervals(options));
    intervals.report.buried_texels =
        static_cast<std::uint64_t>(std::ranges::count(day.buried, true));
    intervals.report.warnings = baked.atlas.warnings;
    const std::vector<Owners> owners = owners_of(baked.atlas, texels, day.buried);
    baked.path_codes = light.codes();
    baked.places = places_of(baked, texels, day.receivers, owners);
    baked.pages = pages_of(baked.atlas, owners, intervals);
    baked.report = std::move(intervals.report);
    if (lookup.fine_parts > 1) {
        baked.fine = fine_cells(baked.atlas, baked.pages, lookup.fine_parts, light, options,
                                baked.report, progress);
    }
    return baked;
}

}  // namespace bake

std::string closed_gaps_text(const BakeReport& report) {
    if (report.closed_gaps == 0) return {};
    constexpr double kPercent = 100.0;
    return fmt::format("{} gaps closed for want of pairs: {:.4f} % of the time of all texels",
                       report.closed_gaps, kPercent * report.closed_share);
}

IntervalBake bake_intervals(const Scene& scene, const BakePath& path, const BakeOptions& options,
                            Progress& progress) {
    bake::BakedTexels baked = bake::baked_texels(scene, path, options, {}, progress);
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
    constexpr double kAlways = std::numeric_limits<double>::infinity();
    const double codes = window.codes_per_step;
    const PathEnds& ends = window.ends;
    const bake::WindowPlaces places = bake::window_places(window);
    double seen = 0.0;
    for (std::size_t i = 0; i < kIntervalsPerPair * static_cast<std::size_t>(page.pairs); ++i) {
        const std::size_t at = bake::value_index(page, texel, i);
        double rise = page.rises[at];
        double fall = page.falls[at];
        if (fall <= rise) continue;
        if (!ends.closed && ends.begins_up && rise == 0.0) rise = -kAlways;
        if (!ends.closed && ends.ends_up && fall == ends.path_steps * codes) fall = kAlways;
        for (std::size_t place = 0; place < places.count; ++place) {
            seen += bake::seen_part(rise, fall, places.at[place], window.width_steps * codes,
                                    window.even);
        }
    }
    return std::min(seen, 1.0);
}

}  // namespace gnomon
