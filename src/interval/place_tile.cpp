#include "interval/place_tile.h"

#include "interval/magnitudes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::interval {

namespace {

using trace::kUnitRoundoff;
using trace::Receiver;

/// Tiles are plane to this part of their size, or they are taken apart: what is not plane is taken
/// for an error of float, and left to double.
constexpr double kPlane = 1e-4;

/// The axes are a little longer than the tile, so that no s or t is rounded to more than 1.
constexpr double kLonger = 1.0 + 1e-5;

/// The normal is a unit vector and at right angles to the axes to kPlane.
constexpr double kFrameError = 1.0 + 10.0 * kPlane;

void store(float (&to)[3], DVec3 v) {
    for (int axis = 0; axis < 3; ++axis)
        to[axis] = static_cast<float>(v[axis]);
}

DVec3 loaded(const float (&from)[3]) {
    return {from[0], from[1], from[2]};
}

/// Around the receivers: its centre, and half of its sides.
struct Rectangle {
    DVec3 center, half_u, half_v;
};

/// With a side along `u`, a unit vector in the plane of the receivers. No side is much shorter than
/// the other: lines of receivers have coordinates, too.
Rectangle rectangle_along(std::span<const DVec3> origins, DVec3 normal, DVec3 u) {
    constexpr double kLeastSide = 1.0 / 16.0;
    const DVec3 v = glm::cross(normal, u);
    double low_u = 0.0, high_u = 0.0, low_v = 0.0, high_v = 0.0;
    for (const DVec3& origin : origins) {
        const double along_u = glm::dot(origin - origins[0], u);
        const double along_v = glm::dot(origin - origins[0], v);
        low_u = std::min(low_u, along_u);
        high_u = std::max(high_u, along_u);
        low_v = std::min(low_v, along_v);
        high_v = std::max(high_v, along_v);
    }
    const double length_u = high_u - low_u, length_v = high_v - low_v;
    return {origins[0] + 0.5 * (low_u + high_u) * u + 0.5 * (low_v + high_v) * v,
            0.5 * kLonger * std::max(length_u, kLeastSide * length_v) * u,
            0.5 * kLonger * std::max(length_v, kLeastSide * length_u) * v};
}

/// Along the way from the first receiver to the next, which fits rows of texels; or, where most of
/// that is empty, along that to the farthest, a diagonal of a square of texels, which fits lines,
/// if it is smaller. Receivers at one place have a little one.
Rectangle rectangle_around(std::span<const DVec3> origins, DVec3 normal) {
    constexpr double kLeastHalf_m = 1e-3, kMostlyEmpty = 2.0;
    const auto far_from_first = [&](DVec3 p) { return glm::dot(p - origins[0], p - origins[0]); };
    const auto towards = [&](DVec3 p) {
        return rectangle_along(origins, normal, glm::normalize(p - origins[0]));
    };
    const auto area = [](const Rectangle& r) {
        return 4.0 * glm::length(r.half_u) * glm::length(r.half_v);
    };
    const double spacing2 = far_from_first(origins[1]);
    Rectangle row{};
    if (spacing2 > 0.0) {
        row = towards(origins[1]);
        const double full = static_cast<double>(origins.size()) * spacing2;
        if (area(row) < kMostlyEmpty * full) return row;
    }
    const DVec3 farthest = *std::ranges::max_element(origins, {}, far_from_first);
    if (!(far_from_first(farthest) > 0.0)) {
        const DVec3 any =
            std::abs(normal.x) < std::abs(normal.y) ? DVec3(1.0, 0.0, 0.0) : DVec3(0.0, 1.0, 0.0);
        const DVec3 u = glm::normalize(glm::cross(normal, any));
        return {origins[0], kLeastHalf_m * u, kLeastHalf_m * glm::cross(normal, u)};
    }
    const Rectangle diagonal = towards(farthest);
    return spacing2 > 0.0 && area(row) < area(diagonal) ? row : diagonal;
}

/// Along `axis` from 0 to 1; nowhere without one.
DVec3 gradient_along(DVec3 axis) {
    const double length2 = glm::dot(axis, axis);
    return length2 > 0.0 ? axis / length2 : DVec3(0.0);
}

/// Sets what Tile::touch_m promises, and what height_over_tile() needs. No origin is farther than
/// `height_m` from the plane through the tile's centre.
void set_heights(Tile& tile, const Tree& tree, std::span<const Receiver> receivers,
                 double height_m) {
    const DVec3 normal(receivers[0].normal_ws);
    const DVec3 normal_magnitudes = magnitudes(normal);
    double magnitude_m = 0.0;
    tile.low_height_m = tile.low_magnitude_m = std::numeric_limits<double>::infinity();
    tile.high_height_m = tile.high_magnitude_m = -tile.low_height_m;
    for (const Receiver& receiver : receivers) {
        const DVec3 position(receiver.position_ws);
        const double height = glm::dot(normal, position - DVec3(receivers[0].position_ws));
        tile.low_height_m = std::min(tile.low_height_m, height);
        tile.high_height_m = std::max(tile.high_height_m, height);
        const double along_normal = glm::dot(normal_magnitudes, magnitudes(position));
        tile.low_magnitude_m = std::min(tile.low_magnitude_m, along_normal);
        tile.high_magnitude_m = std::max(tile.high_magnitude_m, along_normal);
        magnitude_m = std::max(magnitude_m, sum_of_magnitudes(position));
    }
    // Of lifted_position_ws(), whose sum is rounded as well.
    const double lift_m = kUnitRoundoff * (2.0 * sum_of_magnitudes(normal) + 1.0) * magnitude_m;
    const double tolerated_m =
        trace::kHeightRoundings * kUnitRoundoff * (tree.magnitude_m() + magnitude_m);
    tile.touch_m = static_cast<float>(
        kLonger * (tolerated_m + lift_m + tile.residual_m + height_m +
                   2.0 * kUnitRoundoff * sum_of_magnitudes(loaded(tile.center_m))));
}

/// The axes of the tile; a single receiver has none.
void set_frame(Tile& tile, std::span<const DVec3> origins, DVec3 normal) {
    Rectangle around{origins[0], DVec3(0.0), DVec3(0.0)};
    if (origins.size() > 1) {
        around = rectangle_around(origins, normal);
        // The centre is stored as floats: no receiver is to have a coordinate beyond 1 for that.
        const double rounding_m = 2.0 * kUnitRoundoff * sum_of_magnitudes(around.center);
        around.half_u += rounding_m * glm::normalize(around.half_u);
        around.half_v += rounding_m * glm::normalize(around.half_v);
    }
    store(tile.center_m, around.center);
    store(tile.u_axis_m, around.half_u);
    store(tile.v_axis_m, around.half_v);
    store(tile.normal, normal);
    const DVec3 along_s = gradient_along(around.half_u), along_t = gradient_along(around.half_v);
    store(tile.s_per_m, along_s);
    store(tile.t_per_m, along_t);
    const double s_per_m = glm::length(along_s), t_per_m = glm::length(along_t);
    tile.per_m = static_cast<float>(kFrameError * std::max(s_per_m, t_per_m));
    tile.per_m2 = static_cast<float>(kFrameError * s_per_m * t_per_m);
    tile.size_m = static_cast<float>(
        kLonger * (sum_of_magnitudes(around.half_u) + sum_of_magnitudes(around.half_v)));
}

}  // namespace

bool set_tile(Tile& tile, std::span<DVec3> origins, const Tree& tree,
              std::span<const Receiver> receivers) {
    std::ranges::transform(receivers, origins.begin(), [&](const Receiver& receiver) {
        return tree.from_world(DVec3(trace::lifted_position_ws(receiver)));
    });
    const DVec3 normal = tree.frame().from_world(DVec3(receivers[0].normal_ws));
    set_frame(tile, origins, normal);
    const DVec3 u = loaded(tile.u_axis_m), v = loaded(tile.v_axis_m);
    const DVec3 along_s = loaded(tile.s_per_m), along_t = loaded(tile.t_per_m);
    std::ranges::fill(tile.s, 0.0f);
    std::ranges::fill(tile.t, 0.0f);
    DVec3 lower(std::numeric_limits<double>::infinity()), upper = -lower;
    double residual_m = 0.0, height_m = 0.0;
    for (std::size_t i = 0; i < origins.size(); ++i) {
        const DVec3 offset = origins[i] - loaded(tile.center_m);
        tile.s[i] = static_cast<float>(glm::dot(offset, along_s));
        tile.t[i] = static_cast<float>(glm::dot(offset, along_t));
        const DVec3 rest = offset - double{tile.s[i]} * u - double{tile.t[i]} * v;
        residual_m = std::max(residual_m, sum_of_magnitudes(rest));
        height_m = std::max(height_m, std::abs(glm::dot(normal, offset)));
        lower = glm::min(lower, origins[i]);
        upper = glm::max(upper, origins[i]);
    }
    const double reach_m = std::max(double{tree.reach_m()},
                                    glm::length(glm::max(magnitudes(lower), magnitudes(upper))));
    const double rounding_m = 4.0 * kUnitRoundoff * reach_m;
    // Two receivers always lie on a line, but perhaps on a steep one.
    const double plane_m = kPlane * (glm::length(u) + glm::length(v)) + rounding_m;
    if (std::max(residual_m, height_m) > plane_m) return false;
    tile.receivers = receivers.data();
    tile.texels = static_cast<int>(receivers.size());
    tile.residual_m = static_cast<float>(kLonger * std::max(residual_m, height_m));
    store(tile.lower_m, lower - 2.0 * rounding_m);
    store(tile.upper_m, upper + 2.0 * rounding_m);
    set_heights(tile, tree, receivers, height_m);
    return true;
}

}  // namespace gnomon::interval
