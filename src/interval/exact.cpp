// T. Möller, B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", Journal of Graphics
// Tools 2(1), 1997, in double; edges belong to both of their triangles, so that no ray slips
// between neighbours.

#include "interval/exact.h"

#include "trace/alpha.h"

#include <cmath>

namespace gnomon::interval {

bool blocks(const Scene& scene, bool ignore_alpha, trace::SurfaceId surface,
            const trace::Receiver& receiver, DVec3 to_sun_ws) {
    if (surface == receiver.id) return false;
    const trace::Triangle triangle = trace::world_triangle(scene, surface);
    const DVec3 corner = triangle.corners_ws[0];
    const DVec3 edge1 = triangle.corners_ws[1] - corner;
    const DVec3 edge2 = triangle.corners_ws[2] - corner;
    const DVec3 offset = DVec3(trace::lifted_position_ws(receiver)) - corner;
    const DVec3 normal = glm::cross(edge1, edge2);
    const double determinant = -glm::dot(to_sun_ws, normal);
    const double sign = std::copysign(1.0, determinant);
    const double u = sign * glm::dot(to_sun_ws, glm::cross(edge2, offset));
    const double v = sign * glm::dot(to_sun_ws, glm::cross(offset, edge1));
    const double size = std::abs(determinant);
    if (!(u >= 0.0 && v >= 0.0 && u + v <= size && size > 0.0)) return false;
    if (!(sign * glm::dot(offset, normal) > 0.0)) return false;  // behind the receiver
    const trace::ShadowRay ray{&receiver, Vec3(to_sun_ws), true};
    if (trace::touches_only(scene, triangle, ray)) return false;
    if (ignore_alpha) return true;
    const Mesh& mesh = scene.meshes()[scene.instances()[surface.instance].mesh];
    return !trace::is_hole(scene, mesh, surface.primitive, static_cast<float>(u / size),
                           static_cast<float>(v / size));
}

}  // namespace gnomon::interval
