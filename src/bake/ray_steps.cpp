#include "bake/ray_steps.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace gnomon::bake {

void ray_masks(const trace::Tracer& tracer, std::span<const DVec3> to_light_ws,
               std::span<const trace::Receiver> receivers, std::span<std::uint64_t> masks) {
    constexpr std::size_t kWordSteps = 64;
    const std::size_t words = (to_light_ws.size() + kWordSteps - 1) / kWordSteps;
    std::ranges::fill(masks, 0);
    std::vector<trace::ShadowRay> rays;
    std::vector<std::size_t> asked;
    std::vector<std::uint8_t> blocked;
    for (std::size_t step = 0; step < to_light_ws.size(); ++step) {
        rays.clear();
        asked.clear();
        const auto set_lit = [&](std::size_t i) {
            masks[i * words + step / kWordSteps] |= std::uint64_t{1} << (step % kWordSteps);
        };
        for (std::size_t i = 0; i < receivers.size(); ++i) {
            if (!receivers[i].exists()) {
                set_lit(i);
            } else if (glm::dot(DVec3(receivers[i].normal_ws), to_light_ws[step]) > 0.0) {
                rays.push_back({&receivers[i], Vec3(to_light_ws[step]), true});
                asked.push_back(i);
            }
        }
        blocked.resize(rays.size());
        tracer.blocked(rays, blocked);
        for (std::size_t k = 0; k < asked.size(); ++k) {
            if (blocked[k] == 0) set_lit(asked[k]);
        }
    }
}

}  // namespace gnomon::bake
