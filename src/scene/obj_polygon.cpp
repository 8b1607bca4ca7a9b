#include "scene/obj_polygon.h"

#include <glm/ext/vector_double2.hpp>

#include <cmath>
#include <numeric>

namespace gnomon::scene {

namespace {

using glm::dvec2;

// Newell's: twice the area times the mean normal.
DVec3 doubled_area_normal(std::span<const DVec3> polygon) {
    DVec3 sum(0.0);
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
        sum += glm::cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
    return sum;
}

// Onto the coordinate plane that the normal points out of most; it turns to the left.
std::vector<dvec2> projected(std::span<const DVec3> polygon, DVec3 normal) {
    const DVec3 size = glm::abs(normal);
    const int out = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int u = (out + 1) % 3;
    const int v = (out + 2) % 3;
    const double turn = normal[out] < 0.0 ? -1.0 : 1.0;
    std::vector<dvec2> points;
    points.reserve(polygon.size());
    for (const DVec3& p : polygon) {
        const DVec3 d = p - polygon[0];  // near 0, where double is finest
        points.emplace_back(d[u], turn * d[v]);
    }
    return points;
}

// Twice the area, positive when a, b, c turn to the left.
double turn_of(dvec2 a, dvec2 b, dvec2 c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool in_triangle(dvec2 p, dvec2 a, dvec2 b, dvec2 c) {
    // A corner that lies on a corner of the ear (the seam of a polygon with a hole) does not count.
    if (p == a || p == b || p == c) return false;
    return turn_of(a, b, p) >= 0.0 && turn_of(b, c, p) >= 0.0 && turn_of(c, a, p) >= 0.0;
}

class EarClipper {
public:
    EarClipper(std::vector<dvec2> points, std::uint64_t& budget)
        : points_(std::move(points)), remaining_(points_.size()), budget_(budget) {
        std::iota(remaining_.begin(), remaining_.end(), 0u);
    }

    void run(std::vector<UVec3>& triangles) {
        std::size_t at = 0;
        std::size_t failures = 0;  // corners in a row that are no ear
        while (remaining_.size() > 3) {
            const std::size_t count = remaining_.size();
            at %= count;
            // When no corner is an ear the polygon crosses itself or has no area: cut anything.
            if (is_ear(at) || failures >= count) {
                triangles.push_back(corners(at));
                remaining_.erase(remaining_.begin() + static_cast<std::ptrdiff_t>(at));
                failures = 0;
            } else {
                ++failures;
                ++at;
            }
        }
        triangles.emplace_back(remaining_[0], remaining_[1], remaining_[2]);
    }

private:
    UVec3 corners(std::size_t at) const {
        const std::size_t count = remaining_.size();
        return {remaining_[(at + count - 1) % count], remaining_[at], remaining_[(at + 1) % count]};
    }

    bool is_ear(std::size_t at) {
        const std::size_t count = remaining_.size();
        if (budget_ < count) return true;
        budget_ -= count;
        const UVec3 ear = corners(at);
        const dvec2 a = points_[ear.x];
        const dvec2 b = points_[ear.y];
        const dvec2 c = points_[ear.z];
        if (!(turn_of(a, b, c) > 0.0)) return false;
        for (const std::uint32_t corner : remaining_) {
            if (corner == ear.x || corner == ear.y || corner == ear.z) continue;
            if (in_triangle(points_[corner], a, b, c)) return false;
        }
        return true;
    }

    std::vector<dvec2> points_;
    std::vector<std::uint32_t> remaining_;
    std::uint64_t& budget_;
};

bool is_convex(const std::vector<dvec2>& points) {
    const std::size_t count = points.size();
    for (std::size_t i = 0; i < count; ++i) {
        if (turn_of(points[i], points[(i + 1) % count], points[(i + 2) % count]) < 0.0)
            return false;
    }
    return true;
}

void fan(std::size_t count, std::vector<UVec3>& triangles) {
    for (std::uint32_t i = 1; i + 1 < count; ++i)
        triangles.emplace_back(0u, i, i + 1);
}

}  // namespace

void triangulate(std::span<const DVec3> polygon, std::uint64_t& budget,
                 std::vector<UVec3>& triangles) {
    if (polygon.size() <= 3) return fan(polygon.size(), triangles);
    const DVec3 normal = doubled_area_normal(polygon);
    const double length = glm::length(normal);
    if (!std::isfinite(length) || length == 0.0) return fan(polygon.size(), triangles);
    std::vector<dvec2> points = projected(polygon, normal);
    // A polygon that turns left everywhere is convex when it goes round once, which one of four
    // corners cannot help; more corners may make a star.
    constexpr std::size_t kQuad = 4;
    if (polygon.size() == kQuad && is_convex(points)) return fan(kQuad, triangles);
    EarClipper(std::move(points), budget).run(triangles);
}

}  // namespace gnomon::scene
