#include "bake/path_place.h"

#include "bake/fine_path.h"
#include "base/check.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace bake {

namespace {

/// Of a step: a polynomial's slope over it is exact to the square, 1e-6 of the turn in a step.
constexpr double kSlope_steps = 1e-3;
/// Each squares what a step is off by, which is a half of one at first.
constexpr int kNewtonSteps = 8;
/// Of a direction that was kept in single precision.
constexpr double kRounding_rad = 1e-6;

/// A step's part of the path, or what there is of the two beside it.
struct Near {
    double at_step = 0.0;
    double off_rad = 0.0;
};

DVec3 slope_at(const BakePath& path, double at_step) {
    return (direction_at(path.to_light_ws, at_step + kSlope_steps) -
            direction_at(path.to_light_ws, at_step - kSlope_steps)) /
           (2.0 * kSlope_steps);
}

/// The nearest place within a step of `at_step`, by C. F. Gauss's way of least squares.
Near nearest_from(const BakePath& path, DVec3 to_light, double at_step) {
    const double least = std::max(0.0, at_step - 1.0);
    const double most = std::min(static_cast<double>(path.steps()), at_step + 1.0);
    for (int i = 0; i < kNewtonSteps; ++i) {
        const DVec3 slope = slope_at(path, at_step);
        const double speed2 = glm::dot(slope, slope);
        if (!(speed2 > 0.0)) break;
        const DVec3 ahead = to_light - direction_at(path.to_light_ws, at_step);
        at_step = std::clamp(at_step + glm::dot(ahead, slope) / speed2, least, most);
    }
    return {at_step, angle_between(to_light, direction_at(path.to_light_ws, at_step))};
}

double turned_rad(const BakePath& path) {
    double turned = 0.0;
    for (std::size_t k = 1; k < path.to_light_ws.size(); ++k)
        turned += angle_between(path.to_light_ws[k - 1], path.to_light_ws[k]);
    return turned;
}

}  // namespace

double angle_between(DVec3 a, DVec3 b) {
    // By half its sine: a cosine cannot tell small angles.
    return 2.0 * std::asin(std::min(1.0, 0.5 * glm::length(a - b)));
}

std::optional<PathPlace> place_on(const BakePath& path, DVec3 to_light_ws, double tolerance_rad) {
    const std::vector<DVec3>& d = path.to_light_ws;
    const DVec3 to_light = glm::normalize(to_light_ws);
    std::optional<Near> best;
    for (std::size_t k = 0; k < d.size(); ++k) {
        // Steps that are no nearer than both of their neighbours have no nearest place of their
        // own.
        const double off = glm::distance(d[k], to_light);
        if (k > 0 && glm::distance(d[k - 1], to_light) < off) continue;
        if (k + 1 < d.size() && glm::distance(d[k + 1], to_light) < off) continue;
        const Near found = nearest_from(path, to_light, static_cast<double>(k) + 0.5);
        if (!best || found.off_rad < best->off_rad - kRounding_rad) best = found;
    }
    if (!best || !(best->off_rad <= tolerance_rad)) return {};
    PathPlace place{.at_step = best->at_step};
    const DVec3 slope = slope_at(path, best->at_step);
    if (glm::length(slope) > 0.0) place.along_ws = glm::normalize(slope);
    return place;
}

double steps_per_rad(const BakePath& path) {
    const double turned = turned_rad(path);
    return turned > 0.0 ? (path.steps() - 1) / turned : 0.0;
}

double disc_width_steps(const BakePath& path, double angular_diameter_rad, int codes_per_step) {
    if (path.steps() < 2) return 1.0;
    return std::max(1.0 / codes_per_step, angular_diameter_rad * steps_per_rad(path));
}

}  // namespace bake

double disc_width_steps(const BakePath& path, int codes_per_step) {
    return bake::disc_width_steps(path, path.angular_diameter_rad, codes_per_step);
}

DirectionalLight light_at(const BakePath& path, double clock_s) {
    if (path.to_light_ws.empty()) fail_input("light_at: the light is never up: {}", path.summary);
    if (!(clock_s >= path.begin_s && clock_s <= path.end_s)) {
        fail_input("light_at: clock_s is {}; the path is from {} to {}", clock_s, path.begin_s,
                   path.end_s);
    }
    const double part = (clock_s - path.begin_s) / (path.end_s - path.begin_s);
    const DVec3 to_light = bake::direction_at(path.to_light_ws, part * path.steps());
    return {.to_light_ws = Vec3(to_light),
            .angular_diameter_rad = static_cast<float>(path.angular_diameter_rad)};
}

}  // namespace gnomon
