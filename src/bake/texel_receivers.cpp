#include "bake/texel_receivers.h"

namespace gnomon::bake {

std::vector<trace::Receiver> texel_receivers(const lightmap::Atlas& atlas,
                                             const lightmap::Texels& texels) {
    std::vector<trace::Receiver> receivers;
    receivers.reserve(texels.texels.size());
    for (const lightmap::Texel& texel : texels.texels) {
        const lightmap::Facet& facet = atlas.facets[texel.facet];
        receivers.push_back(
            {.position_ws = Vec3(texel.point_ws),
             .normal_ws = Vec3(facet.normal_ws),
             .id = {atlas.charts[facet.chart].instance, atlas.triangles[texel.triangle].triangle}});
    }
    return receivers;
}

trace::Receiver receiver_on(const Scene& scene, const lightmap::Atlas& atlas,
                            std::uint32_t triangle, const std::array<double, 3>& weights) {
    const lightmap::PlacedTriangle& placed = atlas.triangles[triangle];
    const lightmap::Facet& facet = atlas.facets[placed.facet];
    const trace::SurfaceId id{atlas.charts[facet.chart].instance, placed.triangle};
    // Not by the facet's plane, which is that of its triangles only nearly.
    const trace::Triangle corners = trace::world_triangle(scene, id);
    DVec3 point_ws(0.0);
    for (std::size_t i = 0; i < weights.size(); ++i)
        point_ws += weights[i] * corners.corners_ws[i];
    return {.position_ws = Vec3(point_ws), .normal_ws = Vec3(facet.normal_ws), .id = id};
}

}  // namespace gnomon::bake
