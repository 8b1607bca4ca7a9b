#include "scene/winding.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <vector>

namespace gnomon::scene {

namespace {

bool closes(std::span<const UVec3> triangles) {
    std::vector<std::uint64_t> forward;
    std::vector<std::uint64_t> backward;
    for (const UVec3& t : triangles) {
        for (int i = 0; i < 3; ++i) {
            const std::uint64_t from = t[i];
            const std::uint64_t to = t[(i + 1) % 3];
            forward.push_back(from << 32 | to);
            backward.push_back(to << 32 | from);
        }
    }
    std::ranges::sort(forward);
    std::ranges::sort(backward);
    return forward == backward;
}

/// For each vertex one of those that it is connected with: the same for all of them.
class Parts {
public:
    explicit Parts(std::span<const UVec3> triangles, std::size_t vertices) : above_(vertices) {
        std::iota(above_.begin(), above_.end(), 0u);
        for (const UVec3& t : triangles) {
            above_[top(t.y)] = top(t.x);
            above_[top(t.z)] = top(t.x);
        }
    }

    unsigned top(unsigned vertex) {
        while (above_[vertex] != vertex) {
            above_[vertex] = above_[above_[vertex]];
            vertex = above_[vertex];
        }
        return vertex;
    }

private:
    std::vector<unsigned> above_;
};

}  // namespace

Winding winding_of(std::span<const Vec3> positions, std::span<const UVec3> triangles) {
    if (triangles.empty() || !closes(triangles)) return Winding::open;
    Parts parts(triangles, positions.size());
    const DVec3 origin(positions[triangles.front().x]);
    std::unordered_map<unsigned, double> volumes;
    for (const UVec3& t : triangles) {
        const DVec3 a = DVec3(positions[t.x]) - origin;
        const DVec3 b = DVec3(positions[t.y]) - origin;
        const DVec3 c = DVec3(positions[t.z]) - origin;
        volumes[parts.top(t.x)] += glm::dot(a, glm::cross(b, c)) / 6.0;
    }
    const auto positive =
        std::ranges::count_if(volumes, [](const auto& v) { return v.second > 0; });
    const auto negative =
        std::ranges::count_if(volumes, [](const auto& v) { return v.second < 0; });
    const auto all = static_cast<std::ptrdiff_t>(volumes.size());
    if (positive == all) return Winding::outward;
    return negative == all ? Winding::inward : Winding::open;
}

}  // namespace gnomon::scene
