#include "visibility/light_fit.h"

#include "base/check.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/ext/vector_double4.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon {

namespace {

using DVec4 = glm::dvec4;
using Polygon = std::vector<DVec3>;

// Planes as (normal, offset): a point is inside when dot(normal, p) + offset >= 0.
double height(const DVec4& plane, const DVec3& p) {
    return glm::dot(DVec3(plane), p) + plane.w;
}

// I. Sutherland, G. Hodgman, "Reentrant Polygon Clipping", CACM 1974.
Polygon clip(const Polygon& polygon, const DVec4& plane) {
    Polygon inside;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const DVec3& a = polygon[i];
        const DVec3& b = polygon[(i + 1) % polygon.size()];
        const double height_a = height(plane, a);
        const double height_b = height(plane, b);
        if (height_a >= 0.0) inside.push_back(a);
        if ((height_a >= 0.0) != (height_b >= 0.0)) {
            inside.push_back(a + (b - a) * (height_a / (height_a - height_b)));
        }
    }
    return inside;
}

/// Eight corners (bit 0: x, bit 1: y, bit 2: z) to six quadrilaterals.
std::array<Polygon, 6> faces(const std::array<DVec3, 8>& c) {
    return {Polygon{c[0], c[2], c[6], c[4]}, Polygon{c[1], c[5], c[7], c[3]},
            Polygon{c[0], c[4], c[5], c[1]}, Polygon{c[2], c[3], c[7], c[6]},
            Polygon{c[0], c[1], c[3], c[2]}, Polygon{c[4], c[6], c[7], c[5]}};
}

/// Planes through the faces, with the corners' centre inside. Faces without area give none.
std::vector<DVec4> planes(const std::array<DVec3, 8>& corners) {
    DVec3 center(0.0);
    for (const DVec3& corner : corners)
        center += corner / 8.0;
    std::vector<DVec4> result;
    for (const Polygon& face : faces(corners)) {
        DVec3 normal = glm::cross(face[2] - face[0], face[3] - face[1]);
        const double length = glm::length(normal);
        if (!(length > 0.0)) continue;
        normal /= length;
        if (glm::dot(normal, center - face[0]) < 0.0) normal = -normal;
        result.emplace_back(normal, -glm::dot(normal, face[0]));
    }
    return result;
}

std::array<DVec3, 8> box_corners(const Box3& box, double grow_m) {
    std::array<DVec3, 8> corners;
    for (unsigned i = 0; i < 8; ++i) {
        corners[i] = {(i & 1) != 0 ? box.max.x + grow_m : box.min.x - grow_m,
                      (i & 2) != 0 ? box.max.y + grow_m : box.min.y - grow_m,
                      (i & 4) != 0 ? box.max.z + grow_m : box.min.z - grow_m};
    }
    return corners;
}

/// Corners of the part of the frustum between two distances.
std::array<DVec3, 8> frustum_corners(const Camera& camera, Extent size, DepthRange range) {
    const glm::dmat4 world_from_view = glm::inverse(glm::dmat4(camera.view_from_world));
    const double aspect = static_cast<double>(size.width) / size.height;
    std::array<DVec3, 8> corners;
    for (unsigned i = 0; i < 8; ++i) {
        const double distance_m = (i & 4) != 0 ? range.far_m : range.near_m;
        const double half_y = camera.ortho_height_m > 0.0f
                                  ? 0.5 * camera.ortho_height_m
                                  : distance_m * std::tan(0.5 * camera.fov_y_rad);
        const DVec4 p_vs((i & 1) != 0 ? half_y * aspect : -half_y * aspect,
                         (i & 2) != 0 ? half_y : -half_y, -distance_m, 1.0);
        corners[i] = DVec3(world_from_view * p_vs);
    }
    return corners;
}

/// `range` cut to where the camera and the box are; empty (far <= near) when it does not see it.
DepthRange range_within(const Camera& camera, const std::array<DVec3, 8>& box, DepthRange range) {
    double farthest_m = 0.0;
    for (const DVec3& corner : box) {
        farthest_m =
            std::max(farthest_m, -(glm::dmat4(camera.view_from_world) * DVec4(corner, 1.0)).z);
    }
    return {std::max(range.near_m, static_cast<double>(camera.near_m)),
            std::min(range.far_m, farthest_m)};
}

/// Boxes without thickness (a flat ground) get some, relative to their size, so that planes are
/// defined.
constexpr double kGrowth = 1e-4;

glm::dmat4 light_from_world(const DVec3& to_light, const DVec3& eye) {
    const DVec3 up = std::abs(to_light.y) > 0.99 ? DVec3(0, 0, -1) : DVec3(0, 1, 0);
    return glm::lookAtRH(eye, eye - to_light, up);
}

}  // namespace

std::vector<DVec3> visible_corners(const Camera& camera, Extent size, const Box3& bounds,
                                   DepthRange range) {
    if (bounds.empty()) return {};
    const double grow_m = kGrowth * std::max(bounds.diagonal(), 1e-3f);
    const std::array<DVec3, 8> box = box_corners(bounds, grow_m);
    range = range_within(camera, box, range);
    if (range.far_m <= range.near_m) return {};
    const std::array<DVec3, 8> frustum = frustum_corners(camera, size, range);

    std::vector<DVec3> corners;
    const auto add = [&](const std::array<DVec3, 8>& from, const std::array<DVec3, 8>& by) {
        const std::vector<DVec4> clip_planes = planes(by);
        for (Polygon face : faces(from)) {
            for (const DVec4& plane : clip_planes)
                face = clip(face, plane);
            corners.insert(corners.end(), face.begin(), face.end());
        }
    };
    add(box, frustum);
    add(frustum, box);
    return corners;
}

std::vector<DVec4> visible_planes(const Camera& camera, Extent size, const Box3& bounds,
                                  DepthRange range) {
    if (bounds.empty()) return {};
    range = range_within(camera, box_corners(bounds, 0.0), range);
    if (range.far_m <= range.near_m) return {};
    std::vector<DVec4> result = planes(frustum_corners(camera, size, range));
    for (int axis = 0; axis < 3; ++axis) {
        DVec4 from_below(0.0);
        from_below[axis] = 1.0;
        result.push_back(from_below - DVec4(0.0, 0.0, 0.0, bounds.min[axis]));
        result.push_back(DVec4(0.0, 0.0, 0.0, bounds.max[axis]) - from_below);
    }
    return result;
}

// A step across the light moves the map's image by the 2x3 matrix of the gradients of its
// coordinates; the step that moves it least for its length is one along the longer side of a texel,
// and by how much is the matrix's smaller singular value.
float LightFit::texel_size_m(Vec3 p_ws) const {
    const glm::dmat4 rows = glm::transpose(glm::dmat4(clip_from_world));
    const DVec4 p(DVec3(p_ws), 1.0);
    const double w = glm::dot(rows[3], p);
    if (!(w > 0.0)) return 0.0f;
    const double scale = 0.5 * size_texels / w;
    const DVec3 u = scale * DVec3(rows[0] - glm::dot(rows[0], p) / w * rows[3]);
    const DVec3 v = scale * DVec3(rows[1] - glm::dot(rows[1], p) / w * rows[3]);
    const double mean = 0.5 * (glm::dot(u, u) + glm::dot(v, v));
    const double difference = std::hypot(0.5 * (glm::dot(u, u) - glm::dot(v, v)), glm::dot(u, v));
    // The product of both singular values is exact where their difference would not be.
    const DVec3 product = glm::cross(u, v);
    return static_cast<float>(std::sqrt((mean + difference) / glm::dot(product, product)));
}

LightFit fit_directional(const DirectionalLight& light, std::span<const DVec3> receivers_ws,
                         const Box3& bounds, unsigned size_texels, float margin_texels) {
    const DVec3 to_light = glm::normalize(DVec3(light.to_light_ws));
    const DVec3 center = bounds.empty() ? DVec3(0.0) : DVec3(bounds.center());
    const glm::dmat4 view = light_from_world(to_light, center);

    DVec3 low(1e30), high(-1e30);
    for (const DVec3& corner : receivers_ws) {
        const DVec3 p(view * DVec4(corner, 1.0));
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    if (low.x > high.x) low = high = DVec3(0.0);  // nothing is seen: any map will do
    // Casters reach from the scene's nearest point to the light down to the farthest receiver.
    if (!bounds.empty()) {
        for (const DVec3& corner : box_corners(bounds, kGrowth * bounds.diagonal())) {
            high.z = std::max(high.z, (view * DVec4(corner, 1.0)).z);
            low.z = std::min(low.z, (view * DVec4(corner, 1.0)).z);
        }
    }
    const double side = std::max({high.x - low.x, high.y - low.y, 1e-6});
    const double used_texels =
        std::max(1.0, size_texels - 2.0 * static_cast<double>(margin_texels));
    const double texel_m = side / used_texels;
    const double depth_m = std::max(high.z - low.z, texel_m);

    glm::dmat4 clip(1.0);
    const double scale = 2.0 / (texel_m * size_texels);
    clip[0][0] = scale;
    clip[1][1] = scale;
    clip[2][2] = 1.0 / depth_m;
    clip[3] = DVec4(-scale * 0.5 * (low.x + high.x), -scale * 0.5 * (low.y + high.y),
                    1.0 - high.z / depth_m, 1.0);
    LightFit fit;
    fit.clip_from_world = Mat4(clip * view);
    fit.size_texels = size_texels;
    return fit;
}

LightFit fit_spot(const SpotLight& light, const Box3& bounds, unsigned size_texels,
                  float margin_texels) {
    constexpr float kMaxHalfAngleRad = radians(80.0f);
    if (light.outer_angle_rad > kMaxHalfAngleRad) {
        fail_input("a spot of {:.4g}° does not fit one map; at most 160° do",
                   2.0f * degrees(light.outer_angle_rad));
    }
    // Nearer than this to the light nothing is resolved; reversed Z keeps precision all the same.
    constexpr double kNearFraction = 1e-4;
    const double near_m = kNearFraction * std::max(bounds.diagonal(), 1e-3f);
    const double used_texels =
        std::max(1.0, size_texels - 2.0 * static_cast<double>(margin_texels));
    const double half =
        std::tan(static_cast<double>(light.outer_angle_rad)) * size_texels / used_texels;

    const DVec3 axis = glm::normalize(DVec3(light.direction_ws));
    const glm::dmat4 view = light_from_world(-axis, DVec3(light.position_ws));
    glm::dmat4 clip(0.0);
    clip[0][0] = clip[1][1] = 1.0 / half;
    clip[3][2] = near_m;
    clip[2][3] = -1.0;
    LightFit fit;
    fit.clip_from_world = Mat4(clip * view);
    fit.size_texels = size_texels;
    fit.affine = false;
    return fit;
}

}  // namespace gnomon
