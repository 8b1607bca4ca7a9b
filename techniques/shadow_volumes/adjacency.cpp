#include "adjacency.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <tuple>

namespace gnomon::shadow_volumes {

namespace {

/// The first vertex at the place of each vertex.
std::vector<std::uint32_t> weld(const std::vector<Vec3>& positions) {
    std::vector<std::uint32_t> order(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto place = [&](std::uint32_t i) {
        // + 0.0f makes -0 and 0 one place.
        const Vec3 p = positions[i] + 0.0f;
        return std::tuple(p.x, p.y, p.z);
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::tuple(place(a), a) < std::tuple(place(b), b);
    });
    std::vector<std::uint32_t> first(positions.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same_place = i > 0 && place(order[i]) == place(order[i - 1]);
        first[order[i]] = same_place ? first[order[i - 1]] : order[i];
    }
    return first;
}

void find_edges(Adjacency& mesh) {
    struct HalfEdge {
        std::uint32_t v0, v1;
        EdgeUse use;
    };
    std::vector<HalfEdge> halves;
    halves.reserve(3 * mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int corner = 0; corner < 3; ++corner) {
            const std::uint32_t a = mesh.triangles[t][corner];
            const std::uint32_t b = mesh.triangles[t][(corner + 1) % 3];
            EdgeUse use{};
            use.triangle = t & 0x7fffffffu;
            use.forward = a < b ? 1u : 0u;
            halves.push_back({std::min(a, b), std::max(a, b), use});
        }
    }
    std::sort(halves.begin(), halves.end(), [](const HalfEdge& a, const HalfEdge& b) {
        return std::tuple(a.v0, a.v1, +a.use.triangle) < std::tuple(b.v0, b.v1, +b.use.triangle);
    });
    for (const HalfEdge& half : halves) {
        const auto use = static_cast<std::uint32_t>(mesh.uses.size());
        if (use == 0 || mesh.edges.back().v0 != half.v0 || mesh.edges.back().v1 != half.v1) {
            mesh.edges.push_back({half.v0, half.v1, use});
        }
        mesh.uses.push_back(half.use);
    }
    mesh.edges.push_back({0, 0, static_cast<std::uint32_t>(mesh.uses.size())});
}

/// Sets of triangles, merged edge by edge. R. Tarjan, "Efficiency of a Good But Not Linear Set
/// Union Algorithm", JACM 1975.
class Pieces {
public:
    explicit Pieces(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), 0u);
    }
    std::uint32_t find(std::uint32_t i) {
        while (parent_[i] != i) {
            parent_[i] = parent_[parent_[i]];
            i = parent_[i];
        }
        return i;
    }
    void merge(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

private:
    std::vector<std::uint32_t> parent_;
};

void classify_pieces(Adjacency& mesh, const std::vector<Vec3>& positions) {
    const std::size_t count = mesh.triangles.size();
    const std::size_t edge_count = mesh.edges.size() - 1;
    Pieces pieces(count);
    for (std::size_t e = 0; e < edge_count; ++e) {
        // Where more than two triangles meet, solids may touch, each wound in its own way.
        const std::uint32_t first = mesh.edges[e].first_use;
        if (mesh.edges[e + 1].first_use != first + 2) continue;
        pieces.merge(mesh.uses[first].triangle, mesh.uses[first + 1].triangle);
    }
    std::vector<bool> open(count);
    std::vector<int> balance(count);  // of each piece at the edge in hand
    for (std::size_t e = 0; e < edge_count; ++e) {
        const std::span uses(mesh.uses.begin() + mesh.edges[e].first_use,
                             mesh.uses.begin() + mesh.edges[e + 1].first_use);
        for (const EdgeUse use : uses)
            balance[pieces.find(use.triangle)] += use.forward != 0 ? 1 : -1;
        for (const EdgeUse use : uses) {
            const std::uint32_t piece = pieces.find(use.triangle);
            if (balance[piece] != 0) open[piece] = true;
            balance[piece] = 0;
        }
    }

    // Six times the enclosed volume, about a point of the mesh so that it does not cancel.
    std::vector<double> volume(count);
    for (std::uint32_t t = 0; t < count; ++t) {
        const DVec3 origin(positions[mesh.triangles[0].x]);
        const DVec3 a = DVec3(positions[mesh.triangles[t].x]) - origin;
        const DVec3 b = DVec3(positions[mesh.triangles[t].y]) - origin;
        const DVec3 c = DVec3(positions[mesh.triangles[t].z]) - origin;
        volume[pieces.find(t)] += glm::dot(a, glm::cross(b, c));
    }
    mesh.closed.resize(count);
    mesh.inside_out.resize(count);
    for (std::uint32_t t = 0; t < count; ++t) {
        const std::uint32_t piece = pieces.find(t);
        mesh.closed[t] = !open[piece] && volume[piece] != 0.0;
        mesh.inside_out[t] = volume[piece] < 0.0;
    }
}

}  // namespace

Adjacency find_adjacency(const Mesh& mesh) {
    Adjacency adjacency;
    const std::vector<std::uint32_t> first = weld(mesh.positions);
    for (const UVec3 t : mesh.triangles) {
        const UVec3 welded(first[t.x], first[t.y], first[t.z]);
        if (welded.x == welded.y || welded.y == welded.z || welded.z == welded.x) continue;
        adjacency.triangles.push_back(welded);
    }
    find_edges(adjacency);
    classify_pieces(adjacency, mesh.positions);
    return adjacency;
}

}  // namespace gnomon::shadow_volumes
