// How much a light map takes. Of the squares of a grid a convex shape touches, on the average over
// all places and directions, area + 2 / pi * perimeter + 1: L. Santalo, "Integral Geometry and
// Geometric Probability", 1976, chapter 8. Charts are no convex shapes and lie along the grid; the
// rectangle around a chart bounds what it touches.

#include "lightmap/estimate.h"

#include "base/check.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "lightmap/charts.h"
#include "lightmap/packing.h"
#include "lightmap/texels.h"
#include "lightmap/unwrap.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <thread>

namespace gnomon::lightmap {

namespace {

/// The part of a page that packing fills: 0.8 to 0.98 on the built-in scenes.
constexpr double kPackingEfficiency = 0.9;
/// Texels of a tile, on the average: less than 64 as charts have borders.
constexpr double kTileTexels = 16.0;
/// Bytes of a texel of the grid in which a chart's texels look for their triangles.
constexpr double kGridBytes = sizeof(std::uint32_t) + sizeof(float);
constexpr double kMaxTexelSize_m = 1e6;

struct ChartSize {
    dvec2 size_m;
    double area_m2;
};

struct Survey {
    std::vector<ChartSize> charts;
    double largest_side_m = 0.0;
    std::uint64_t faces = 0;
};

void validate(const Options& options) {
    const auto require = [](std::string_view name, double value, double least, double greatest) {
        if (value >= least && value <= greatest) return;  // written so that NaN fails
        fail_input("light map: {} is {}; it must be in [{}, {}]", name, value, least, greatest);
    };
    require(options.texel_option, options.texel_size_m, 1e-6, kMaxTexelSize_m);
    require("padding_texels", options.padding_texels, 0, 64);
    require("max_page_texels", options.max_page_texels, 16, 32'768);
    require("chart_normal_deg", options.chart_normal_deg, 0, 60);
    if (options.max_page_texels <= 2 * options.padding_texels) {
        fail_input(
            "light map: max_page_texels is {}; with padding_texels {} it must be more than {}",
            options.max_page_texels, options.padding_texels, 2 * options.padding_texels);
    }
}

Survey survey(const Scene& scene, const Options& options, Progress& progress) {
    std::vector<Survey> parts(scene.instances().size());
    const ChartLimits limits = chart_limits(options);
    parallel_for(
        parts.size(), 1,
        [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const Surface surface(scene, static_cast<std::uint32_t>(i), options.back_sides,
                                      options.to_light_ws);
                std::vector<std::uint32_t> all(surface.faces().size());
                std::iota(all.begin(), all.end(), 0u);
                for (const GrownChart& chart : grow_charts(surface, std::move(all), limits))
                    parts[i].charts.push_back({chart.size_m, chart.area_m2});
                parts[i].faces = surface.faces().size();
            }
        },
        "measuring surfaces", &progress);
    Survey whole;
    for (const Survey& part : parts) {
        whole.charts.insert(whole.charts.end(), part.charts.begin(), part.charts.end());
        whole.faces += part.faces;
    }
    for (const ChartSize& chart : whole.charts)
        whole.largest_side_m = std::max(whole.largest_side_m, chart.size_m.x);
    if (whole.charts.empty()) {
        fail_input(
            "light map: the scene \"{}\" has no triangles with an area; there is nothing to "
            "lay out",
            scene.source());
    }
    return whole;
}

std::uint64_t whole(double value) {
    constexpr double kMost = 1e18;  // an unsigned number of 64 bits holds it
    return static_cast<std::uint64_t>(std::min(value, kMost));
}

Estimate estimate_at(const Survey& survey, const Options& options, double texel_size_m) {
    double touched = 0.0;
    double packed = 0.0;
    double largest = 0.0;
    for (const ChartSize& chart : survey.charts) {
        const dvec2 size = glm::max(glm::ceil(chart.size_m / texel_size_m - kBorder_texels), 1.0);
        const dvec2 padded = size + static_cast<double>(options.padding_texels);
        const double perimeter = 2.0 * (chart.size_m.x + chart.size_m.y) / texel_size_m;
        const double area = chart.area_m2 / (texel_size_m * texel_size_m);
        touched += std::min(size.x * size.y, area + 2.0 / kPi * perimeter + 1.0);
        packed += padded.x * padded.y;
        largest = std::max(largest, size.x * size.y);
    }
    packed /= kPackingEfficiency;
    const double page = std::pow(static_cast<double>(options.max_page_texels), 2.0);
    const double threads = std::max(1u, std::thread::hardware_concurrency());
    Estimate estimate;
    estimate.texels = whole(touched);
    estimate.pages = whole(std::ceil(packed / page));
    estimate.page_side_texels =
        kPageStep * static_cast<unsigned>(std::ceil(std::sqrt(std::min(packed, page)) / kPageStep));
    estimate.page_side_texels = std::min(estimate.page_side_texels, options.max_page_texels);
    const double more = static_cast<double>(options.more_bytes) +
                        touched * static_cast<double>(options.more_texel_bytes) +
                        packed * static_cast<double>(options.more_place_bytes);
    estimate.bytes =
        whole(more + touched * (sizeof(Texel) + sizeof(Tile) / kTileTexels) +
              2.0 * static_cast<double>(survey.faces) * (sizeof(Face) + sizeof(PlacedTriangle)) +
              2.0 * static_cast<double>(survey.charts.size()) * (sizeof(Chart) + sizeof(Facet)) +
              threads * kGridBytes * std::min(largest, page));
    return estimate;
}

/// The least texels that fit, to two digits; 0 when none do.
double fitting_texel_size_m(const Survey& survey, const Options& options, std::uint64_t limit) {
    const auto fits = [&](double size_m) {
        return estimate_at(survey, options, size_m).bytes <= limit;
    };
    double high = options.texel_size_m;
    while (!fits(high)) {
        high *= 2.0;
        if (high > kMaxTexelSize_m) return 0.0;
    }
    double low = 0.5 * high;
    constexpr double kNear = 1.01;
    while (high > kNear * low)
        (fits(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
    // Page for page charts need room as well.
    high =
        std::max(high, survey.largest_side_m / (options.max_page_texels - options.padding_texels));
    const double digit = std::pow(10.0, std::floor(std::log10(high)) - 1.0);
    return std::ceil(high / digit) * digit;
}

}  // namespace

Estimate estimate(const Scene& scene, const Options& options) {
    validate(options);
    Progress silent;
    return estimate_at(survey(scene, options, silent), options, options.texel_size_m);
}

Estimate require_fit(const Scene& scene, const Options& options, Progress& progress) {
    validate(options);
    const Survey found = survey(scene, options, progress);
    const Estimate estimate = estimate_at(found, options, options.texel_size_m);
    const std::uint64_t limit =
        options.memory_limit_bytes > 0 ? options.memory_limit_bytes : physical_memory_bytes();
    if (estimate.bytes <= limit) return estimate;
    constexpr double kMiB = 1024.0 * 1024.0;
    const double texel_size_m = fitting_texel_size_m(found, options, limit);
    const std::string advice =
        texel_size_m > 0.0 ? fmt::format("{} {:.4g} would fit", options.texel_option, texel_size_m)
                           : fmt::format("no {} would fit", options.texel_option);
    fail_input(
        "light map: {} {} makes {} texels on {} pages, which take {:.0f} MiB; {} "
        "{:.0f} MiB: {}",
        options.texel_option, options.texel_size_m, estimate.texels, estimate.pages,
        static_cast<double>(estimate.bytes) / kMiB,
        options.memory_limit_bytes > 0 ? "memory_limit_bytes allows" : "this machine has",
        static_cast<double>(limit) / kMiB, advice);
}

}  // namespace gnomon::lightmap
