#include <gnomon/sun_hours.h>

#include "base/check.h"

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

constexpr double kMaxGridPoints = 1e7;

}  // namespace

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
