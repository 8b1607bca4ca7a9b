// The chapter thinks in two steps: the camera's projection, then the light's in what that gives.
// Both are one matrix, and in homogeneous coordinates its rows are linear in the light's image q:
// that spares divisions by q.w, which is 0 for a light that is neither before nor behind the
// camera, and signs, which turn with it.

#include "post_projective.h"

#include "base/smallest_rectangle.h"

#include <glm/ext/vector_double2.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::psm {

namespace {

using DVec2 = glm::dvec2;
using DVec4 = glm::dvec4;

/// Of the length of the light's image: what is less is taken to be none, a turn of 1e-8 rad.
constexpr double kLeastW = 1e-8;

DVec4 image_of_light(const glm::dmat4& clip, const DVec4& light_ws) {
    DVec4 q = clip * light_ws;
    if (std::abs(q.w) < kLeastW * glm::length(DVec3(q))) q.w = 0.0;
    return q;
}

DVec3 any_across(const DVec3& axis) {
    return glm::normalize(
        glm::cross(axis, std::abs(axis.x) < 0.6 ? DVec3(1, 0, 0) : DVec3(0, 1, 0)));
}

DVec3 projected(const glm::dmat4& clip, const DVec3& p_ws) {
    const DVec4 p = clip * DVec4(p_ws, 1.0);
    return DVec3(p) / p.w;
}

/// Combination of the camera's rows.
DVec4 row(const glm::dmat4& rows, const DVec3& xyz, double w) {
    return xyz.x * rows[0] + xyz.y * rows[1] + xyz.z * rows[2] + w * rows[3];
}

void turn_to_smallest_rectangle(Projection& projection, std::span<const DVec3> seen_ws) {
    std::vector<DVec2> image;
    for (const DVec3& p_ws : seen_ws) {
        const DVec4 p(p_ws, 1.0);
        image.push_back(DVec2(glm::dot(projection.x, p), glm::dot(projection.y, p)) /
                        glm::dot(projection.w, p));
    }
    const DVec2 axis = smallest_rectangle(std::move(image)).axis;
    const DVec4 x = projection.x;
    projection.x = axis.x * x + axis.y * projection.y;
    projection.y = axis.x * projection.y - axis.y * x;
}

}  // namespace

glm::dmat4 VirtualCamera::clip_from_world() const {
    glm::dmat4 clip(0.0);
    clip[0][0] = 1.0 / tan_half_x;
    clip[1][1] = 1.0 / tan_half_y;
    clip[2][2] = -(far_m + near_m) / (far_m - near_m);
    clip[3][2] = -2.0 * far_m * near_m / (far_m - near_m);
    clip[2][3] = -1.0;
    return clip * view_from_world;
}

std::vector<DVec3> VirtualCamera::corners_ws() const {
    const glm::dmat4 world_from_view = glm::inverse(view_from_world);
    std::vector<DVec3> corners;
    for (unsigned i = 0; i < 8; ++i) {
        const double distance_m = (i & 4) != 0 ? far_m : near_m;
        const DVec3 p_vs((i & 1) != 0 ? tan_half_x : -tan_half_x,
                         (i & 2) != 0 ? tan_half_y : -tan_half_y, -1.0);
        corners.emplace_back(world_from_view * DVec4(distance_m * p_vs, 1.0));
    }
    return corners;
}

glm::dvec4 VirtualCamera::infinity_ws() const {
    return -glm::transpose(view_from_world)[2];
}

VirtualCamera virtual_camera(const Camera& camera, Extent size, DepthRange range) {
    const double tan_half_y = std::tan(0.5 * static_cast<double>(camera.fov_y_rad));
    return {.view_from_world = glm::dmat4(camera.view_from_world),
            .near_m = range.near_m,
            .far_m = range.far_m,
            .tan_half_x = tan_half_y * size.width / size.height,
            .tan_half_y = tan_half_y};
}

// Narrower, so that the farthest of what the view camera sees just stays in view.
VirtualCamera slid(const VirtualCamera& camera, double slide_m) {
    VirtualCamera back = camera;
    back.view_from_world[3].z -= slide_m;
    back.near_m += slide_m;
    back.far_m += slide_m;
    back.tan_half_x *= camera.far_m / back.far_m;
    back.tan_half_y *= camera.far_m / back.far_m;
    return back;
}

VirtualCamera slid_behind(const VirtualCamera& camera, const Box3& bounds) {
    double slide_m = 0.0, nearest_m = camera.near_m, farthest_m = camera.far_m;
    for (unsigned i = 0; i < 8; ++i) {
        const DVec3 corner((i & 1) != 0 ? bounds.max.x : bounds.min.x,
                           (i & 2) != 0 ? bounds.max.y : bounds.min.y,
                           (i & 4) != 0 ? bounds.max.z : bounds.min.z);
        const DVec3 p_vs(camera.view_from_world * DVec4(corner, 1.0));
        const double wanted_m =
            std::max(std::abs(p_vs.x) / camera.tan_half_x, std::abs(p_vs.y) / camera.tan_half_y);
        slide_m = std::max({slide_m, wanted_m + p_vs.z, camera.near_m + p_vs.z});
        nearest_m = std::min(nearest_m, -p_vs.z);
        farthest_m = std::max(farthest_m, -p_vs.z);
    }
    VirtualCamera back = camera;
    back.view_from_world[3].z -= slide_m;
    back.near_m = nearest_m + slide_m;
    back.far_m = farthest_m + slide_m;
    return back;
}

glm::dmat4 Projection::image_from_world(const DVec4& depth) const {
    return glm::transpose(glm::dmat4(x, y, depth, w));
}

std::array<DVec4, 4> Projection::planes() const {
    std::array<DVec4, 4> sides{w - x, w + x, w - y, w + y};
    for (DVec4& side : sides)
        side /= glm::length(DVec3(side));
    return sides;
}

// A line through the light's image Q = q / q.w and a point X / W: with u across the light camera's
// axis a, the map's x is u.(X / W - Q) / a.(X / W - Q).
Projection light_camera(const VirtualCamera& camera, const DVec4& light_ws,
                        std::span<const DVec3> seen_ws) {
    const glm::dmat4 clip = camera.clip_from_world();
    const glm::dmat4 rows = glm::transpose(clip);
    const DVec4 q = image_of_light(clip, light_ws);
    const double sign = q.w < 0.0 ? -1.0 : 1.0;

    std::vector<DVec3> directions;
    for (const DVec3& p_ws : seen_ws)
        directions.push_back(glm::normalize(sign * (q.w * projected(clip, p_ws) - DVec3(q))));
    const DVec3 axis = narrowest_cone_axis(directions);
    const DVec3 across = any_across(axis);
    const DVec3 other = glm::cross(axis, across);
    const auto along = [&](const DVec3& direction) {
        return row(rows, sign * q.w * direction, -sign * glm::dot(direction, DVec3(q)));
    };
    Projection projection{along(across), along(other), along(axis), {}};
    if (q.w == 0.0) {  // all rays are parallel in the cube
        projection.x = row(rows, across, 0.0);
        projection.y = row(rows, other, 0.0);
        projection.w = rows[3];
    }
    turn_to_smallest_rectangle(projection, seen_ws);
    return projection;
}

std::vector<Projection> cube_faces(const VirtualCamera& camera, const DVec4& light_ws) {
    const glm::dmat4 clip = camera.clip_from_world();
    const glm::dmat4 rows = glm::transpose(clip);
    const DVec4 q = image_of_light(clip, light_ws);
    std::vector<Projection> faces;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {1.0, -1.0}) {
            DVec3 outwards(0.0), u(0.0), v(0.0);
            outwards[axis] = sign;
            u[(axis + 1) % 3] = 1.0;
            v[(axis + 2) % 3] = 1.0;
            // Of the light from the face's plane, inwards, times q.w.
            const double inwards = q.w - glm::dot(outwards, DVec3(q));
            const bool faces_away = q.w < 0.0 ? inwards < 0.0 : inwards > 0.0;
            if (!faces_away) continue;
            const auto on_face = [&](const DVec3& direction) {
                const double part = glm::dot(direction, DVec3(q)) / inwards;
                return row(rows, direction + part * outwards, -part);
            };
            faces.push_back(
                {on_face(u), on_face(v),
                 row(rows, q.w / inwards * outwards, -glm::dot(outwards, DVec3(q)) / inwards)});
            for (const DVec3& corner_ws : camera.corners_ws()) {
                if (glm::dot(outwards, projected(clip, corner_ws)) > 0.0)
                    faces.back().corners_ws.push_back(corner_ws);
            }
        }
    }
    return faces;
}

// The cone's axis goes through the centre of the smallest ball around the unit vectors: M. Badoiu,
// K. Clarkson, "Smaller Core-Sets for Balls", SODA 2003, steps towards the farthest point.
DVec3 narrowest_cone_axis(std::span<const DVec3> directions) {
    constexpr int kSteps = 400;
    DVec3 center = directions.front();
    for (int step = 1; step <= kSteps; ++step) {
        const DVec3 farthest = *std::ranges::max_element(
            directions, {}, [&](const DVec3& d) { return glm::dot(d - center, d - center); });
        center += (farthest - center) / (step + 1.0);
    }
    return glm::normalize(center);
}

}  // namespace gnomon::psm
