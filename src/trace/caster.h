#pragma once

#include <gnomon/progress.h>
#include <gnomon/scene.h>

#include "trace/receiver.h"

#include <cstdint>
#include <memory>
#include <span>

namespace gnomon::trace {

/// The scene's triangles, ready to be hit by rays. The only file that knows Embree is caster.cpp.
/// Immutable once made, and safe to use from several threads.
class Caster {
public:
    /// The most rays that are traced together.
    static constexpr std::size_t kBatchSize = 256;

    /// Keeps the scene alive. Throws Error{machine} when memory runs out, Error{cancelled}.
    Caster(const Scene& scene, bool ignore_alpha, Progress& progress);
    ~Caster();
    Caster(const Caster&) = delete;
    Caster& operator=(const Caster&) = delete;

    /// Finds which of at most kBatchSize rays are blocked before they reach the light. Everything
    /// blocks, whatever its facing, but the receiver's own triangle, triangles that the ray touches
    /// only (touches_only), and the holes of masked materials. Fastest with many rays that are
    /// close together and alike in direction.
    void trace(std::span<ShadowRay> rays) const;

    /// The first triangle that is seen at `t_min` to `t_max` times `direction_ws` from `origin_ws`;
    /// kNoReceiver when none is. Holes and the backs of single-sided materials are not seen.
    SurfaceId first_seen(Vec3 origin_ws, Vec3 direction_ws, float t_min, float t_max) const;

private:
    class Impl;
    std::unique_ptr<const Impl> impl_;
};

}  // namespace gnomon::trace
