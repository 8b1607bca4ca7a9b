// The day's path as a circle around the pole. The sun's declination drifts by up to 0.4° a day, and
// refraction lifts it near the horizon; so the circle is fitted to the table, and its greatest
// deviations from the table are kept as bounds, not neglected.

#include "interval/path.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace gnomon::interval {

namespace {

/// Floats of the widest register.
constexpr std::size_t kPadding = 16;

bool is_direction(DVec3 v) {
    const double length2 = glm::dot(v, v);
    return std::isfinite(length2) && length2 > 0.0;
}

/// atan2 of each direction, plus full turns, so that no two neighbours are half a turn apart.
std::vector<double> unwrapped_azimuths(std::span<const DVec3> directions) {
    std::vector<double> azimuths;
    azimuths.reserve(directions.size());
    for (const DVec3& d : directions) {
        double azimuth = std::atan2(d.y, d.x);
        if (!azimuths.empty()) {
            azimuth += 2.0 * std::numbers::pi *
                       std::round((azimuths.back() - azimuth) / (2.0 * std::numbers::pi));
        }
        azimuths.push_back(azimuth);
    }
    return azimuths;
}

/// The line through step = f(azimuth) by least squares, moved to the middle of what it errs.
void fit_steps(std::span<const double> azimuths, DayPath::Fit& fit) {
    const auto count = static_cast<double>(azimuths.size());
    const double mean_step = 0.5 * (count - 1.0);
    double mean_azimuth = 0.0;
    for (const double azimuth : azimuths)
        mean_azimuth += azimuth / count;
    double covariance = 0.0, variance = 0.0;
    for (std::size_t k = 0; k < azimuths.size(); ++k) {
        const double offset = azimuths[k] - mean_azimuth;
        covariance += offset * (static_cast<double>(k) - mean_step);
        variance += offset * offset;
    }
    fit.steps_per_rad = variance > 0.0 ? covariance / variance : 0.0;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t k = 0; k < azimuths.size(); ++k) {
        const double rest = static_cast<double>(k) - fit.steps_per_rad * azimuths[k];
        low = std::min(low, rest);
        high = std::max(high, rest);
    }
    fit.step_at_zero = 0.5 * (low + high);
    fit.slack_steps = 0.5 * (high - low);
}

}  // namespace

Frame frame_around(DVec3 pole_ws) {
    if (!is_direction(pole_ws)) {
        fail_input("pole: ({}, {}, {}) is no direction; it must be finite and not zero", pole_ws.x,
                   pole_ws.y, pole_ws.z);
    }
    const DVec3 z = glm::normalize(pole_ws);
    // Where the pole is overhead, noon is anywhere.
    const DVec3 up = std::abs(z.y) < 0.999 ? DVec3(0.0, 1.0, 0.0) : DVec3(1.0, 0.0, 0.0);
    const DVec3 x = glm::normalize(up - glm::dot(up, z) * z);
    return {x, glm::cross(z, x), z};
}

DayPath::DayPath(std::span<const DVec3> to_sun_ws, const Frame& frame) : frame_(frame) {
    if (to_sun_ws.empty() || to_sun_ws.size() > kMaxSteps) {
        fail_input("steps of a day: {} directions; it must be 1 to {}", to_sun_ws.size(),
                   kMaxSteps);
    }
    std::vector<DVec3> in_frame;
    fit_.low_slope = std::numeric_limits<double>::infinity();
    fit_.high_slope = -fit_.low_slope;
    for (std::size_t k = 0; k < to_sun_ws.size(); ++k) {
        const DVec3 given = to_sun_ws[k];
        if (!is_direction(given)) {
            fail_input("direction of step {}: ({}, {}, {}) must be finite and not zero", k, given.x,
                       given.y, given.z);
        }
        to_sun_ws_.push_back(glm::normalize(given));
        const DVec3 d = frame.from_world(to_sun_ws_.back());
        in_frame.push_back(d);
        const double slope = d.z / std::hypot(d.x, d.y);
        fit_.low_slope = std::min(fit_.low_slope, slope);
        fit_.high_slope = std::max(fit_.high_slope, slope);
        for (int axis = 0; axis < 3; ++axis)
            coordinates_[axis].push_back(static_cast<float>(d[axis]));
    }
    for (std::vector<float>& coordinates : coordinates_)
        coordinates.resize(coordinates.size() + kPadding, 0.0f);
    fit_steps(unwrapped_azimuths(in_frame), fit_);
}

}  // namespace gnomon::interval
