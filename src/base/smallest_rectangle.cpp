#include "base/smallest_rectangle.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>

namespace gnomon {

namespace {

using glm::dvec2;

double cross(dvec2 a, dvec2 b) {
    return a.x * b.y - a.y * b.x;
}

/// Counter-clockwise. A. Andrew, "Another Efficient Algorithm for Convex Hulls in Two Dimensions",
/// Information Processing Letters 9(5), 1979.
std::vector<dvec2> convex_hull(std::vector<dvec2> points) {
    const auto less = [](dvec2 a, dvec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; };
    std::ranges::sort(points, less);
    std::vector<dvec2> hull;
    const auto add_chain = [&](auto first, auto last) {
        const std::size_t start = hull.size();
        for (; first != last; ++first) {
            while (hull.size() >= start + 2 &&
                   cross(hull.back() - hull[hull.size() - 2], *first - hull.back()) <= 0.0) {
                hull.pop_back();
            }
            hull.push_back(*first);
        }
        hull.pop_back();  // the next chain begins with it
    };
    add_chain(points.begin(), points.end());
    add_chain(points.rbegin(), points.rend());
    return hull;
}

Rectangle rectangle_along(dvec2 axis, const std::vector<dvec2>& points) {
    dvec2 low(std::numeric_limits<double>::infinity());
    dvec2 high = -low;
    const dvec2 left(-axis.y, axis.x);
    for (const dvec2 p : points) {
        const dvec2 along(glm::dot(axis, p), glm::dot(left, p));
        low = glm::min(low, along);
        high = glm::max(high, along);
    }
    const dvec2 middle = 0.5 * (low + high);
    return {middle.x * axis + middle.y * left, axis, high - low};
}

}  // namespace

Rectangle smallest_rectangle(std::vector<dvec2> points) {
    if (points.empty()) return {};
    const std::vector<dvec2> hull = convex_hull(points);
    Rectangle smallest = rectangle_along({1.0, 0.0}, points);
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const dvec2 side = hull[(i + 1) % hull.size()] - hull[i];
        const double length = glm::length(side);
        if (!(length > 0.0)) continue;
        const Rectangle rectangle = rectangle_along(side / length, hull);
        if (rectangle.size.x * rectangle.size.y < smallest.size.x * smallest.size.y) {
            smallest = rectangle;
        }
    }
    return smallest;
}

}  // namespace gnomon
