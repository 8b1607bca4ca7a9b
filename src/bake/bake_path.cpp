#include <gnomon/bake.h>

#include "bake/path_place.h"
#include "base/check.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

namespace gnomon {

namespace {

/// Normal of the polygon through the directions, by M. Newell's sum of cross products (I. E.
/// Sutherland, R. F. Sproull, R. A. Schumacker, "A Characterization of Ten Hidden-Surface
/// Algorithms", 1974): the axis of any arc of a circle. Up where they enclose nothing.
DVec3 axis_of(const std::vector<DVec3>& directions) {
    DVec3 sum(0.0);
    for (std::size_t i = 0; i < directions.size(); ++i)
        sum += glm::cross(directions[i], directions[(i + 1) % directions.size()]);
    const double length = glm::length(sum);
    return length > 0.0 ? sum / length : DVec3(0.0, 1.0, 0.0);
}

/// In steps. A day's declination moves the sun by up to 0.007 rad from its last step to its first,
/// as much as it turns in the shortest steps there can be.
constexpr double kMostGap = 2.0;
/// Fewer than so many lead from the last to the first whatever their way.
constexpr std::size_t kLeastClosed = 4;
/// The sine of the elevation above which the disc of the sun is up.
constexpr double kUp = 0.005;

/// Half a step before the first direction, by the parabola through the first three.
double height_before(DVec3 first, DVec3 second, DVec3 third) {
    return (15.0 * first.y - 10.0 * second.y + 3.0 * third.y) / 8.0;
}

}  // namespace

PathEnds path_ends(const BakePath& path) {
    const std::vector<DVec3>& d = path.to_light_ws;
    const std::size_t count = d.size();
    if (count == 0) return {};
    const std::size_t last = count - 1;
    const std::size_t second = std::min<std::size_t>(1, last);
    const std::size_t third = std::min<std::size_t>(2, last);
    PathEnds ends{.path_steps = static_cast<double>(count)};
    ends.begins_up = height_before(d[0], d[second], d[third]) > kUp;
    ends.ends_up = height_before(d[last], d[last - second], d[last - third]) > kUp;
    if (count < kLeastClosed || !ends.begins_up || !ends.ends_up) return ends;
    double turned_rad = 0.0;
    for (std::size_t k = 1; k < count; ++k)
        turned_rad += bake::angle_between(d[k - 1], d[k]);
    ends.closed =
        bake::angle_between(d[last], d[0]) <= kMostGap * turned_rad / static_cast<double>(last);
    return ends;
}

BakePath bake_path(const SunPath& path, std::string place, std::string date) {
    BakePath result;
    result.pole_ws = path.pole_ws;
    result.place = std::move(place);
    result.date = std::move(date);
    result.summary = path.summary;
    result.utc_offset = path.noon.utc_offset;
    if (path.steps.empty()) return result;
    for (const SunStep& step : path.steps)
        result.to_light_ws.push_back(step.to_sun_ws);
    constexpr double kRadPerDeg = std::numbers::pi / 180.0;
    result.angular_diameter_rad = kRadPerDeg * path.noon_sun.angular_diameter_deg;
    const auto clock_s = [&](const CivilTime& time) {
        const auto local = time.utc + time.utc_offset;
        const auto noon_local = path.noon.utc + path.noon.utc_offset;
        const auto midnight = std::chrono::floor<std::chrono::days>(noon_local);
        return std::chrono::duration<double>(local - midnight).count();
    };
    const double first_s = clock_s(path.steps.front().time);
    const double half_s = 0.5 * path.times.daylight_s / static_cast<double>(path.steps.size());
    result.begin_s = first_s - half_s;
    result.end_s = result.begin_s + path.times.daylight_s;
    return result;
}

BakePath bake_path(const LightPath& path, int steps, double angular_diameter_rad) {
    if (path.kind() != LightPathKind::direction) {
        fail_input(
            "light path: goes through positions; a bake's light is far away: give directions");
    }
    if (path.keys().size() < 2) {
        fail_input("light path: has one key; a bake needs two or more, for a span of time");
    }
    if (!(angular_diameter_rad >= 0.0 && angular_diameter_rad <= std::numbers::pi)) {
        fail_input("light path: angular_diameter_rad is {}; it must be 0 to pi",
                   angular_diameter_rad);
    }
    BakePath result;
    for (const LightKey& step : path.steps(steps))
        result.to_light_ws.push_back(step.value_ws);
    result.pole_ws = axis_of(result.to_light_ws);
    result.begin_s = path.begin_s();
    result.end_s = path.end_s();
    result.angular_diameter_rad = angular_diameter_rad;
    result.summary = fmt::format("light path of {} keys, {:g} s to {:g} s", path.keys().size(),
                                 path.begin_s(), path.end_s());
    return result;
}

}  // namespace gnomon
