#include "trace/light_sample.h"

#include <algorithm>
#include <cmath>

namespace gnomon::trace {

namespace {

/// Two unit vectors at right angles to the unit vector `axis` and to each other.
/// T. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
struct Basis {
    Vec3 s, t;
    explicit Basis(Vec3 axis) {
        const float sign = std::copysign(1.0f, axis.z);
        const float a = -1.0f / (sign + axis.z);
        const float b = axis.x * axis.y * a;
        s = {1.0f + sign * axis.x * axis.x * a, sign * b, -sign * axis.x};
        t = {b, sign + axis.y * axis.y * a, -axis.y};
    }
};

/// Unit square to unit disc, areas kept in proportion and neighbours together. P. Shirley, K. Chiu,
/// "A Low Distortion Map Between Disk and Square", JGT 2(3), 1997.
Vec2 concentric_disc(Vec2 u) {
    const Vec2 p = 2.0f * u - 1.0f;
    if (p.x == 0.0f && p.y == 0.0f) return {0.0f, 0.0f};
    const bool wide = std::abs(p.x) > std::abs(p.y);
    const float radius = wide ? p.x : p.y;
    const float angle = wide ? kPi / 4.0f * (p.y / p.x) : kPi / 2.0f - kPi / 4.0f * (p.x / p.y);
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Unit vector in the cone around the unit vector `axis` whose half-angle has the cosine
/// 1 - `one_minus_cos`, uniform over its solid angle.
Vec3 cone_direction(Vec3 axis, float one_minus_cos, Vec2 u) {
    const Vec2 disc = concentric_disc(u);
    const float height = one_minus_cos * glm::dot(disc, disc);  // 1 - the direction's own cosine
    const float scale = std::sqrt(one_minus_cos * (2.0f - height));
    const Basis basis(axis);
    return scale * (disc.x * basis.s + disc.y * basis.t) + (1.0f - height) * axis;
}

/// A place on a plane light: irradiance falls with both cosines and the squared distance.
LightSample sample_area(const Receiver& receiver, Vec3 place_ws, Vec3 light_normal_ws) {
    const Vec3 to_light = place_ws - receiver.position_ws;
    const float received = glm::dot(receiver.normal_ws, to_light);
    const float emitted = -glm::dot(light_normal_ws, to_light);
    if (!(received > 0.0f && emitted > 0.0f)) return {to_light, 0.0f};
    const float distance2 = glm::dot(to_light, to_light);
    return {to_light, (received / distance2) * (emitted / distance2)};
}

Vec3 rect_normal(const RectLight& light) {
    return glm::normalize(glm::cross(light.half_u_ws, light.half_v_ws));
}

/// The part of the unit vector `v` at right angles to the unit vector `axis`, of unit length; zero
/// when there is none.
Vec3 unit_rejection(Vec3 v, Vec3 axis) {
    const Vec3 rejection = v - glm::dot(v, axis) * axis;
    const float length = glm::length(rejection);
    return length > 0.0f ? rejection / length : Vec3(0.0f);
}

/// To the highest place of each kind of light above the receiver's plane.
struct Highest {
    const Receiver& receiver;

    Vec3 from(Vec3 place_ws) const { return place_ws - receiver.position_ws; }
    Vec3 operator()(const DirectionalLight& light) const {
        const float radius_rad = 0.5f * light.angular_diameter_rad;
        return std::cos(radius_rad) * light.to_light_ws +
               std::sin(radius_rad) * unit_rejection(receiver.normal_ws, light.to_light_ws);
    }
    Vec3 operator()(const PointLight& light) const { return from(light.position_ws); }
    Vec3 operator()(const SpotLight& light) const { return from(light.position_ws); }
    Vec3 operator()(const SphereLight& light) const {
        return from(light.center_ws + light.radius_m * receiver.normal_ws);
    }
    Vec3 operator()(const DiscLight& light) const {
        return from(light.center_ws +
                    light.radius_m * unit_rejection(receiver.normal_ws, light.normal_ws));
    }
    Vec3 operator()(const RectLight& light) const {
        const auto towards_normal = [&](Vec3 half) {
            return glm::dot(receiver.normal_ws, half) < 0.0f ? -half : half;
        };
        return from(light.center_ws + towards_normal(light.half_u_ws) +
                    towards_normal(light.half_v_ws));
    }
};

/// Does each kind of light shine towards the place of the receiver, whatever its normal?
struct ShinesAt {
    Vec3 position_ws;

    bool operator()(const DirectionalLight&) const { return true; }
    bool operator()(const PointLight&) const { return true; }
    bool operator()(const SpotLight&) const { return true; }
    bool operator()(const SphereLight& light) const {
        return glm::distance(position_ws, light.center_ws) > light.radius_m;
    }
    bool operator()(const DiscLight& light) const {
        return glm::dot(light.normal_ws, position_ws - light.center_ws) > 0.0f;
    }
    bool operator()(const RectLight& light) const {
        return glm::dot(rect_normal(light), position_ws - light.center_ws) > 0.0f;
    }
};

}  // namespace

Vec3 highest_direction(const Receiver& receiver, const Light& light) {
    return std::visit(Highest{receiver}, light);
}

bool faces_light(const Receiver& receiver, const Light& light) {
    return receiver.exists() && std::visit(ShinesAt{receiver.position_ws}, light) &&
           glm::dot(receiver.normal_ws, highest_direction(receiver, light)) > 0.0f;
}

Vec3 sun_direction(const DirectionalLight& light, Vec2 u) {
    const float half_sine = std::sin(0.25f * light.angular_diameter_rad);
    return cone_direction(light.to_light_ws, 2.0f * half_sine * half_sine, u);
}

// The cone that the sphere fills, as in M. Pharr, W. Jakob, G. Humphreys, "Physically Based
// Rendering", 4th edition (2023), section 6.2.4.
LightSample sample_light(const Receiver& receiver, const SphereLight& light, Vec2 u) {
    const Vec3 to_center = light.center_ws - receiver.position_ws;
    const float distance = glm::length(to_center);
    if (!(distance > light.radius_m)) return {to_center, 0.0f};
    const float max_sine = light.radius_m / distance;
    const float max_cosine = std::sqrt(1.0f - max_sine * max_sine);
    const float one_minus_cos = max_sine * max_sine / (1.0f + max_cosine);
    const Vec3 axis = to_center / distance;
    const Vec3 direction = cone_direction(axis, one_minus_cos, u);
    // To the near side of the sphere.
    const float along = glm::dot(direction, to_center);
    const Vec3 beside = to_center - along * direction;
    const float inside2 = light.radius_m * light.radius_m - glm::dot(beside, beside);
    const float to_surface = along - std::sqrt(std::max(0.0f, inside2));
    return {to_surface * direction, std::max(0.0f, glm::dot(receiver.normal_ws, direction))};
}

LightSample sample_light(const Receiver& receiver, const DiscLight& light, Vec2 u) {
    const Vec2 disc = light.radius_m * concentric_disc(u);
    const Basis basis(light.normal_ws);
    return sample_area(receiver, light.center_ws + disc.x * basis.s + disc.y * basis.t,
                       light.normal_ws);
}

LightSample sample_light(const Receiver& receiver, const RectLight& light, Vec2 u) {
    const Vec2 signed_u = 2.0f * u - 1.0f;
    return sample_area(
        receiver, light.center_ws + signed_u.x * light.half_u_ws + signed_u.y * light.half_v_ws,
        rect_normal(light));
}

Strata::Strata(int count)
    : count_(count),
      rows_(std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(count)))))) {}

Vec2 Strata::point(int index, Vec2 jitter) const {
    // Row r holds the strata from floor(r * count / rows) on; in 64 bits, as count may be large.
    const std::int64_t count = count_;
    const std::int64_t rows = rows_;
    const std::int64_t row = ((index + 1) * rows - 1) / count;
    const std::int64_t first = row * count / rows;
    const auto columns = static_cast<float>((row + 1) * count / rows - first);
    return {(static_cast<float>(index - first) + jitter.x) / columns,
            (static_cast<float>(first) + columns * jitter.y) / static_cast<float>(count)};
}

Vec2 random_2d(std::uint32_t receiver, std::uint32_t sample, std::uint32_t seed) {
    constexpr std::uint32_t kMultiplier = 1664525u;
    constexpr std::uint32_t kIncrement = 1013904223u;
    std::uint32_t x = receiver * kMultiplier + kIncrement;
    std::uint32_t y = sample * kMultiplier + kIncrement;
    std::uint32_t z = seed * kMultiplier + kIncrement;
    const auto mix = [&] {
        x += y * z;
        y += z * x;
        z += x * y;
    };
    mix();
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    mix();
    // The upper 24 bits, which float holds exactly.
    constexpr float kScale = 1.0f / static_cast<float>(1 << 24);
    return {static_cast<float>(x >> 8) * kScale, static_cast<float>(y >> 8) * kScale};
}

}  // namespace gnomon::trace
