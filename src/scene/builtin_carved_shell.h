#pragma once

#include <gnomon/scene.h>

#include <functional>

namespace gnomon::scene {

/// A closed surface about the origin, as its point in each direction (a unit vector).
using StarSurface = std::function<Vec3(Vec3)>;
/// Below 0 for directions in which the shell is cut away, above 0 elsewhere; about the angle to the
/// outline in rad.
using CarvedOutline = std::function<float(Vec3)>;

/// A solid within `surface`, on a grid of `sides` meridians and `rings` parallels: closed.
Mesh star_solid(const StarSurface& surface, int sides, int rings);

/// The shell between `outer` and `inner`, with holes through it where `outline` is below 0: one
/// closed 2-manifold (several if the holes cut it apart), the walls of the holes included. Holes
/// must be clear of both poles.
Mesh carved_shell(const StarSurface& outer, const StarSurface& inner, const CarvedOutline& outline,
                  int sides, int rings);

}  // namespace gnomon::scene
