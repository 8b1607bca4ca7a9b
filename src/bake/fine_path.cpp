// J.-L. Lagrange's polynomial through the four nearest directions, made a unit vector. The sun's
// way of a day errs by 2^-7 of the fourth power of its turn in a step: 3e-10 rad with 255 steps of
// 16 hours, where the sun moves 7e-5 rad a second. Corners, which key frames have, are rounded
// within a step of them.

#include "bake/fine_path.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace gnomon::bake {

namespace {

constexpr int kNodes = 4;

/// Of the polynomial through values at 0, 1, .. count - 1, the weight of the one at `node`.
double lagrange_weight(double at, int node, int count) {
    double weight = 1.0;
    for (int other = 0; other < count; ++other) {
        if (other != node) weight *= (at - other) / (node - other);
    }
    return weight;
}

}  // namespace

std::vector<DVec3> fine_path(std::span<const DVec3> to_light_ws, int parts) {
    const auto steps = static_cast<int>(to_light_ws.size());
    const int count = std::min(kNodes, steps);
    std::vector<DVec3> fine;
    fine.reserve(to_light_ws.size() * static_cast<std::size_t>(parts));
    for (int k = 0; k < steps; ++k) {
        for (int part = 0; part < parts; ++part) {
            const double at = k + (part + 0.5) / parts - 0.5;  // of the table: middles of steps
            const int before = at < k ? k - 1 : k;
            const int first = std::clamp(before - (count / 2 - 1), 0, steps - count);
            DVec3 sum(0.0);
            for (int node = 0; node < count; ++node) {
                sum += lagrange_weight(at - first, node, count) *
                       to_light_ws[static_cast<std::size_t>(first + node)];
            }
            // Opposite neighbours, between which no way is nearer, leave nothing.
            const double length = glm::length(sum);
            fine.push_back(length > 0.0 ? sum / length : to_light_ws[static_cast<std::size_t>(k)]);
        }
    }
    return fine;
}

}  // namespace gnomon::bake
