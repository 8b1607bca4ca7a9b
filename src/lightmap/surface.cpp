// Which sides of an instance's triangles light can reach, and which of them are neighbours.
// Components by union and find: R. Tarjan, "Efficiency of a Good But Not Linear Set Union
// Algorithm", JACM 22(2), 1975; without ranks, as halving the paths suffices.

#include "lightmap/surface.h"

#include <glm/ext/matrix_double3x3.hpp>
#include <glm/ext/matrix_double4x4.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

namespace gnomon::lightmap {

namespace {

constexpr double kFloatSpacing = std::numeric_limits<float>::epsilon();

/// The number of each vertex's position: equal positions have one.
std::vector<std::uint32_t> place_numbers(const std::vector<Vec3>& positions) {
    const auto key = [&](std::uint32_t i) {
        const Vec3 p = positions[i];
        return std::tuple(p.x, p.y, p.z);
    };
    std::vector<std::uint32_t> order(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    std::vector<std::uint32_t> numbers(positions.size());
    for (std::size_t i = 1; i < order.size(); ++i) {
        numbers[order[i]] =
            numbers[order[i - 1]] + static_cast<std::uint32_t>(key(order[i - 1]) < key(order[i]));
    }
    return numbers;
}

double longest_edge(const std::array<DVec3, 3>& corners) {
    return std::max({glm::distance(corners[0], corners[1]), glm::distance(corners[1], corners[2]),
                     glm::distance(corners[2], corners[0])});
}

Face other_side(Face face) {
    face.back = !face.back;
    face.normal_ws = -face.normal_ws;
    std::swap(face.corners_ws[1], face.corners_ws[2]);
    std::swap(face.from[1], face.from[2]);
    std::swap(face.places[1], face.places[2]);
    return face;
}

/// What is known of a component of the front faces.
struct Solid {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;  ///< forth less back
    DVec3 inside{0.0};       ///< any point, so that the volume loses no digits far from the origin
    double volume_m3 = 0.0;  ///< times 6; > 0 when it faces outwards
    bool empty = true;

    void add(const Face& face) {
        if (empty) inside = face.corners_ws[0];
        empty = false;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = face.places[i];
            const std::uint32_t b = face.places[(i + 1) % 3];
            edges[std::minmax(a, b)] += a < b ? 1 : -1;
        }
        volume_m3 += glm::dot(face.corners_ws[0] - inside,
                              glm::cross(face.corners_ws[1] - inside, face.corners_ws[2] - inside));
    }
    bool closed_outwards() const {
        return volume_m3 > 0.0 &&
               std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 0; });
    }
};

}  // namespace

std::vector<std::uint32_t> components(std::span<const std::array<std::uint32_t, 3>> corners) {
    std::uint32_t count = 0;
    for (const auto& triangle : corners)
        count = std::max({count, triangle[0] + 1, triangle[1] + 1, triangle[2] + 1});
    std::vector<std::uint32_t> parent(count);
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](std::uint32_t i) {
        while (parent[i] != i)
            i = parent[i] = parent[parent[i]];
        return i;
    };
    for (const auto& [a, b, c] : corners) {
        // To the smaller number, so that names do not depend on the order of joining.
        for (const std::uint32_t other : {b, c}) {
            const auto [low, high] = std::minmax({root(a), root(other)});
            parent[high] = low;
        }
    }
    std::vector<std::uint32_t> names(corners.size());
    std::ranges::transform(corners, names.begin(), [&](const auto& t) { return root(t[0]); });
    return names;
}

Surface::Surface(const Scene& scene, std::uint32_t instance, bool with_backs,
                 std::span<const DVec3> to_light_ws) {
    const Instance& placed = scene.instances()[instance];
    const Mesh& mesh = scene.meshes()[placed.mesh];
    const Material& material = scene.materials()[mesh.material];
    add_faces(mesh, placed.world_from_local);
    if (with_backs && material.double_sided) add_backs(!material.masked());
    if (!to_light_ws.empty()) {
        std::erase_if(faces_, [&](const Face& face) {
            return std::ranges::none_of(to_light_ws, [&](const DVec3& to_light) {
                return glm::dot(face.normal_ws, to_light) > 0.0;
            });
        });
    }
    index_edges();
}

void Surface::add_faces(const Mesh& mesh, const Mat4& world_from_local) {
    const glm::dmat3 linear(world_from_local);
    const DVec3 origin(world_from_local[3]);
    const bool mirrored = glm::determinant(linear) < 0.0;
    const std::vector<std::uint32_t> places = place_numbers(mesh.positions);
    faces_.reserve(mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        Face face{.triangle = t};
        DVec3 magnitude(0.0);
        for (std::uint8_t i = 0; i < 3; ++i) {
            const std::uint32_t vertex = mesh.triangles[t][i];
            const DVec3 p(mesh.positions[vertex]);
            face.corners_ws[i] = linear * p + origin;
            face.from[i] = i;
            face.places[i] = places[vertex];
            magnitude = glm::max(magnitude, glm::abs(linear[0] * p.x) + glm::abs(linear[1] * p.y) +
                                                glm::abs(linear[2] * p.z));
        }
        const DVec3 doubled = glm::cross(face.corners_ws[1] - face.corners_ws[0],
                                         face.corners_ws[2] - face.corners_ws[0]);
        const double doubled_area = glm::length(doubled);
        const double rounding_m = kFloatSpacing * glm::length(magnitude);
        if (!(doubled_area > longest_edge(face.corners_ws) * rounding_m)) continue;
        face.normal_ws = doubled / doubled_area;
        face.area_m2 = 0.5 * doubled_area;
        // Mirroring keeps what is the front and turns the corners round.
        if (mirrored) {
            face = other_side(face);
            face.back = false;
        }
        faces_.push_back(face);
    }
}

void Surface::add_backs(bool opaque) {
    std::vector<std::array<std::uint32_t, 3>> corners;
    corners.reserve(faces_.size());
    for (const Face& face : faces_)
        corners.push_back(face.places);
    const std::vector<std::uint32_t> names = components(corners);
    std::map<std::uint32_t, Solid> solids;
    for (std::size_t i = 0; i < names.size(); ++i)
        solids[names[i]].add(faces_[i]);
    std::map<std::uint32_t, bool> dark_inside;
    for (const auto& [name, solid] : solids)
        dark_inside[name] = opaque && solid.closed_outwards();
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (!dark_inside[names[i]]) faces_.push_back(other_side(faces_[i]));
    }
}

void Surface::index_edges() {
    std::vector<std::pair<Edge, std::uint32_t>> all;
    all.reserve(3 * faces_.size());
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
        const auto& places = faces_[f].places;
        for (std::size_t i = 0; i < 3; ++i)
            all.push_back({{places[i], places[(i + 1) % 3]}, f});
    }
    std::ranges::sort(all);
    for (const auto& [edge, face] : all) {
        edges_.push_back(edge);
        edge_faces_.push_back(face);
    }
}

std::span<const std::uint32_t> Surface::across(std::uint32_t face, int edge) const {
    const auto& places = faces_[face].places;
    const auto i = static_cast<std::size_t>(edge);
    const Edge wanted{places[(i + 1) % 3], places[i]};
    const auto [first, last] = std::equal_range(edges_.begin(), edges_.end(), wanted);
    return {edge_faces_.data() + (first - edges_.begin()), static_cast<std::size_t>(last - first)};
}

double Surface::area_m2() const {
    return std::accumulate(faces_.begin(), faces_.end(), 0.0,
                           [](double sum, const Face& face) { return sum + face.area_m2; });
}

}  // namespace gnomon::lightmap
