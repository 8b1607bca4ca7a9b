#pragma once

#include <gnomon/math.h>

#include <span>

namespace gnomon::scene {

/// Which side of a surface's triangles, seen counter-clockwise, is its outside.
enum class Winding {
    open,     ///< it has none: it does not close, or not all parts of it are wound alike
    outward,  ///< the side that the triangles face: nothing enters but through a face towards it
    inward,   ///< the other one
};

/// Closed: each edge is walked as often in one direction as in the other; vertices are one when
/// their index is. Each connected part has a signed volume, whose sign tells outside from inside.
Winding winding_of(std::span<const Vec3> positions, std::span<const UVec3> triangles);

/// Of a mirror image.
constexpr Winding mirrored(Winding winding) {
    if (winding == Winding::open) return winding;
    return winding == Winding::outward ? Winding::inward : Winding::outward;
}

}  // namespace gnomon::scene
