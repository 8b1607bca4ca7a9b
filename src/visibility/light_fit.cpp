#include "visibility/light_fit.h"

#include "base/smallest_rectangle.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/ext/vector_double4.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

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

/// Corners of the convex body within all planes, some more than once; it lies within a ball. A
/// corner lies in three planes: what the others leave of each plane's own polygon has it.
std::vector<DVec3> corners_of(std::span<const DVec4> sides, const DVec3& center, double radius_m) {
    std::vector<DVec3> corners;
    for (const DVec4& side : sides) {
        const DVec3 normal(side);
        const DVec3 u =
            radius_m * glm::normalize(glm::cross(
                           normal, std::abs(normal.x) < 0.6 ? DVec3(1, 0, 0) : DVec3(0, 1, 0)));
        const DVec3 v = glm::cross(normal, u);
        const DVec3 middle = center - height(side, center) * normal;
        Polygon polygon{middle - u - v, middle + u - v, middle + u + v, middle - u + v};
        for (const DVec4& other : sides) {
            if (&other != &side) polygon = clip(polygon, other);
        }
        corners.insert(corners.end(), polygon.begin(), polygon.end());
    }
    return corners;
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

/// Least side of a map, and least part of its longer side that its shorter one is: what is thinner
/// needs no finer texels.
constexpr double kLeastMap_m = 1e-6;
constexpr double kLeastAspect = 1e-3;

glm::dmat4 light_from_world(const DVec3& to_light, const DVec3& eye) {
    const DVec3 up = std::abs(to_light.y) > 0.99 ? DVec3(0, 0, -1) : DVec3(0, 1, 0);
    return glm::lookAtRH(eye, eye - to_light, up);
}

/// What a parallel map covers, across the light.
struct Footprint {
    glm::dmat4 light_from_world;
    glm::dvec2 center;
    glm::dvec2 axis;  ///< unit vector along `size_m.x`
    glm::dvec2 size_m;
};

/// Heights towards the light of the lowest receiver and of the highest caster.
struct CastersRange {
    double low_m = 0.0, high_m = 0.0;
};

/// Of all that is in the scene.
CastersRange casters_range(const glm::dmat4& view, const Box3& bounds) {
    if (bounds.empty()) return {};
    CastersRange range{std::numeric_limits<double>::infinity(),
                       -std::numeric_limits<double>::infinity()};
    for (const DVec3& corner : box_corners(bounds, kGrowth * bounds.diagonal())) {
        const double height_m = (view * DVec4(corner, 1.0)).z;
        range.low_m = std::min(range.low_m, height_m);
        range.high_m = std::max(range.high_m, height_m);
    }
    return range;
}

/// The range widened to steps of about a sixteenth of it: a map can rest while what moves in the
/// scene changes its bounds a little.
CastersRange in_steps(CastersRange range) {
    constexpr double kSteps = 16.0;
    const double length_m = std::max(range.high_m - range.low_m, kLeastMap_m);
    const double step_m = std::exp2(std::floor(std::log2(length_m))) / kSteps;
    return {std::floor(range.low_m / step_m) * step_m, std::ceil(range.high_m / step_m) * step_m};
}

LightFit parallel_fit(const Footprint& footprint, CastersRange range, unsigned size_texels,
                      float margin_texels) {
    const double used_share = used_texels(size_texels, margin_texels) / size_texels;
    const glm::dvec2 scale = 2.0 * used_share / footprint.size_m;
    const glm::dvec2 along = footprint.axis;
    const double depth_m = std::max(range.high_m - range.low_m, kLeastAspect * footprint.size_m.x);
    glm::dmat4 clip(1.0);
    clip[0] = {scale.x * along.x, -scale.y * along.y, 0.0, 0.0};
    clip[1] = {scale.x * along.y, scale.y * along.x, 0.0, 0.0};
    clip[2][2] = 1.0 / depth_m;
    clip[3] = DVec4(0.0, 0.0, 1.0 - range.high_m / depth_m, 1.0);
    clip[3] -= DVec4(glm::dvec2(clip * DVec4(footprint.center, 0.0, 0.0)), 0.0, 0.0);
    LightFit fit;
    fit.clip_from_world = clip * footprint.light_from_world;
    fit.size_texels = size_texels;
    return fit;
}

}  // namespace

float depth_at(const Camera& camera, Extent size, double distance_m) {
    const DVec4 p = glm::dmat4(camera.clip_from_view(size)) * DVec4(0.0, 0.0, -distance_m, 1.0);
    return static_cast<float>(p.z / p.w);
}

// depth * w = z, where both are linear in the distance.
double distance_at(const Camera& camera, Extent size, float depth) {
    const glm::dmat4 clip(camera.clip_from_view(size));
    const double d = static_cast<double>(depth);
    return (clip[3][2] - d * clip[3][3]) / (clip[2][2] - d * clip[2][3]);
}

std::vector<DVec3> visible_corners(const Camera& camera, Extent size, const Box3& bounds,
                                   DepthRange range, std::span<const DVec4> within) {
    if (bounds.empty()) return {};
    const double grow_m = kGrowth * std::max(bounds.diagonal(), 1e-3f);
    const std::array<DVec3, 8> box = box_corners(bounds, grow_m);
    range = range_within(camera, box, range);
    if (range.far_m <= range.near_m) return {};
    std::vector<DVec4> sides = planes(box);
    for (const DVec4& plane : planes(frustum_corners(camera, size, range)))
        sides.push_back(plane);
    sides.insert(sides.end(), within.begin(), within.end());
    return corners_of(sides, DVec3(bounds.center()),
                      static_cast<double>(bounds.diagonal()) + 2.0 * grow_m);
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

double reach(const DVec4& plane, const Box3& box) {
    const DVec3 inmost(plane.x > 0.0 ? box.max.x : box.min.x, plane.y > 0.0 ? box.max.y : box.min.y,
                       plane.z > 0.0 ? box.max.z : box.min.z);
    return height(plane, inmost);
}

double used_texels(unsigned size_texels, float margin_texels) {
    // Filters that reach farther than a quarter of the map read its border again.
    return std::max(0.5 * size_texels, size_texels - 2.0 * static_cast<double>(margin_texels));
}

// A step across the light moves the map's image by the 2x3 matrix of the gradients of its
// coordinates; the step that moves it least for its length is one along the longer side of a texel,
// and by how much is the matrix's smaller singular value.
float LightFit::texel_size_m(Vec3 p_ws) const {
    const glm::dmat4 rows = glm::transpose(clip_from_world);
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

TexelSteps LightFit::texel_steps() const {
    const glm::dmat4 rows = glm::transpose(clip_from_world);
    const DVec3 u = 0.5 * size_texels * DVec3(rows[0]);
    const DVec3 v = 0.5 * size_texels * DVec3(rows[1]);
    return {Vec3(u / glm::dot(u, u)), Vec3(v / glm::dot(v, v))};
}

LightFit fit_directional(const DirectionalLight& light, std::span<const DVec3> receivers_ws,
                         const Box3& bounds, unsigned size_texels, float margin_texels) {
    const DVec3 to_light = glm::normalize(DVec3(light.to_light_ws));
    const DVec3 center = bounds.empty() ? DVec3(0.0) : DVec3(bounds.center());
    const glm::dmat4 view = light_from_world(to_light, center);

    std::vector<glm::dvec2> seen;
    for (const DVec3& corner : receivers_ws)
        seen.emplace_back(view * DVec4(corner, 1.0));
    const Rectangle rectangle = smallest_rectangle(std::move(seen));
    const double longest_m = std::max({rectangle.size.x, rectangle.size.y, kLeastMap_m});
    const glm::dvec2 size_m = glm::max(rectangle.size, kLeastAspect * longest_m);
    return parallel_fit({view, rectangle.center, rectangle.axis, size_m},
                        casters_range(view, bounds), size_texels, margin_texels);
}

// The sphere depends on nothing but the camera's lens, so that neither turning nor moving changes
// the size of the texels, and the centre is moved by whole texels only.
LightFit fit_directional_stable(const DirectionalLight& light, const Camera& camera, Extent size,
                                DepthRange range, const Box3& bounds, unsigned size_texels,
                                float margin_texels, int step_texels) {
    const DVec3 to_light = glm::normalize(DVec3(light.to_light_ws));
    // The light's view does not move with the scene's bounds: these may change with an animation.
    const glm::dmat4 view = light_from_world(to_light, DVec3(0.0));
    const std::array<DVec3, 8> corners = frustum_corners(camera, size, range);
    const DVec3 near_middle = 0.5 * (corners[0] + corners[3]);
    const DVec3 far_middle = 0.5 * (corners[4] + corners[7]);
    // The centre on the axis from which the near and far corners are equally far, or the far
    // plane's middle when that is beyond it.
    const double near2 = glm::dot(corners[0] - near_middle, corners[0] - near_middle);
    const double far2 = glm::dot(corners[4] - far_middle, corners[4] - far_middle);
    const double depth_m = std::max(range.far_m - range.near_m, kLeastMap_m);
    const double along_m = std::clamp(0.5 * (depth_m + (far2 - near2) / depth_m), 0.0, depth_m);
    const DVec3 center = near_middle + (far_middle - near_middle) * (along_m / depth_m);
    const double radius_m = std::sqrt(
        std::max(near2 + along_m * along_m, far2 + (depth_m - along_m) * (depth_m - along_m)));

    // Half a step and half a texel more on each side for the rounding of the centre, and the radius
    // rounded up, lest the last bits of the camera's matrix change the texels.
    constexpr double kRadiusSteps = 1024.0;
    const double step_m = std::exp2(std::floor(std::log2(radius_m))) / kRadiusSteps;
    const double side_m = 2.0 * std::ceil(radius_m / step_m) * step_m;
    const float margin = margin_texels + 0.5f * static_cast<float>(step_texels + 1);
    const double moves_by_m = step_texels * side_m / used_texels(size_texels, margin);
    const glm::dvec2 middle(view * DVec4(center, 1.0));
    const glm::dvec2 snapped = glm::floor(middle / moves_by_m + 0.5) * moves_by_m;
    return parallel_fit({view, snapped, {1.0, 0.0}, glm::dvec2(side_m)},
                        in_steps(casters_range(view, bounds)), size_texels, margin);
}

LightFit fit_image(const glm::dmat4& image_from_world, std::span<const DVec3> receivers_ws,
                   unsigned size_texels, float margin_texels) {
    /// Of the depth range, on either side: what is biased stays within it.
    constexpr double kDepthMargin = 0.01;
    DVec3 low(std::numeric_limits<double>::infinity());
    DVec3 high = -low;
    for (const DVec3& p_ws : receivers_ws) {
        const DVec4 p = image_from_world * DVec4(p_ws, 1.0);
        low = glm::min(low, DVec3(p) / p.w);
        high = glm::max(high, DVec3(p) / p.w);
    }
    const double used_share = used_texels(size_texels, margin_texels) / size_texels;
    const DVec3 size = glm::max(high - low, DVec3(1e-12)) * DVec3(1, 1, 1.0 + 2.0 * kDepthMargin);
    const DVec3 scale = DVec3(2.0 * used_share, 2.0 * used_share, 1.0) / size;
    glm::dmat4 to_map(1.0);
    for (int axis = 0; axis < 3; ++axis)
        to_map[axis][axis] = scale[axis];
    to_map[3] = DVec4(-0.5 * scale * (low + high) + DVec3(0.0, 0.0, 0.5), 1.0);
    LightFit fit;
    fit.clip_from_world = to_map * image_from_world;
    fit.size_texels = size_texels;
    fit.affine = false;
    return fit;
}

}  // namespace gnomon
