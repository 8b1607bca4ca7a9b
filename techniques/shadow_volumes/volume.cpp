#include "volume.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/ext/vector_double4.hpp>
#include <glm/matrix.hpp>

#include <cmath>
#include <cstdlib>
#include <limits>

namespace gnomon::shadow_volumes {

namespace {

/// Does a triangle take part, and is its winding counter-clockwise seen from the light?
enum class Facing : std::uint8_t { left_out, towards, away };

std::vector<DVec3> world_positions(const Mesh& mesh, const glm::dmat4& world_from_local) {
    std::vector<DVec3> positions;
    positions.reserve(mesh.positions.size());
    for (const Vec3 p : mesh.positions) {
        positions.emplace_back(world_from_local * glm::dvec4(DVec3(p), 1.0));
    }
    return positions;
}

bool may_be_inside(const std::vector<DVec3>& positions, HomogeneousLight light_ws) {
    if (light_ws.w == 0.0f) return false;
    DVec3 low(positions.front()), high(positions.front());
    for (const DVec3& p : positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const DVec3 light(light_ws);
    return glm::all(glm::greaterThanEqual(light, low)) && glm::all(glm::lessThanEqual(light, high));
}

/// The greatest magnitudes that make a coordinate in the world, of a corner or of the light. A
/// light at infinity needs none.
DVec3 magnitude(const Mesh& mesh, const glm::dmat4& world_from_local, HomogeneousLight light_ws) {
    if (light_ws.w == 0.0f) return DVec3(0.0);
    DVec3 local(0.0);
    for (const Vec3 p : mesh.positions)
        local = glm::max(local, glm::abs(DVec3(p)));
    const DVec3 world = glm::abs(DVec3(world_from_local[0])) * local.x +
                        glm::abs(DVec3(world_from_local[1])) * local.y +
                        glm::abs(DVec3(world_from_local[2])) * local.z +
                        glm::abs(DVec3(world_from_local[3]));
    return world + glm::abs(DVec3(light_ws));
}

/// Roundings to float behind a light's height over a triangle's plane: two in each coordinate (in
/// the mesh and in the instance's matrix), which may tilt the plane by as much again, and the
/// light's own.
constexpr double kRoundings = 2 * 2 + 2 + 1;
constexpr double kUnitRoundoff = 0.5 * std::numeric_limits<float>::epsilon();

std::vector<Facing> classify(const Adjacency& adjacency, const std::vector<DVec3>& positions,
                             const glm::dmat4& world_from_local, HomogeneousLight light_ws,
                             DVec3 magnitude) {
    const double determinant = glm::determinant(glm::dmat3(world_from_local));
    const bool each_triangle = determinant == 0.0 || may_be_inside(positions, light_ws);
    const bool mirrored = determinant < 0.0;
    std::vector<Facing> facing(adjacency.triangles.size());
    for (std::size_t i = 0; i < facing.size(); ++i) {
        const UVec3 t = adjacency.triangles[i];
        const DVec3 a = positions[t.x];
        const DVec3 normal = glm::cross(positions[t.y] - a, positions[t.z] - a);
        const DVec3 to_light = DVec3(light_ws) - a * static_cast<double>(light_ws.w);
        const double height = glm::dot(normal, to_light);
        // A light in the triangle's plane (a lamp flush with a ceiling) is hidden by none of it,
        // on whichever side of the plane rounding has put it.
        const double error = kRoundings * kUnitRoundoff * glm::dot(glm::abs(normal), magnitude);
        if (std::abs(height) <= error) continue;
        const bool towards = height > 0.0;
        facing[i] = towards ? Facing::towards : Facing::away;
        if (each_triangle || !adjacency.closed[i]) continue;
        const bool outside_towards = towards != (adjacency.inside_out[i] != mirrored);
        if (!outside_towards) facing[i] = Facing::left_out;
    }
    return facing;
}

}  // namespace

Volume build_volume(const Mesh& mesh, const Adjacency& adjacency, const Mat4& world_from_local,
                    HomogeneousLight light_ws, VolumeSource source) {
    Volume volume;
    if (adjacency.triangles.empty()) return volume;
    const glm::dmat4 transform(world_from_local);
    const std::vector<DVec3> positions = world_positions(mesh, transform);
    const std::vector<Facing> facing =
        classify(adjacency, positions, transform, light_ws, magnitude(mesh, transform, light_ws));

    for (std::size_t i = 0; i < facing.size(); ++i) {
        if (facing[i] == Facing::left_out) continue;
        const UVec3 t = adjacency.triangles[i] + source.first_vertex;
        auto& caps = facing[i] == Facing::towards ? volume.caps : volume.clockwise_caps;
        caps.push_back({source.slot, t.x, t.y, t.z});
    }
    for (std::size_t e = 0; e + 1 < adjacency.edges.size(); ++e) {
        const Edge& edge = adjacency.edges[e];
        int net = 0;  // triangles that run from v0 to v1, less those that run back
        for (std::uint32_t u = edge.first_use; u < adjacency.edges[e + 1].first_use; ++u) {
            const EdgeUse use = adjacency.uses[u];
            const Facing f = facing[use.triangle];
            if (f == Facing::left_out) continue;
            net += (use.forward != 0) == (f == Facing::towards) ? 1 : -1;
        }
        const std::uint32_t a = source.first_vertex + (net > 0 ? edge.v0 : edge.v1);
        const std::uint32_t b = source.first_vertex + (net > 0 ? edge.v1 : edge.v0);
        for (int copy = 0; copy < std::abs(net); ++copy) {
            volume.sides.push_back({source.slot, a, b});
        }
    }
    return volume;
}

}  // namespace gnomon::shadow_volumes
