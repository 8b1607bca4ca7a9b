#pragma once

#include <gnomon/progress.h>
#include <gnomon/scene.h>

#include "trace/receiver.h"

#include <array>
#include <cstddef>
#include <memory>

namespace gnomon::trace {

/// Rays from receivers to one light that are traced together, member by member, which is how they
/// are written and traced fastest.
class ShadowRays {
public:
    static constexpr std::size_t kCapacity = 256;

    /// `to_infinity`: the light is infinitely far, directions are unit vectors. Else directions
    /// have the length of the way to the light.
    explicit ShadowRays(bool to_infinity);

    std::size_t size() const { return size_; }
    bool full() const { return size_ == kCapacity; }
    void clear() { size_ = 0; }

    /// Not when full. The receiver must live until the rays are traced.
    void add(const Receiver& receiver, Vec3 direction_ws) {
        const Vec3 origin_ws = lifted_position_ws(receiver);
        origin_x_[size_] = origin_ws.x;
        origin_y_[size_] = origin_ws.y;
        origin_z_[size_] = origin_ws.z;
        direction_x_[size_] = direction_ws.x;
        direction_y_[size_] = direction_ws.y;
        direction_z_[size_] = direction_ws.z;
        far_[size_] = end_;
        receivers_[size_] = &receiver;
        ++size_;
    }

    ShadowRay ray(std::size_t i) const {
        return {receivers_[i], {direction_x_[i], direction_y_[i], direction_z_[i]}, to_infinity_};
    }
    /// What Caster::trace() found.
    bool blocked(std::size_t i) const { return far_[i] < 0.0f; }

private:
    friend class Caster;

    template <typename T>
    using Lanes = std::array<T, kCapacity>;
    alignas(64) Lanes<float> origin_x_, origin_y_, origin_z_;
    alignas(64) Lanes<float> direction_x_, direction_y_, direction_z_;
    alignas(64) Lanes<float> far_;
    Lanes<const Receiver*> receivers_;
    bool to_infinity_;
    float end_;  ///< the light's place on the rays
    std::size_t size_ = 0;
};

/// The scene's triangles, ready to be hit by rays. The only file that knows Embree is caster.cpp.
/// Immutable once made, and safe to use from several threads.
class Caster {
public:
    /// Keeps the scene alive. Throws Error{machine} when memory runs out, Error{cancelled}.
    Caster(const Scene& scene, bool ignore_alpha, Progress& progress);
    ~Caster();
    Caster(const Caster&) = delete;
    Caster& operator=(const Caster&) = delete;

    /// Finds which rays are blocked before they reach the light. Everything blocks, whatever its
    /// facing, but the receiver's own triangle, triangles that the ray touches only (touches_only),
    /// and the holes of masked materials. Fastest with many rays that are close together and alike
    /// in direction.
    void trace(ShadowRays& rays) const;

    /// The first triangle that is seen at `t_min` to `t_max` times `direction_ws` from `origin_ws`;
    /// kNoReceiver when none is. Holes and the backs of single-sided materials are not seen.
    SurfaceId first_seen(Vec3 origin_ws, Vec3 direction_ws, float t_min, float t_max) const;

private:
    class Impl;
    std::unique_ptr<const Impl> impl_;
};

}  // namespace gnomon::trace
