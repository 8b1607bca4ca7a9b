#pragma once

#include <gnomon/math.h>

#include <span>

namespace gnomon::lighting {

/// What the fully lit picture tells of the light in it.
struct LightLevel {
    float mean_irradiance_over_pi = 0.0f;  ///< over all receivers
    float bright_luminance = 0.0f;         ///< that 98 % of the lit pixels do not exceed
};

/// `full`: RGB radiance and irradiance / pi of each pixel as if nothing were in the way, all 0
/// where nothing is seen.
LightLevel measure(std::span<const Vec4> full);

/// Radiance from everywhere that brightens shadows a little: a fixed share of the mean light.
Vec3 default_ambient(const LightLevel& level);

/// The factor that makes the bright parts nearly white; 1 for a picture without light.
float default_exposure(const LightLevel& level, Vec3 ambient);

}  // namespace gnomon::lighting
