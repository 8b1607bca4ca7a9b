#pragma once

#include <gnomon/bake.h>

namespace gnomon::bake {

/// A path through one direction.
struct PathThrough {
    BakePath path;
    double steps_per_rad = 0.0;  ///< of the light's way across the sky
    PathEnds ends{};
};

/// The circle about the pole through a direction, which is the sun's way of a day but for the
/// quarter of a degree that its declination changes: the arc above the plane across `up_ws`, or
/// all of it when it does not cross that plane or the direction is below it. `steps` of it, or
/// one when the direction is a pole's.
PathThrough circle_through(DVec3 to_light_ws, DVec3 pole_ws, DVec3 up_ws, int steps);

/// Where a direction is on a path that circle_through() made, when it is on its circle: within
/// `tolerance_rad`; else negative. Less than the number of steps on a whole circle.
double step_on(const PathThrough& path, DVec3 to_light_ws, double tolerance_rad);

}  // namespace gnomon::bake
