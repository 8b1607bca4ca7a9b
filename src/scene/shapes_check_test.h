#pragma once

#include <gnomon/scene.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

/// What the tests of meshes ask of them. Each returns what is wrong, empty when nothing is.
namespace gnomon::scene {

/// Vertices of equal position as one: the number of each vertex's position.
inline std::vector<std::uint32_t> welded(const Mesh& mesh) {
    std::map<std::tuple<float, float, float>, std::uint32_t> numbers;
    std::vector<std::uint32_t> result;
    for (const Vec3 p : mesh.positions) {
        const auto next = static_cast<std::uint32_t>(numbers.size());
        result.push_back(numbers.try_emplace({p.x, p.y, p.z}, next).first->second);
    }
    return result;
}

/// Six times the volume that a closed mesh encloses; > 0 when its triangles face outwards.
inline double enclosed_volume(const Mesh& mesh) {
    double volume = 0.0;
    for (const UVec3 t : mesh.triangles) {
        const DVec3 a(mesh.positions[t.x]);
        const DVec3 b(mesh.positions[t.y]);
        const DVec3 c(mesh.positions[t.z]);
        volume += glm::dot(a, glm::cross(b, c));
    }
    return volume;
}

/// Closed: each edge has two triangles, which run along it in opposite directions.
inline std::string closedness_fault(const Mesh& mesh) {
    const std::vector<std::uint32_t> weld = welded(mesh);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
    for (const UVec3 t : mesh.triangles) {
        for (int corner = 0; corner < 3; ++corner)
            ++uses[{weld[t[corner]], weld[t[(corner + 1) % 3]]}];
    }
    for (const auto& [edge, count] : uses) {
        const auto back = uses.find({edge.second, edge.first});
        const int back_count = back == uses.end() ? 0 : back->second;
        if (count == 1 && back_count == 1) continue;
        for (std::size_t i = 0; i < weld.size(); ++i) {
            if (weld[i] != edge.first) continue;
            const Vec3 p = mesh.positions[i];
            return "mesh " + mesh.name + ": an edge from (" + std::to_string(p.x) + ", " +
                   std::to_string(p.y) + ", " + std::to_string(p.z) + ") is used " +
                   std::to_string(count) + " times forth and " + std::to_string(back_count) +
                   " times back";
        }
    }
    if (!(enclosed_volume(mesh) > 0.0)) return "mesh " + mesh.name + " is inside out";
    return {};
}

/// Triangles have area, normals are of length 1 and on the side of their triangles' fronts.
inline std::string shape_fault(const Mesh& mesh) {
    // A triangle this thin relative to its length has no dependable normal in float.
    constexpr double kMinHeightPerLength = 1e-4;
    constexpr double kUnitTolerance = 1e-5;  // a few float roundings
    // Normals of round shapes differ from their triangles' by less than the creases' angle.
    constexpr double kMinCosine = 0.7;
    if (mesh.normals.size() != mesh.positions.size()) return "mesh " + mesh.name + ": no normals";
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const UVec3 t = mesh.triangles[i];
        const std::string where = "mesh " + mesh.name + ", triangle " + std::to_string(i) + ": ";
        const DVec3 a(mesh.positions[t.x]);
        const DVec3 b(mesh.positions[t.y]);
        const DVec3 c(mesh.positions[t.z]);
        const DVec3 doubled_area = glm::cross(b - a, c - a);
        const double longest =
            std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
        if (!(glm::length(doubled_area) > kMinHeightPerLength * longest * longest)) {
            return where + "no area";
        }
        for (int corner = 0; corner < 3; ++corner) {
            const DVec3 normal(mesh.normals[t[corner]]);
            if (std::abs(glm::length(normal) - 1.0) > kUnitTolerance)
                return where + "normal length";
            const double cosine = glm::dot(normal, glm::normalize(doubled_area));
            if (cosine < kMinCosine) return where + "normal off by cos = " + std::to_string(cosine);
        }
    }
    return {};
}

/// How often a closed mesh winds about a point: 1 within, 0 outside. A. Van Oosterom, J. Strackee,
/// "The solid angle of a plane triangle", 1983.
inline double winding_number(const Mesh& mesh, const Mat4& world_from_local, Vec3 point_ws) {
    double solid_angle = 0.0;
    for (const UVec3 t : mesh.triangles) {
        DVec3 d[3];
        for (int corner = 0; corner < 3; ++corner) {
            const Vec4 p(mesh.positions[t[corner]], 1.0f);
            d[corner] = DVec3(Vec3(world_from_local * p) - point_ws);
        }
        const double la = glm::length(d[0]);
        const double lb = glm::length(d[1]);
        const double lc = glm::length(d[2]);
        const double numerator = glm::dot(d[0], glm::cross(d[1], d[2]));
        const double denominator = la * lb * lc + glm::dot(d[0], d[1]) * lc +
                                   glm::dot(d[1], d[2]) * la + glm::dot(d[2], d[0]) * lb;
        solid_angle += 2.0 * std::atan2(numerator, denominator);
    }
    return solid_angle / (4.0 * 3.14159265358979323846);
}

}  // namespace gnomon::scene
