#pragma once

#include <gnomon/progress.h>
#include <gnomon/scene.h>

#include "trace/receiver.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gnomon::trace {

class Caster;

/// Visibility by rays: the ground truth. Immutable once made, and safe to use from several threads.
/// Runs on TBB's threads; every result is the same on any number of them.
class Tracer {
public:
    /// Builds the acceleration structure; keeps the scene alive. With `ignore_alpha` masked
    /// materials are solid. Throws Error{machine} when memory runs out, Error{cancelled}.
    Tracer(const Scene& scene, bool ignore_alpha, Progress& progress);
    ~Tracer();
    Tracer(Tracer&&) noexcept;
    Tracer& operator=(Tracer&&) noexcept;

    /// The receiver of each pixel, row-major, top row first, from the surfaces that the pixels show
    /// (width * height): where the ray through the pixel's centre meets the plane of the triangle,
    /// computed in double from the scene, so that no depth buffer's precision enters. A centre that
    /// misses its triangle (rasterisers move corners by up to 1/512 of a pixel), or meets its very
    /// edge, is moved into it. Triangles without area give no receiver.
    std::vector<Receiver> receivers(const Camera& camera, Extent size,
                                    std::span<const SurfaceId> surfaces) const;

    /// Visibility of `light`, in [0, 1], at width * height receivers, to `out` of that length:
    /// irradiance received / irradiance received if nothing were in the way. 1 where there is no
    /// receiver, 0 where faces_light() is false. Lights without extent take one ray, others
    /// `samples` (at least 1) stratified ones, different for each receiver and `seed`.
    /// Throws Error{cancelled}.
    void visibility(std::span<const Receiver> receivers, Extent size, const Light& light,
                    int samples, unsigned seed, std::span<float> out, Progress& progress) const;

    /// Which of `rays` are blocked before they reach their light, as visibility() sees it: 1 for
    /// those, else 0, to `out` of that length. All are to infinity or none is. Runs on the calling
    /// thread alone.
    void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> out) const;

    /// What the ray through each pixel's centre sees first, row-major, top row first. Holes of
    /// masked materials and the backs of materials that are not double-sided are not seen.
    /// Throws Error{cancelled}.
    std::vector<SurfaceId> visible_surfaces(const Camera& camera, Extent size,
                                            Progress& progress) const;

    /// What is seen first, in the same way, from each place along a direction, from `t_min` times
    /// it on. Throws Error{cancelled}.
    std::vector<SurfaceId> first_seen(std::span<const Vec3> from_ws, Vec3 direction_ws, float t_min,
                                      Progress& progress) const;

private:
    Scene scene_;
    std::unique_ptr<const Caster> caster_;
};

}  // namespace gnomon::trace
