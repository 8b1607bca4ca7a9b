// Where receivers are, and which hits of their rays are only touches.
//
// A shadow ray starts on a surface, and float arithmetic may find that it hits that surface, or a
// neighbour in the same plane. The usual cure is a bias: start well off the surface. A bias big
// enough for grazing light, large triangles and coordinates far from the origin loses contact
// shadows; the rounding bounds of M. Pharr, W. Jakob, G. Humphreys, "Physically Based Rendering",
// 4th edition (2023), section 6.8 hold for the ray's origin, which we lift by them, but not for the
// arithmetic of somebody else's traversal. So the traversal only proposes hits, and each is judged
// in double against the scene's own corners. With exact numbers a triangle could not block when
//   1. it is the receiver's own;
//   2. it lies on or below the receiver's plane: light comes from above (covers duplicates,
//      coplanar and convex neighbours at any grazing angle and any distance);
//   3. the receiver lies in its plane, on the near side of a concave edge, and the ray does not
//      leave to the far side;
//   4. the light lies in its plane (a lamp flush with the ceiling).
// "On" means within the error that rounding the corners to float can have made.

#include "trace/receiver.h"

#include <glm/ext/matrix_double3x3.hpp>
#include <glm/ext/matrix_double4x4.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::trace {

namespace {

bool on_or_below(const Triangle& triangle, DVec3 point, DVec3 normal) {
    const double error = height_error(normal, triangle.magnitude + glm::abs(point));
    return std::ranges::all_of(triangle.corners_ws, [&](DVec3 corner) {
        return glm::dot(normal, corner - point) <= error;
    });
}

/// On which side of a plane a receiver is that lies in it to float's precision: the sign tells
/// where most of its own triangle lies. Without one, the front.
double side_of(const Scene& scene, const Receiver& receiver, DVec3 corner, DVec3 normal) {
    if (receiver.id.instance == kNoSurface) return 1.0;
    const auto& [a, b, c] = world_triangle(scene, receiver.id).corners_ws;
    return glm::dot(normal, (a + b + c) / 3.0 - corner);
}

}  // namespace

DVec3 Triangle::front_normal_ws() const {
    const DVec3 normal = glm::cross(corners_ws[1] - corners_ws[0], corners_ws[2] - corners_ws[0]);
    return mirrored ? -normal : normal;
}

DVec3 Triangle::barycentric(DVec3 p_ws) const {
    const auto& [a, b, c] = corners_ws;
    const DVec3 normal = glm::cross(b - a, c - a);
    const double area2 = glm::dot(normal, normal);
    const double v = glm::dot(glm::cross(p_ws - a, c - a), normal) / area2;
    const double w = glm::dot(glm::cross(b - a, p_ws - a), normal) / area2;
    return {1.0 - v - w, v, w};
}

Triangle world_triangle(const Scene& scene, SurfaceId surface) {
    const Instance& instance = scene.instances()[surface.instance];
    const Mesh& mesh = scene.meshes()[instance.mesh];
    const UVec3 corners = mesh.triangles[surface.primitive];
    const glm::dmat3 linear(instance.world_from_local);
    const DVec3 origin(instance.world_from_local[3]);
    Triangle triangle;
    for (int i = 0; i < 3; ++i) {
        const DVec3 p(mesh.positions[corners[i]]);
        triangle.corners_ws[i] = linear * p + origin;
        const DVec3 magnitude = glm::abs(linear[0] * p.x) + glm::abs(linear[1] * p.y) +
                                glm::abs(linear[2] * p.z) + glm::abs(origin);
        triangle.magnitude = glm::max(triangle.magnitude, magnitude);
    }
    triangle.mirrored = glm::determinant(linear) < 0.0;
    return triangle;
}

bool touches_only(const Scene& scene, const Triangle& triangle, const ShadowRay& ray) {
    const Receiver& receiver = *ray.receiver;
    const DVec3 point(receiver.position_ws);
    if (on_or_below(triangle, point, DVec3(receiver.normal_ws))) return true;

    const DVec3 normal = triangle.front_normal_ws();
    const DVec3 direction(ray.direction_ws);
    const DVec3 corner = triangle.corners_ws[0];
    const DVec3 magnitude = triangle.magnitude + glm::abs(point);
    if (std::abs(glm::dot(normal, point - corner)) <= height_error(normal, magnitude)) {
        return glm::dot(normal, direction) * side_of(scene, receiver, corner, normal) >= 0.0;
    }
    if (ray.to_infinity) return false;
    const double light_height = glm::dot(normal, point + direction - corner);
    return std::abs(light_height) <= height_error(normal, magnitude + glm::abs(direction));
}

Receiver receiver_on(const Triangle& triangle, SurfaceId surface, DVec3 origin_ws,
                     DVec3 direction_ws) {
    const DVec3 normal = triangle.front_normal_ws();
    const double area2 = glm::length(normal);
    if (!(area2 > 0.0)) return {};
    const auto& corners = triangle.corners_ws;
    const double t = glm::dot(normal, corners[0] - origin_ws) / glm::dot(normal, direction_ws);
    const DVec3 hit = origin_ws + t * direction_ws;

    // Off the edges by twice what lifted_position_ws() can move it, lest it come to lie behind a
    // wall there.
    const double margin_m = 4.0 * rounding_distance_m(Vec3(corners[0]));
    DVec3 weights;
    for (int i = 0; i < 3; ++i) {
        const DVec3 from = corners[(i + 1) % 3];
        const DVec3 edge = corners[(i + 2) % 3] - from;
        const double least = std::min(margin_m * glm::length(edge) / area2, 1.0 / 3.0);
        const double weight =
            glm::dot(glm::cross(edge, hit - from), triangle.mirrored ? -normal : normal) /
            (area2 * area2);
        weights[i] = std::isfinite(weight) ? std::max(weight, least) : 1.0;
    }
    weights /= weights.x + weights.y + weights.z;

    Receiver receiver;
    receiver.position_ws =
        Vec3(weights.x * corners[0] + weights.y * corners[1] + weights.z * corners[2]);
    receiver.normal_ws = Vec3((glm::dot(normal, direction_ws) > 0.0 ? -1.0 : 1.0) / area2 * normal);
    receiver.id = surface;
    return receiver;
}

}  // namespace gnomon::trace
