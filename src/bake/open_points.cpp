#include "bake/open_points.h"

#include "bake/buried.h"
#include "bake/texel_receivers.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace gnomon::bake {

namespace {

using lightmap::dvec2;

/// Places along each side of a texel: the open part of one that it misses is a quarter of it.
constexpr unsigned kPlacesAlong = 4;

/// Places in a texel, the nearest to its centre first.
std::array<dvec2, kPlacesAlong * kPlacesAlong> places() {
    std::array<dvec2, kPlacesAlong * kPlacesAlong> result;
    for (unsigned i = 0; i < result.size(); ++i) {
        result[i] = (dvec2(i % kPlacesAlong, i / kPlacesAlong) + 0.5) / double{kPlacesAlong};
    }
    std::ranges::stable_sort(result, {}, [](dvec2 p) { return glm::length(p - 0.5); });
    return result;
}

/// A place that a buried texel may move to.
struct Candidate {
    std::uint32_t texel = 0;
    trace::Receiver receiver;
};

/// Those on the texel's own plane.
void add_candidates(const Scene& scene, const lightmap::Atlas& atlas, const lightmap::Texel& texel,
                    std::uint32_t number, std::vector<Candidate>& out) {
    static const auto kPlaces = places();
    const lightmap::Facet& facet = atlas.facets[texel.facet];
    for (const dvec2 place : kPlaces) {
        const dvec2 p = dvec2(texel.x, texel.y) + place;
        for (std::uint32_t t = 0; t < facet.triangle_count; ++t) {
            const lightmap::Corners& corners =
                atlas.triangles[facet.first_triangle + t].corners_texels;
            const std::array<double, 3> weights = lightmap::nearest_weights(corners, p);
            if (glm::distance(lightmap::weighted(corners, weights), p) > lightmap::kBorder_texels)
                continue;
            out.push_back({number, receiver_on(scene, atlas, facet.first_triangle + t, weights)});
            break;
        }
    }
}

}  // namespace

void move_to_open(const lightmap::Atlas& atlas, const lightmap::Texels& texels,
                  const LightDay& light, TexelDay& day, Progress& progress) {
    std::vector<Candidate> candidates;
    for (std::uint32_t i = 0; i < texels.texels.size(); ++i) {
        if (day.buried[i]) add_candidates(light.scene(), atlas, texels.texels[i], i, candidates);
    }
    std::vector<trace::Receiver> receivers;
    for (const Candidate& candidate : candidates)
        receivers.push_back(candidate.receiver);
    std::vector<std::uint32_t> all(candidates.size());
    std::iota(all.begin(), all.end(), 0u);
    const std::vector<bool> buried =
        are_buried(light.scene(), receivers, all, light.path().to_light_ws, progress);

    std::vector<trace::Receiver> moved;
    std::vector<std::uint32_t> movers;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const std::uint32_t texel = candidates[i].texel;
        if (buried[i] || !day.buried[texel]) continue;
        day.buried[texel] = false;
        day.receivers[texel] = candidates[i].receiver;
        moved.push_back(candidates[i].receiver);
        movers.push_back(texel);
    }
    if (moved.empty()) return;
    std::vector<LitTimes> times = light.times(moved, progress);
    for (std::size_t i = 0; i < movers.size(); ++i)
        day.times[movers[i]] = std::move(times[i]);
}

}  // namespace gnomon::bake
