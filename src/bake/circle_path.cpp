#include "bake/circle_path.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon::bake {

namespace {

/// Of a circle so small that its directions are one.
constexpr double kLeastRadius = 1e-6;

struct Circle {
    DVec3 pole, noon, east;  ///< unit vectors; noon is the highest direction across the pole
    double height = 0.0, radius = 0.0;

    DVec3 at(double angle) const {
        return height * pole + radius * (std::cos(angle) * noon + std::sin(angle) * east);
    }
};

Circle circle_of(DVec3 to_light, DVec3 pole_ws, DVec3 up) {
    Circle circle{.pole = glm::normalize(pole_ws)};
    DVec3 noon = up - glm::dot(up, circle.pole) * circle.pole;
    if (glm::length(noon) < kLeastRadius) {  // the pole is overhead: any will do
        const DVec3 other = std::abs(circle.pole.x) < 0.5 ? DVec3(1, 0, 0) : DVec3(0, 0, 1);
        noon = other - glm::dot(other, circle.pole) * circle.pole;
    }
    circle.noon = glm::normalize(noon);
    circle.east = glm::cross(circle.pole, circle.noon);
    circle.height = std::clamp(glm::dot(to_light, circle.pole), -1.0, 1.0);
    circle.radius = std::sqrt(std::max(0.0, 1.0 - circle.height * circle.height));
    return circle;
}

/// Half of the arc around noon that is above the horizon.
double half_arc(const Circle& circle, DVec3 to_light, DVec3 up) {
    const double swing = circle.radius * glm::dot(circle.noon, up);
    const double base = circle.height * glm::dot(circle.pole, up);
    if (glm::dot(to_light, up) <= 0.0 || std::abs(base) >= swing) return std::numbers::pi;
    return std::acos(-base / swing);
}

}  // namespace

PathThrough circle_through(DVec3 to_light_ws, DVec3 pole_ws, DVec3 up_ws, int steps) {
    const DVec3 to_light = glm::normalize(to_light_ws);
    const Circle circle = circle_of(to_light, pole_ws, up_ws);
    PathThrough result;
    result.path.pole_ws = circle.pole;
    if (circle.radius < kLeastRadius) {
        result.path.to_light_ws = {to_light};
        return result;
    }
    const double half = half_arc(circle, to_light, up_ws);
    for (int i = 0; i < steps; ++i)
        result.path.to_light_ws.push_back(circle.at(half * (2.0 * (i + 0.5) / steps - 1.0)));
    result.steps_per_rad = steps / (2.0 * half * circle.radius);
    result.ends = {.path_steps = static_cast<double>(steps), .closed = half == std::numbers::pi};
    return result;
}

double step_on(const PathThrough& path, DVec3 to_light_ws, double tolerance_rad) {
    const std::vector<DVec3>& directions = path.path.to_light_ws;
    const DVec3 to_light = glm::normalize(to_light_ws);
    const double height = glm::dot(directions.front(), path.path.pole_ws);
    if (std::abs(glm::dot(to_light, path.path.pole_ws) - height) > tolerance_rad) return -1.0;
    if (directions.size() == 1) return 0.5;
    const auto nearest = std::ranges::max_element(
        directions, {}, [&](const DVec3& direction) { return glm::dot(direction, to_light); });
    const auto step = static_cast<double>(nearest - directions.begin());
    // Along the circle from the middle of the nearest step.
    const DVec3 along = glm::cross(path.path.pole_ws, *nearest);
    const double ahead = glm::dot(to_light - *nearest, along) / glm::length(along);
    if (std::abs(ahead * path.steps_per_rad) > 1.0) return -1.0;
    const double result = step + 0.5 + ahead * path.steps_per_rad;
    if (!path.ends.closed) return result;
    return result - path.ends.path_steps * std::floor(result / path.ends.path_steps);
}

}  // namespace gnomon::bake
