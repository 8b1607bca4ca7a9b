// J.-L. Lagrange's polynomial through the four nearest directions, made a unit vector. The sun's
// way of a day errs by 2^-7 of the fourth power of its turn in a step: 3e-10 rad with 255 steps of
// 16 hours, where the sun moves 7e-5 rad a second. Corners, which key frames have, are rounded
// within a step of them.

#include "bake/fine_path.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

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

DVec3 direction_at(std::span<const DVec3> to_light_ws, double at_step) {
    const auto steps = static_cast<int>(to_light_ws.size());
    const int count = std::min(kNodes, steps);
    const double at = at_step - 0.5;  // of the table: middles of steps
    const int before = static_cast<int>(std::floor(at));
    const int first = std::clamp(before - (count / 2 - 1), 0, steps - count);
    DVec3 sum(0.0);
    for (int node = 0; node < count; ++node) {
        sum += lagrange_weight(at - first, node, count) *
               to_light_ws[static_cast<std::size_t>(first + node)];
    }
    // Opposite neighbours, between which no way is nearer, leave nothing.
    const double length = glm::length(sum);
    if (length > 0.0) return sum / length;
    return to_light_ws[static_cast<std::size_t>(
        std::clamp(static_cast<int>(std::floor(at_step)), 0, steps - 1))];
}

std::vector<DVec3> fine_path(std::span<const DVec3> to_light_ws, int parts) {
    std::vector<DVec3> fine;
    fine.reserve(to_light_ws.size() * static_cast<std::size_t>(parts));
    for (std::size_t k = 0; k < to_light_ws.size(); ++k) {
        for (int part = 0; part < parts; ++part)
            fine.push_back(
                direction_at(to_light_ws, static_cast<double>(k) + (part + 0.5) / parts));
    }
    return fine;
}

}  // namespace gnomon::bake
