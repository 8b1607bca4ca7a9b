#include <gnomon/bake.h>

#include <chrono>
#include <numbers>
#include <utility>

namespace gnomon {

BakePath bake_path(const SunPath& path, std::string place, std::string date) {
    BakePath result;
    result.pole_ws = path.pole_ws;
    result.place = std::move(place);
    result.date = std::move(date);
    result.summary = path.summary;
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

}  // namespace gnomon
