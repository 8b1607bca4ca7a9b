#include <gnomon/sun_hours.h>

#include "base/check.h"
#include "base/file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

namespace gnomon {

namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 30;
constexpr std::size_t kNumbers = 6, kNumbersFacingUp = 3;
constexpr double kMaxGridPoints = 1e7;

std::string_view trimmed(std::string_view text) {
    const auto is_space = [](unsigned char c) { return std::isspace(c) != 0; };
    while (!text.empty() && is_space(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && is_space(text.back()))
        text.remove_suffix(1);
    return text;
}

/// A line and where it is, for errors.
struct Line {
    std::string_view name, text;
    std::size_t number;
};

double number_of(const Line& line, std::string_view word) {
    std::string_view digits = trimmed(word);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    double value = 0.0;
    const char* const end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, value);
    if (error != std::errc{} || stop != end || !std::isfinite(value)) {
        fail_input("{}, line {}: \"{}\" is no finite number", line.name, line.number,
                   trimmed(word));
    }
    return value;
}

SunSensor sensor_of(const Line& line, DVec3 up) {
    std::array<double, kNumbers> numbers{};
    std::size_t count = 0;
    std::string_view rest = line.text;
    for (bool more = true; more; ++count) {
        const std::size_t end = std::min(rest.find_first_of(",;\t"), rest.size());
        if (count < kNumbers) numbers[count] = number_of(line, rest.substr(0, end));
        more = end < rest.size();
        rest.remove_prefix(more ? end + 1 : end);
    }
    if (count != kNumbers && count != kNumbersFacingUp) {
        fail_input("{}, line {}: has {} values; it must be x,y,z,nx,ny,nz, or x,y,z to face up",
                   line.name, line.number, count);
    }
    const DVec3 position(numbers[0], numbers[1], numbers[2]);
    if (count == kNumbersFacingUp) return {position, up};
    const DVec3 normal(numbers[3], numbers[4], numbers[5]);
    if (!(glm::length(normal) > 0.0)) {
        fail_input("{}, line {}: the normal 0,0,0 faces nowhere", line.name, line.number);
    }
    return {position, normal};
}

}  // namespace

std::vector<SunSensor> parse_sun_sensors(std::string_view text, std::string_view name, DVec3 up) {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
    std::vector<SunSensor> sensors;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const Line line{name, trimmed(text.substr(0, end)), number};
        text.remove_prefix(std::min(end + 1, text.size()));
        const bool heading = number == 1 && !line.text.empty() &&
                             (std::isalpha(static_cast<unsigned char>(line.text.front())) != 0 ||
                              line.text.front() == '"');
        if (line.text.empty() || line.text.starts_with('#') || heading) continue;
        sensors.push_back(sensor_of(line, up));
    }
    if (sensors.empty()) fail_input("{}: has no points; a line is x,y,z,nx,ny,nz", name);
    return sensors;
}

std::vector<SunSensor> read_sun_sensors(const std::filesystem::path& path, DVec3 up) {
    const std::vector<std::uint8_t> bytes = read_file(path, kMaxFileBytes);
    return parse_sun_sensors({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                             path.string(), up);
}

std::vector<SunSensor> SunGrid::sensors() const {
    std::vector<SunSensor> sensors;
    sensors.reserve(std::size_t{size.width} * size.height);
    for (unsigned row = 0; row < size.height; ++row) {
        for (unsigned column = 0; column < size.width; ++column)
            sensors.push_back({first_ws + spacing_m * DVec3(column, 0.0, row)});
    }
    return sensors;
}

SunGrid make_sun_grid(const Scene& scene, double spacing_m, std::optional<double> height_ws_m) {
    constexpr double kOverGround_m = 1.0;
    const Box3 bounds = scene.bounds();
    if (bounds.empty()) fail_input("grid: the scene \"{}\" has no triangles", scene.source());
    const DVec3 low(bounds.min), sides(bounds.size());
    const auto cells = [&](double side_m) {
        return std::max(1.0, std::ceil(side_m / spacing_m - 1e-6));  // sides are floats
    };
    if (!(spacing_m > 0.0) || !(cells(sides.x) * cells(sides.z) <= kMaxGridPoints) ||
        !(std::max(cells(sides.x), cells(sides.z)) <= Image::kMaxSide_px)) {
        fail_input(
            "grid: a spacing of {} m over {:.6g} x {:.6g} m; it must be above 0, and make "
            "at most {:.0f} points, {} along a side",
            spacing_m, sides.x, sides.z, kMaxGridPoints, Image::kMaxSide_px);
    }
    SunGrid grid;
    grid.spacing_m = spacing_m;
    grid.size = {static_cast<unsigned>(cells(sides.x)), static_cast<unsigned>(cells(sides.z))};
    grid.height_ws_m = height_ws_m.value_or(low.y + kOverGround_m);
    const auto first = [&](double from_m, double side_m, unsigned count) {
        return from_m + 0.5 * (side_m - (count - 1.0) * spacing_m);
    };
    grid.first_ws = {first(low.x, sides.x, grid.size.width), grid.height_ws_m,
                     first(low.z, sides.z, grid.size.height)};
    return grid;
}

}  // namespace gnomon
