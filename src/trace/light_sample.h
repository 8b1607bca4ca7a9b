#pragma once

#include <gnomon/light.h>

#include "trace/receiver.h"

#include <algorithm>

namespace gnomon::trace {

/// True where any part of the light is above the receiver's plane and shines towards it: discs and
/// rectangles shine to one side, spheres to the outside. The cone of a spot does not count, because
/// visibility is about what is in the way.
bool faces_light(const Receiver& receiver, const Light& light);

/// A place on a light as a receiver sees it.
struct LightSample {
    /// To the place, of that length; a unit vector for a directional light.
    Vec3 direction_ws{0.0f};
    /// Irradiance from the place if nothing is in the way, relative to the light's other samples.
    /// 0 below the receiver's horizon and behind a light that shines to one side.
    float weight = 0.0f;
};

/// The only place of a light that is a point.
inline LightSample sample_point(const Receiver& receiver, Vec3 position_ws) {
    const Vec3 to_light = position_ws - receiver.position_ws;
    return {to_light, glm::dot(receiver.normal_ws, to_light) > 0.0f ? 1.0f : 0.0f};
}

/// A direction in the sun's disc of which `u` is the place.
Vec3 sun_direction(const DirectionalLight& light, Vec2 u);

/// The place on the light that `u`, uniform in [0, 1)², picks; the only one when the light has no
/// extent. Equal areas of `u` have equal solid angles (sun, sphere) or equal areas (disc,
/// rectangle), and neighbours stay neighbours, so that strata of `u` are strata of the light.
inline LightSample sample_light(const Receiver& receiver, const DirectionalLight& light, Vec2 u) {
    const Vec3 direction =
        light.angular_diameter_rad > 0.0f ? sun_direction(light, u) : light.to_light_ws;
    return {direction, std::max(0.0f, glm::dot(receiver.normal_ws, direction))};
}
inline LightSample sample_light(const Receiver& receiver, const PointLight& light, Vec2) {
    return sample_point(receiver, light.position_ws);
}
inline LightSample sample_light(const Receiver& receiver, const SpotLight& light, Vec2) {
    return sample_point(receiver, light.position_ws);
}
LightSample sample_light(const Receiver& receiver, const SphereLight& light, Vec2 u);
LightSample sample_light(const Receiver& receiver, const DiscLight& light, Vec2 u);
LightSample sample_light(const Receiver& receiver, const RectLight& light, Vec2 u);

/// Direction to the place of the light that is highest above the receiver's plane, as
/// LightSample::direction_ws: where light comes from when all samples are below the horizon.
Vec3 highest_direction(const Receiver& receiver, const Light& light);

/// `count` strata of the unit square, of equal area and nearly square, for any count: rows of
/// sqrt(count) strata each, as even as the count allows, as high as the row has strata.
class Strata {
public:
    explicit Strata(int count);
    int count() const { return count_; }
    /// The point of stratum `index` that `jitter`, in [0, 1)², picks.
    Vec2 point(int index, Vec2 jitter) const;

private:
    int count_, rows_;
};

/// Random numbers in [0, 1)² that depend on nothing but the arguments. M. Jarzynski, M. Olano,
/// "Hash Functions for GPU Rendering", JCGT 9(3), 2020: pcg3d.
Vec2 random_2d(std::uint32_t receiver, std::uint32_t sample, std::uint32_t seed);

}  // namespace gnomon::trace
