#pragma once

#include <glm/common.hpp>
#include <glm/ext/vector_double2.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

/// Which texels a triangle covers. Texel (x, y) is the square from (x, y) to (x + 1, y + 1).
namespace gnomon::lightmap {

using glm::dvec2;

/// Corners in texels, any way round.
using Corners = std::array<dvec2, 3>;

/// A triangle that reaches less than this into a texel does not touch it: what lies on the border
/// between texels is there to float's precision. 2^-10: a float below 4,096 texels is finer.
inline constexpr double kBorder_texels = 1.0 / 1024.0;

namespace coverage {

struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    void include(double x) {
        low = std::min(low, x);
        high = std::max(high, x);
    }
};

/// The texels that [low, high] touches, at least one.
struct Span {
    int begin, end;
};
inline Span touched_span(Range range) {
    if (range.high - range.low <= 2.0 * kBorder_texels) {
        const int middle = static_cast<int>(std::floor(0.5 * (range.low + range.high)));
        return {middle, middle + 1};
    }
    return {static_cast<int>(std::floor(range.low + kBorder_texels)),
            static_cast<int>(std::ceil(range.high - kBorder_texels))};
}

/// Adds where the part of the segment with y in [low, high] lies along x.
inline void include_part(dvec2 a, dvec2 b, double low, double high, Range& x) {
    if (a.y > b.y) std::swap(a, b);
    if (b.y < low || a.y > high) return;
    const auto at = [&](double y) { return a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x); };
    x.include(a.y >= low ? a.x : at(low));
    x.include(b.y <= high ? b.x : at(high));
}

}  // namespace coverage

/// Calls visit(y, x_begin, x_end) for each row of texels that the triangle touches, by the exact
/// extent of a convex shape within each row.
template <typename Visit>
void for_touched(const Corners& c, const Visit& visit) {
    coverage::Range height;
    for (const dvec2 corner : c)
        height.include(corner.y);
    const coverage::Span rows = coverage::touched_span(height);
    for (int y = rows.begin; y < rows.end; ++y) {
        coverage::Range x;
        for (std::size_t i = 0; i < 3; ++i)
            coverage::include_part(c[i], c[(i + 1) % 3], y, y + 1.0, x);
        if (!(x.low <= x.high)) continue;
        const coverage::Span columns = coverage::touched_span(x);
        visit(y, columns.begin, columns.end);
    }
}

/// The same for the texels whose centres lie inside. A centre on the edge between two triangles
/// belongs to one of them, whatever the order of their corners, as both find the same crossing.
template <typename Visit>
void for_centres(const Corners& c, const Visit& visit) {
    const auto [low, high] = std::minmax({c[0].y, c[1].y, c[2].y});
    const auto first = static_cast<int>(std::ceil(low - 0.5));
    for (int y = first; y + 0.5 < high; ++y) {
        coverage::Range x;
        for (std::size_t i = 0; i < 3; ++i) {
            dvec2 a = c[i];
            dvec2 b = c[(i + 1) % 3];
            if (a.y > b.y) std::swap(a, b);
            const double at = y + 0.5;
            if (a.y <= at && at < b.y) x.include(a.x + (at - a.y) / (b.y - a.y) * (b.x - a.x));
        }
        if (!(x.low <= x.high)) continue;
        visit(y, static_cast<int>(std::ceil(x.low - 0.5)),
              static_cast<int>(std::ceil(x.high - 0.5)));
    }
}

/// Weights of the corners, which sum to 1, at the triangle's point nearest to `p`: inside it those
/// of `p` itself.
inline std::array<double, 3> nearest_weights(const Corners& c, dvec2 p) {
    const auto cross = [](dvec2 a, dvec2 b) { return a.x * b.y - a.y * b.x; };
    const double area = cross(c[1] - c[0], c[2] - c[0]);
    std::array<double, 3> weights{};
    for (std::size_t i = 0; i < 3; ++i) {
        const dvec2 from = c[(i + 1) % 3];
        weights[i] = cross(c[(i + 2) % 3] - from, p - from) / area;
    }
    // Without area the weights are no numbers, and the point is on an edge.
    if (area != 0.0 && *std::ranges::min_element(weights) >= 0.0) return weights;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
        const dvec2 edge = c[(i + 1) % 3] - c[i];
        const double length2 = glm::dot(edge, edge);
        const double t =
            length2 > 0.0 ? std::clamp(glm::dot(p - c[i], edge) / length2, 0.0, 1.0) : 0.0;
        const dvec2 away = p - (c[i] + t * edge);
        if (glm::dot(away, away) >= least) continue;
        least = glm::dot(away, away);
        weights = {};
        weights[i] = 1.0 - t;
        weights[(i + 1) % 3] = t;
    }
    return weights;
}

inline dvec2 weighted(const Corners& c, const std::array<double, 3>& weights) {
    return weights[0] * c[0] + weights[1] * c[1] + weights[2] * c[2];
}

}  // namespace gnomon::lightmap
