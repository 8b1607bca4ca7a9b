#include "bake/sun_hours_map.h"

#include "lightmap/dilate.h"

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

using lightmap::Atlas;
using lightmap::kNoTexel;
using lightmap::Texel;
using lightmap::Texels;

double area_of(const trace::Triangle& triangle) {
    return 0.5 * glm::length(triangle.front_normal_ws());
}

/// Weights of the corners at a point of the triangle's plane.
std::array<double, 3> weights_at(const trace::Triangle& triangle, DVec3 point_ws) {
    const auto& [a, b, c] = triangle.corners_ws;
    const DVec3 normal = glm::cross(b - a, c - a);
    const double doubled2 = glm::dot(normal, normal);
    const double of_b = glm::dot(glm::cross(point_ws - a, c - a), normal) / doubled2;
    const double of_c = glm::dot(glm::cross(b - a, point_ws - a), normal) / doubled2;
    return {1.0 - of_b - of_c, of_b, of_c};
}

}  // namespace

float SunHoursMap::hours_at(const Scene& scene, const trace::Receiver& point) const {
    const trace::Triangle triangle = trace::world_triangle(scene, point.id);
    const bool back = glm::dot(triangle.front_normal_ws(), DVec3(point.normal_ws)) < 0.0;
    const std::uint32_t index =
        placed[first_placed[point.id.instance] + 2 * std::size_t{point.id.primitive} + back];
    if (index == kNoTexel) return bake::kNoSurface_h;
    const lightmap::PlacedTriangle& place = atlas.triangles[index];
    const auto weights = weights_at(triangle, DVec3(point.position_ws));
    lightmap::dvec2 p(0.0);
    for (std::size_t i = 0; i < 3; ++i)
        p += weights[i] * place.corners_texels[i];
    const Image& page = dilated_h[atlas.charts[atlas.facets[place.facet].chart].page];
    const auto texel = [](double x, unsigned side) {
        return static_cast<unsigned>(std::clamp(std::floor(x), 0.0, side - 1.0));
    };
    return page.at(texel(p.x, page.width()), texel(p.y, page.height()));
}

namespace bake {

SunHoursMap make_map(const Scene& scene, Atlas atlas, const Texels& texels,
                     std::span<const SunHours> hours) {
    SunHoursMap map;
    for (const Instance& instance : scene.instances()) {
        map.first_placed.push_back(map.placed.size());
        map.placed.resize(map.placed.size() + 2 * scene.meshes()[instance.mesh].triangles.size(),
                          kNoTexel);
    }
    for (std::size_t i = 0; i < atlas.triangles.size(); ++i) {
        const lightmap::PlacedTriangle& place = atlas.triangles[i];
        const std::size_t first =
            map.first_placed[atlas.charts[atlas.facets[place.facet].chart].instance];
        map.placed[first + 2 * std::size_t{place.triangle} + place.back] =
            static_cast<std::uint32_t>(i);
    }
    for (const unsigned side : atlas.page_sides_texels)
        map.pages_h.emplace_back(Extent{side, side}, 1, kNoSurface_h);
    for (std::size_t i = 0; i < texels.texels.size(); ++i) {
        const Texel& texel = texels.texels[i];
        map.pages_h[atlas.charts[atlas.facets[texel.facet].chart].page].at(texel.x, texel.y) =
            hours[i].mean_h;
    }
    map.dilated_h = map.pages_h;
    for (std::uint32_t page = 0; page < map.dilated_h.size(); ++page) {
        const auto sources =
            lightmap::dilation_sources(atlas, texels, page, atlas.options.padding_texels);
        lightmap::dilate(map.dilated_h[page].pixels(), sources);
    }
    map.atlas = std::move(atlas);
    return map;
}

std::vector<double> texel_areas_m2(const Scene& scene, const Atlas& atlas, const Texels& texels) {
    std::vector<double> facet_areas(atlas.facets.size(), 0.0), counts(atlas.facets.size(), 0.0);
    for (const lightmap::PlacedTriangle& place : atlas.triangles) {
        const lightmap::Chart& chart = atlas.charts[atlas.facets[place.facet].chart];
        facet_areas[place.facet] +=
            area_of(trace::world_triangle(scene, {chart.instance, place.triangle}));
    }
    for (const Texel& texel : texels.texels)
        counts[texel.facet] += 1.0;
    std::vector<double> whole(atlas.charts.size(), 0.0), shared(whole);
    for (std::size_t f = 0; f < facet_areas.size(); ++f) {
        whole[atlas.facets[f].chart] += facet_areas[f];
        if (counts[f] > 0.0) shared[atlas.facets[f].chart] += facet_areas[f];
    }
    std::vector<double> areas;
    areas.reserve(texels.texels.size());
    for (const Texel& texel : texels.texels) {
        const std::uint32_t chart = atlas.facets[texel.facet].chart;
        const double scale = shared[chart] > 0.0 ? whole[chart] / shared[chart] : 0.0;
        areas.push_back(scale * facet_areas[texel.facet] / counts[texel.facet]);
    }
    return areas;
}

}  // namespace bake

}  // namespace gnomon
