#include "bake/baked_texels.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::bake {

namespace {

std::uint64_t key_of(std::uint32_t instance, std::uint32_t triangle) {
    return std::uint64_t{instance} << 32 | triangle;
}

/// Where on its page a point of the facet's plane is, in texels.
glm::dvec2 page_place(const lightmap::Facet& facet, DVec3 point_ws) {
    const DVec3 from = point_ws - facet.origin_ws;
    const double uu = glm::dot(facet.u_ws, facet.u_ws);
    const double uv = glm::dot(facet.u_ws, facet.v_ws);
    const double vv = glm::dot(facet.v_ws, facet.v_ws);
    const double u = glm::dot(facet.u_ws, from);
    const double v = glm::dot(facet.v_ws, from);
    const double determinant = uu * vv - uv * uv;
    return {(vv * u - uv * v) / determinant, (uu * v - uv * u) / determinant};
}

/// The nearest texel of the chart's rectangle, within which texels have values.
unsigned texel_in(double place, unsigned first, unsigned count) {
    return static_cast<unsigned>(
        std::clamp(std::floor(place), static_cast<double>(first), first + count - 1.0));
}

}  // namespace

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

double TexelFinder::visibility(const lightmap::Facet& facet, const trace::Receiver& receiver,
                               TexelLookup lookup, const LightWindow& window) const {
    const lightmap::Chart& chart = baked_.atlas.charts[facet.chart];
    const IntervalPage& page = baked_.pages[chart.page];
    const glm::dvec2 place = page_place(facet, DVec3(receiver.position_ws));
    const auto seen = [&](double x, double y) {
        return interval_visibility(page, texel_in(x, chart.x, chart.size.width),
                                   texel_in(y, chart.y, chart.size.height), window);
    };
    if (lookup == TexelLookup::nearest) return seen(place.x, place.y);
    const glm::dvec2 corner = glm::floor(place - 0.5);
    const glm::dvec2 f = place - 0.5 - corner;
    return glm::mix(
        glm::mix(seen(corner.x, corner.y), seen(corner.x + 1.0, corner.y), f.x),
        glm::mix(seen(corner.x, corner.y + 1.0), seen(corner.x + 1.0, corner.y + 1.0), f.x), f.y);
}

}  // namespace gnomon::bake
