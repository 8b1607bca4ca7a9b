#pragma once

#include <gnomon/scene.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace gnomon::trace {

/// SurfaceId::instance where there is no receiver.
inline constexpr std::uint32_t kNoReceiver = 0xffffffff;
/// SurfaceId::instance of a receiver that is on no triangle of the scene: it ignores none.
inline constexpr std::uint32_t kNoSurface = 0xfffffffe;

/// Greatest relative error of one rounding to float.
inline constexpr double kUnitRoundoff = 0.5 * std::numeric_limits<float>::epsilon();

/// A triangle of the scene.
struct SurfaceId {
    std::uint32_t instance = kNoReceiver;  ///< index into Scene::instances()
    std::uint32_t primitive = 0;           ///< index into the mesh's triangles
    bool operator==(const SurfaceId&) const = default;
};

/// A point that asks how much of a light it sees.
struct Receiver {
    Vec3 position_ws{0.0f};
    Vec3 normal_ws{0.0f};  ///< geometric unit normal, turned towards the viewer
    SurfaceId id;

    bool exists() const { return id.instance != kNoReceiver; }
};

/// The corners of a triangle in the world, in double: exact but for the last bits.
struct Triangle {
    std::array<DVec3, 3> corners_ws;
    /// The greatest sum of magnitudes, over the corners, that made each coordinate: its rounding
    /// errors are relative to this.
    DVec3 magnitude{0.0};
    bool mirrored = false;  ///< the instance mirrors: counter-clockwise is seen from the back

    /// Of length twice the area, on the side that is the material's front.
    DVec3 front_normal_ws() const;
    /// Coordinates of the point of its plane that is nearest to `p_ws`. It has an area.
    DVec3 barycentric(DVec3 p_ws) const;
};

Triangle world_triangle(const Scene& scene, SurfaceId surface);

/// Roundings behind a corner's height over another triangle's plane. A coordinate is rounded twice
/// (in the mesh, and as a factor of the instance's matrix); a plane through three such corners errs
/// up to twice as much beside its triangle, over a neighbour of its own size; the neighbour's
/// corner adds its own two, the receiver's position one.
inline constexpr double kHeightRoundings = 2 * 2 + 2 + 1;

/// How much a height along `normal` can err when the coordinates that it comes from have these
/// magnitudes. Scales with the length of `normal`, as the height does.
inline double height_error(DVec3 normal, DVec3 magnitude) {
    return kHeightRoundings * kUnitRoundoff * glm::dot(glm::abs(normal), magnitude);
}

/// A ray towards a light. `direction_ws` has the length of the way to the light, so that the light
/// is at t = 1; or it is a unit vector and the light infinitely far.
struct ShadowRay {
    const Receiver* receiver = nullptr;
    Vec3 direction_ws{0.0f};
    bool to_infinity = false;
};

/// True when `triangle` of the scene, which the ray was found to hit, is not in the ray's way as
/// far as float coordinates can tell. See receiver.cpp.
bool touches_only(const Scene& scene, const Triangle& triangle, const ShadowRay& ray);

/// How far rounding to float can have moved a position, at most, in metres.
inline float rounding_distance_m(Vec3 position_ws) {
    return static_cast<float>(kUnitRoundoff) *
           (std::abs(position_ws.x) + std::abs(position_ws.y) + std::abs(position_ws.z));
}

/// Where the receiver's rays start: surely not below its plane, where they could pass beneath the
/// foot of a wall, and above it by no more than rounding. Twice the rounding distance, for the
/// position's own and for that of the sum.
inline Vec3 lifted_position_ws(const Receiver& receiver) {
    return receiver.position_ws +
           2.0f * rounding_distance_m(receiver.position_ws) * receiver.normal_ws;
}

/// Where the ray from `origin_ws` along `direction_ws` meets the plane of the triangle, moved into
/// it when it is outside or within rounding of an edge; with the normal turned against the ray.
/// No receiver when the triangle has no area.
Receiver receiver_on(const Triangle& triangle, SurfaceId surface, DVec3 origin_ws,
                     DVec3 direction_ws);

}  // namespace gnomon::trace
