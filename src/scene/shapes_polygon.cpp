/// The triangulation of a simple polygon whose worst triangle is best, by dynamic programming over
/// its diagonals (G. T. Klincsek, "Minimal triangulations of polygonal domains", 1980, with another
/// measure). O(n³), for outlines of up to some hundred points.
///
/// No diagonal is tested for lying inside: when all triangles are counter-clockwise, they cover
/// each point as often as the outline winds about it, which is once inside and never outside.

#include "scene/shapes.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace gnomon::scene {

namespace {

using DVec2 = glm::dvec2;

/// Height over the longest side, as a fraction of that side: 0.87 for an equilateral triangle, 0
/// for none, below 0 for a clockwise one.
double shape_quality(DVec2 a, DVec2 b, DVec2 c) {
    const auto squared_length = [](DVec2 v) { return v.x * v.x + v.y * v.y; };
    const double doubled_area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    return doubled_area /
           std::max({squared_length(b - a), squared_length(c - b), squared_length(a - c)});
}

/// The best triangulation of the part of the polygon from one point on to another.
struct Part {
    double worst_quality = 1.0;
    std::size_t apex = 0;  ///< third corner of the triangle over the diagonal
};

}  // namespace

std::vector<UVec3> triangulate(const std::vector<Vec2>& outline) {
    const std::vector<DVec2> points(outline.begin(), outline.end());
    const std::size_t count = points.size();
    std::vector<Part> parts(count * count);  // by first and last point
    for (std::size_t span = 2; span < count; ++span) {
        for (std::size_t first = 0; first + span < count; ++first) {
            const std::size_t last = first + span;
            Part best{-1.0, first + 1};
            for (std::size_t apex = first + 1; apex < last; ++apex) {
                const double worst =
                    std::min({parts[first * count + apex].worst_quality,
                              parts[apex * count + last].worst_quality,
                              shape_quality(points[first], points[apex], points[last])});
                if (worst > best.worst_quality) best = {worst, apex};
            }
            parts[first * count + last] = best;
        }
    }

    std::vector<UVec3> triangles;
    std::vector<std::pair<std::size_t, std::size_t>> diagonals{{0, count - 1}};
    while (!diagonals.empty()) {
        const auto [first, last] = diagonals.back();
        diagonals.pop_back();
        if (last - first < 2) continue;
        const std::size_t apex = parts[first * count + last].apex;
        triangles.emplace_back(first, apex, last);
        diagonals.emplace_back(first, apex);
        diagonals.emplace_back(apex, last);
    }
    return triangles;
}

}  // namespace gnomon::scene
