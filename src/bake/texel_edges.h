#pragma once

#include <gnomon/bake.h>
#include <gnomon/math.h>

#include <glm/ext/matrix_double2x2.hpp>
#include <glm/ext/vector_double2.hpp>

#include <array>
#include <cstddef>

namespace gnomon::bake {

/// Four texels of a page that are the corners of a square: first row, second row.
using FourTexels = std::array<std::size_t, 4>;

/// A receiver between four texels.
struct BetweenTexels {
    FourTexels texels{};
    std::array<double, 4> weights{};            ///< sum to 1
    std::array<glm::dvec2, 4> places_texels{};  ///< where the texels ask, from the receiver
    double path_codes = 0.0;                    ///< the length of the path
    glm::dmat2 normal_from_slope{0.0};          ///< see normal_from_slope()
};

/// From the slope of an edge's time over a page, in time per texel to the right and per texel down,
/// to a normal of the edge in the sky: its parts along the light's path, > 0, and across it. A
/// texel is `u_ws` wide and `v_ws` high. 0 where the light grazes the surface.
glm::dmat2 normal_from_slope(DVec3 u_ws, DVec3 v_ws, DVec3 along_ws, DVec3 across_ws);

/// How much of the light is seen there. A shadow's edge passes the texels one after the other: each
/// rise and each fall of a texel is moved to the weighted mean of its time and those of the same
/// edge at the other texels. Edges are the same when each is the other's nearest in time of all
/// that the two texels have of that kind, and they are not a sixteenth of the path apart. The slope
/// of these times tells how the edge lies to the path, and so how long it takes to cross the
/// light's disc. What the texels then see is mixed by the weights, so an edge that not all of them
/// have fades.
double edges_visibility(const IntervalPage& page, const BetweenTexels& between,
                        const LightWindow& window);

/// Whether all four have the same edges, but for what is dark or lit for a hundredth of the path.
bool have_same_edges(const IntervalPage& page, const FourTexels& texels, double path_codes);

}  // namespace gnomon::bake
