#pragma once

#include <glm/ext/vector_double2.hpp>

#include <vector>

namespace gnomon {

/// A rectangle at any angle.
struct Rectangle {
    glm::dvec2 center{0.0};
    glm::dvec2 axis{1.0, 0.0};  ///< unit vector along `size.x`; `size.y` is to the left of it
    glm::dvec2 size{0.0};
};

/// The rectangle of least area around the points; one of no size around none. One of its sides
/// lies along a side of their convex hull: H. Freeman, R. Shapira, "Determining the Minimum-Area
/// Encasing Rectangle for an Arbitrary Closed Curve", CACM 18(7), 1975.
Rectangle smallest_rectangle(std::vector<glm::dvec2> points);

}  // namespace gnomon
