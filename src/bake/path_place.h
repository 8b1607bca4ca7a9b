#pragma once

#include <gnomon/bake.h>

namespace gnomon::bake {

/// Exact for small angles.
double angle_between(DVec3 a, DVec3 b);

/// A place on a path.
struct PathPlace {
    double at_step = 0.0;
    DVec3 along_ws{0.0};  ///< unit vector to where the light goes; zero when it stands still
};

/// Where on its path a direction is, in [0, steps]: the inverse of light_at(). Of several times in
/// one direction the first, as a static scene looks alike in all. Nothing when it is
/// `tolerance_rad` off the path.
std::optional<PathPlace> place_on(const BakePath& path, DVec3 to_light_ws, double tolerance_rad);

/// On the average of the path; 0 when the light stands still.
double steps_per_rad(const BakePath& path);

/// disc_width_steps() for a disc of another width.
double disc_width_steps(const BakePath& path, double angular_diameter_rad, int codes_per_step);

}  // namespace gnomon::bake
