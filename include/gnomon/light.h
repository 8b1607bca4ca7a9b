#pragma once

#include <gnomon/math.h>

#include <string>
#include <string_view>
#include <variant>

namespace gnomon {

/// Angular diameter of the sun's disc seen from the Earth, mean over a year.
inline constexpr float kSunAngularDiameterRad = radians(0.533f);

/// Light from a direction, of one strength everywhere: the sun.
struct DirectionalLight {
    Vec3 to_light_ws{0.0f, 1.0f, 0.0f};  ///< unit vector towards the light
    Vec3 irradiance{1.0f};              ///< on a plane facing the light, W/m² (or lux), linear RGB
    float angular_diameter_rad = 0.0f;  ///< of the disc; 0 = no extent, hard shadows
    std::string name = "sun";
};

/// A point that shines equally in all directions.
struct PointLight {
    Vec3 position_ws{0.0f};
    Vec3 intensity{1.0f};  ///< W/sr (or candela), linear RGB
    std::string name = "point";
};

/// A point that shines into a cone, fading between the inner and the outer angle.
struct SpotLight {
    Vec3 position_ws{0.0f};
    Vec3 direction_ws{0.0f, -1.0f, 0.0f};  ///< unit vector, from the light along the cone's axis
    Vec3 intensity{1.0f};                  ///< on the axis, W/sr (or candela), linear RGB
    float inner_angle_rad = 0.0f;          ///< half-angle of full intensity, < outer_angle_rad
    float outer_angle_rad = radians(45);   ///< half-angle where the light ends, <= 90°
    std::string name = "spot";
};

/// A sphere that shines equally everywhere on its surface.
struct SphereLight {
    Vec3 center_ws{0.0f};
    float radius_m = 0.1f;
    Vec3 radiance{1.0f};  ///< W/(m² sr), linear RGB
    std::string name = "sphere";
};

/// A disc that shines to the side of its normal.
struct DiscLight {
    Vec3 center_ws{0.0f};
    Vec3 normal_ws{0.0f, -1.0f, 0.0f};  ///< unit vector
    float radius_m = 0.5f;
    Vec3 radiance{1.0f};
    std::string name = "disc";
};

/// A rectangle that shines to the side of cross(half_u_ws, half_v_ws).
struct RectLight {
    Vec3 center_ws{0.0f};
    Vec3 half_u_ws{0.5f, 0.0f, 0.0f};  ///< from the centre to the middle of one edge
    Vec3 half_v_ws{0.0f, 0.0f, 0.5f};  ///< to the middle of a neighbouring edge; at right angles
    Vec3 radiance{1.0f};
    std::string name = "rect";
};

using Light =
    std::variant<DirectionalLight, PointLight, SpotLight, SphereLight, DiscLight, RectLight>;

/// "directional", "point", "spot", "sphere", "disc" or "rect".
std::string_view light_kind(const Light& light);

/// The light's name, for reports.
const std::string& light_name(const Light& light);

/// False for lights whose shadows are hard: points, spots, a directional light of diameter 0.
bool has_extent(const Light& light);

/// Throws Error{input} naming the member, its value and its range when a member is not finite, a
/// direction is not of unit length within 1e-3, or a size is out of range.
void validate(const Light& light);

/// The sun at `elevation_rad` above the horizon and `azimuth_rad` clockwise (seen from above) from
/// north = -Z, so that azimuth 90° is +X (east) and 180° is +Z.
DirectionalLight sun(float elevation_rad, float azimuth_rad,
                     float angular_diameter_rad = kSunAngularDiameterRad);

}  // namespace gnomon
