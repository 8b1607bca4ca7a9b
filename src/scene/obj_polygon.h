#pragma once

#include <gnomon/math.h>

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::scene {

/// Cuts a polygon into count - 2 triangles of its corner numbers, which go round as it does.
///
/// Concave polygons and polygons that are somewhat bent are cut right; where a polygon crosses
/// itself the triangles are as good as any. By clipping ears (G. H. Meisters, "Polygons have ears",
/// 1975) on the plane of the mean normal (M. E. Newell). `budget` is the number of tests of a
/// corner against an ear that may still be made, so that a hostile polygon cannot take for ever;
/// when it is used up, what is left of the polygon becomes a fan.
void triangulate(std::span<const DVec3> polygon, std::uint64_t& budget,
                 std::vector<UVec3>& triangles);

}  // namespace gnomon::scene
