#include <gnomon/sun_hours.h>

#include "base/check.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

constexpr double kMaxGridPoints = 1e7;

/// The squares that cover a rectangle.
Extent size_of(double width_m, double height_m, double spacing_m) {
    const auto cells = [&](double side_m) {
        return std::max(1.0, std::ceil(side_m / spacing_m - 1e-6));  // sides are floats
    };
    const double columns = cells(width_m), rows = cells(height_m);
    if (!(spacing_m > 0.0) || !(columns * rows <= kMaxGridPoints) ||
        !(std::max(columns, rows) <= Image::kMaxSide_px)) {
        fail_input(
            "grid: a spacing of {} m over {:.6g} x {:.6g} m; it must be above 0, and make "
            "at most {:.0f} points, {} along a side",
            spacing_m, width_m, height_m, kMaxGridPoints, Image::kMaxSide_px);
    }
    return {static_cast<unsigned>(columns), static_cast<unsigned>(rows)};
}

/// From the end of a side to the first of so many points in its middle.
double margin_m(double side_m, unsigned count, double spacing_m) {
    return 0.5 * (side_m - (count - 1.0) * spacing_m);
}

}  // namespace

std::vector<SunSensor> SunGrid::sensors() const {
    std::vector<SunSensor> sensors;
    sensors.reserve(std::size_t{size.width} * size.height);
    for (unsigned row = 0; row < size.height; ++row) {
        for (unsigned column = 0; column < size.width; ++column) {
            const double across_m = spacing_m * column, down_m = spacing_m * row;
            sensors.push_back({first_ws + across_m * right_ws + down_m * down_ws, normal_ws});
        }
    }
    return sensors;
}

SunGrid make_sun_grid(const Scene& scene, double spacing_m, std::optional<double> height_ws_m) {
    constexpr double kOverGround_m = 1.0;
    const Box3 bounds = scene.bounds();
    if (bounds.empty()) fail_input("grid: the scene \"{}\" has no triangles", scene.source());
    const DVec3 low(bounds.min), sides(bounds.size());
    SunGrid grid{.spacing_m = spacing_m, .size = size_of(sides.x, sides.z, spacing_m)};
    grid.first_ws = {low.x + margin_m(sides.x, grid.size.width, spacing_m),
                     height_ws_m.value_or(low.y + kOverGround_m),
                     low.z + margin_m(sides.z, grid.size.height, spacing_m)};
    return grid;
}

SunGrid make_sun_grid(const SunPlane& plane, double spacing_m) {
    constexpr double kMostCosine = 1e-3;  // between the edges: 0.06 degrees from a right angle
    const double width_m = glm::length(plane.u_ws), height_m = glm::length(plane.v_ws);
    if (!(width_m > 0.0) || !(height_m > 0.0) || !std::isfinite(width_m + height_m) ||
        !(std::abs(glm::dot(plane.u_ws, plane.v_ws)) <= kMostCosine * width_m * height_m)) {
        fail_input(
            "grid: a plane with the edges ({:.6g}, {:.6g}, {:.6g}) and ({:.6g}, {:.6g}, {:.6g}); "
            "they must be finite, of some length, and at right angles",
            plane.u_ws.x, plane.u_ws.y, plane.u_ws.z, plane.v_ws.x, plane.v_ws.y, plane.v_ws.z);
    }
    SunGrid grid{.spacing_m = spacing_m, .size = size_of(width_m, height_m, spacing_m)};
    grid.right_ws = plane.u_ws / width_m;
    grid.normal_ws = glm::normalize(glm::cross(plane.u_ws, plane.v_ws));
    grid.down_ws = glm::cross(grid.normal_ws, grid.right_ws);
    grid.first_ws = plane.corner_ws +
                    margin_m(width_m, grid.size.width, spacing_m) * grid.right_ws +
                    margin_m(height_m, grid.size.height, spacing_m) * grid.down_ws;
    return grid;
}

}  // namespace gnomon
