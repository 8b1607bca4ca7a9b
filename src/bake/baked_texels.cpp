#include "bake/baked_texels.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::bake {

namespace {

using lightmap::dvec2;

std::uint64_t key_of(std::uint32_t instance, std::uint32_t triangle) {
    return std::uint64_t{instance} << 32 | triangle;
}

/// The nearest texel of the chart's rectangle, within which texels have values.
unsigned texel_in(double place, unsigned first, unsigned count) {
    return static_cast<unsigned>(
        std::clamp(std::floor(place), static_cast<double>(first), first + count - 1.0));
}

/// Texels that are nearer are at one place.
constexpr double kLeastApart_texels = 1.0 / shared::kPlaceCodes;

/// Where `p` is between two places, in [0, 1].
double part_between(double p, double from, double to) {
    if (to - from < kLeastApart_texels) return 0.5;
    return std::clamp((p - from) / (to - from), 0.0, 1.0);
}

}  // namespace

dvec2 page_place(const lightmap::Facet& facet, DVec3 point_ws) {
    const DVec3 from = point_ws - facet.origin_ws;
    const double uu = glm::dot(facet.u_ws, facet.u_ws);
    const double uv = glm::dot(facet.u_ws, facet.v_ws);
    const double vv = glm::dot(facet.v_ws, facet.v_ws);
    const double u = glm::dot(facet.u_ws, from);
    const double v = glm::dot(facet.v_ws, from);
    const double determinant = uu * vv - uv * uv;
    return {(vv * u - uv * v) / determinant, (uu * v - uv * u) / determinant};
}

TexelFinder::TexelFinder(const BakedTexels& baked) : baked_(baked) {
    for (const lightmap::PlacedTriangle& placed : baked.atlas.triangles) {
        const lightmap::Chart& chart = baked.atlas.charts[baked.atlas.facets[placed.facet].chart];
        facets_[placed.back ? 1 : 0][key_of(chart.instance, placed.triangle)] = placed.facet;
    }
}

const lightmap::Facet* TexelFinder::facet_of(const trace::Receiver& receiver) const {
    for (const auto& side : facets_) {
        const auto found = side.find(key_of(receiver.id.instance, receiver.id.primitive));
        if (found == side.end()) continue;
        const lightmap::Facet& facet = baked_.atlas.facets[found->second];
        if (glm::dot(facet.normal_ws, DVec3(receiver.normal_ws)) > 0.0) return &facet;
    }
    return nullptr;
}

TexelFinder::Corners TexelFinder::corners_of(const lightmap::Facet& facet, dvec2 place) const {
    const FineCells& fine = baked_.fine;
    const lightmap::Chart& chart = baked_.atlas.charts[facet.chart];
    const dvec2 first = glm::floor(place - 0.5);
    Corners result;
    BetweenTexels& between = result.between;
    if (const auto cell =
            fine.find(facet.chart, static_cast<int>(first.x), static_cast<int>(first.y))) {
        const dvec2 part = (place - 0.5 - first) * double(fine.parts);
        const dvec2 corner = glm::min(glm::floor(part), dvec2(fine.parts - 1));
        result.page = &fine.samples;
        for (unsigned i = 0; i < 4; ++i) {
            const dvec2 at = corner + dvec2(i % 2, i / 2);
            const auto sample = *cell + static_cast<std::size_t>(at.y * (fine.parts + 1) + at.x);
            between.texels[i] = sample;
            between.places_texels[i] =
                first + 0.5 + at / double(fine.parts) + texels_of(fine.places[sample]) - place;
        }
        return result;
    }
    result.page = &baked_.pages[chart.page];
    between.texels =
        texels_around(chart, baked_.pages, static_cast<int>(first.x), static_cast<int>(first.y));
    const std::size_t side = result.page->side_texels;
    for (unsigned i = 0; i < 4; ++i) {
        const std::size_t texel = between.texels[i];
        between.places_texels[i] = dvec2(texel % side, texel / side) + 0.5 +
                                   texels_of(baked_.places[chart.page][texel]) - place;
    }
    return result;
}

double TexelFinder::by_edges(const lightmap::Facet& facet, dvec2 place,
                             const LightOnPath& light) const {
    Corners corners = corners_of(facet, place);
    const std::array<dvec2, 4>& at = corners.between.places_texels;
    const double upper = part_between(0.0, at[0].x, at[1].x);
    const double lower = part_between(0.0, at[2].x, at[3].x);
    const double down =
        part_between(0.0, glm::mix(at[0].y, at[1].y, upper), glm::mix(at[2].y, at[3].y, lower));
    corners.between.weights = {(1.0 - down) * (1.0 - upper), (1.0 - down) * upper,
                               down * (1.0 - lower), down * lower};
    corners.between.path_codes = baked_.path_codes;
    corners.between.normal_from_slope =
        normal_from_slope(facet.u_ws, facet.v_ws, light.along_ws, light.across_ws);
    return edges_visibility(*corners.page, corners.between, light.window);
}

double TexelFinder::visibility(const lightmap::Facet& facet, const trace::Receiver& receiver,
                               TexelLookup lookup, const LightOnPath& light) const {
    const lightmap::Chart& chart = baked_.atlas.charts[facet.chart];
    const dvec2 place = page_place(facet, DVec3(receiver.position_ws));
    if (lookup == TexelLookup::edges) return by_edges(facet, place, light);
    const auto seen = [&](double x, double y) {
        return interval_visibility(baked_.pages[chart.page], texel_in(x, chart.x, chart.size.width),
                                   texel_in(y, chart.y, chart.size.height), light.window);
    };
    if (lookup == TexelLookup::nearest) return seen(place.x, place.y);
    const dvec2 corner = glm::floor(place - 0.5);
    const dvec2 f = place - 0.5 - corner;
    return glm::mix(
        glm::mix(seen(corner.x, corner.y), seen(corner.x + 1.0, corner.y), f.x),
        glm::mix(seen(corner.x, corner.y + 1.0), seen(corner.x + 1.0, corner.y + 1.0), f.x), f.y);
}

}  // namespace gnomon::bake
