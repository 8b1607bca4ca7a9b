#pragma once

#include <gnomon/scene.h>

#include "trace/receiver.h"

namespace gnomon::interval {

/// Whether a triangle of the scene is in the way of the sun for a receiver, in double: what is
/// computed in float must agree with it wherever float cannot tell. Rays start, and triangles that
/// they only touch are ignored, as trace::Tracer does it. Holes of masked materials let light
/// through unless `ignore_alpha`. `to_sun_ws` is a unit vector.
bool blocks(const Scene& scene, bool ignore_alpha, trace::SurfaceId surface,
            const trace::Receiver& receiver, DVec3 to_sun_ws);

}  // namespace gnomon::interval
