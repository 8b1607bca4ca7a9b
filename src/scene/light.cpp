#include <gnomon/light.h>

#include "base/check.h"

#include <cmath>

namespace gnomon {

namespace {

// Directions may come from text with few digits; beyond this they are no unit vectors by intent.
constexpr float kUnitLengthTolerance = 1e-3f;
constexpr float kRightAngleTolerance = 1e-3f;

bool finite(Vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void require_finite(std::string_view member, Vec3 v) {
    if (!finite(v)) {
        fail_input("light: {} is ({}, {}, {}); it must be finite", member, v.x, v.y, v.z);
    }
}

void require_color(std::string_view member, Vec3 v) {
    require_finite(member, v);
    if (v.x < 0.0f || v.y < 0.0f || v.z < 0.0f) {
        fail_input("light: {} is ({}, {}, {}); it must not be negative", member, v.x, v.y, v.z);
    }
}

void require_unit(std::string_view member, Vec3 v) {
    require_finite(member, v);
    if (std::abs(glm::length(v) - 1.0f) > kUnitLengthTolerance) {
        fail_input("light: {} is ({}, {}, {}) of length {}; it must be of length 1", member, v.x,
                   v.y, v.z, glm::length(v));
    }
}

void require_range(std::string_view member, float value, float min, float max,
                   std::string_view range) {
    if (!(value >= min && value <= max)) {
        fail_input("light: {} is {}; it must be in {}", member, value, range);
    }
}

void require_radius(float radius_m) {
    if (!(radius_m > 0.0f) || !std::isfinite(radius_m)) {
        fail_input("light: radius_m is {}; it must be above 0", radius_m);
    }
}

struct Validator {
    void operator()(const DirectionalLight& light) const {
        require_unit("to_light_ws", light.to_light_ws);
        require_color("irradiance", light.irradiance);
        require_range("angular_diameter_rad", light.angular_diameter_rad, 0.0f, kPi / 2.0f,
                      "[0, 1.5708] (0° to 90°)");
    }
    void operator()(const PointLight& light) const {
        require_finite("position_ws", light.position_ws);
        require_color("intensity", light.intensity);
    }
    void operator()(const SpotLight& light) const {
        require_finite("position_ws", light.position_ws);
        require_unit("direction_ws", light.direction_ws);
        require_color("intensity", light.intensity);
        require_range("outer_angle_rad", light.outer_angle_rad, 1e-4f, kPi / 2.0f,
                      "[0.0001, 1.5708] (to 90°)");
        require_range("inner_angle_rad", light.inner_angle_rad, 0.0f, light.outer_angle_rad,
                      "[0, outer_angle_rad]");
    }
    void operator()(const SphereLight& light) const {
        require_finite("center_ws", light.center_ws);
        require_radius(light.radius_m);
        require_color("radiance", light.radiance);
    }
    void operator()(const DiscLight& light) const {
        require_finite("center_ws", light.center_ws);
        require_unit("normal_ws", light.normal_ws);
        require_radius(light.radius_m);
        require_color("radiance", light.radiance);
    }
    void operator()(const RectLight& light) const {
        require_finite("center_ws", light.center_ws);
        require_finite("half_u_ws", light.half_u_ws);
        require_finite("half_v_ws", light.half_v_ws);
        require_color("radiance", light.radiance);
        const float u_m = glm::length(light.half_u_ws);
        const float v_m = glm::length(light.half_v_ws);
        if (!(u_m > 0.0f) || !(v_m > 0.0f)) {
            fail_input(
                "light: half_u_ws and half_v_ws have lengths {} and {}; both must be above 0", u_m,
                v_m);
        }
        const float cosine = glm::dot(light.half_u_ws, light.half_v_ws) / (u_m * v_m);
        if (std::abs(cosine) > kRightAngleTolerance) {
            fail_input("light: half_u_ws and half_v_ws meet at a cosine of {}; it must be 0",
                       cosine);
        }
    }
};

struct Kind {
    std::string_view operator()(const DirectionalLight&) const { return "directional"; }
    std::string_view operator()(const PointLight&) const { return "point"; }
    std::string_view operator()(const SpotLight&) const { return "spot"; }
    std::string_view operator()(const SphereLight&) const { return "sphere"; }
    std::string_view operator()(const DiscLight&) const { return "disc"; }
    std::string_view operator()(const RectLight&) const { return "rect"; }
};

}  // namespace

std::string_view light_kind(const Light& light) {
    return std::visit(Kind{}, light);
}

const std::string& light_name(const Light& light) {
    return std::visit([](const auto& l) -> const std::string& { return l.name; }, light);
}

bool has_extent(const Light& light) {
    if (const auto* sun = std::get_if<DirectionalLight>(&light)) {
        return sun->angular_diameter_rad > 0.0f;
    }
    return !std::holds_alternative<PointLight>(light) && !std::holds_alternative<SpotLight>(light);
}

void validate(const Light& light) {
    std::visit(Validator{}, light);
}

DirectionalLight sun(float elevation_rad, float azimuth_rad, float angular_diameter_rad) {
    DirectionalLight light;
    light.to_light_ws =
        normalize({std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad),
                   -std::cos(elevation_rad) * std::cos(azimuth_rad)});
    light.irradiance = Vec3(3.0f, 2.9f, 2.7f);  // relative: a slightly warm noon sun
    light.angular_diameter_rad = angular_diameter_rad;
    return light;
}

}  // namespace gnomon
