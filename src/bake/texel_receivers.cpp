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

}  // namespace gnomon::bake
