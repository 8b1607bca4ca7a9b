#pragma once

#include <gnomon/context.h>
#include <gnomon/image.h>
#include <gnomon/light.h>
#include <gnomon/metrics.h>
#include <gnomon/scene.h>

#include <memory>

namespace gnomon {

/// What is asked of a technique: one light, seen from one camera.
struct Frame {
    Scene scene;
    Camera camera;
    Light light;
    Extent size{1280, 720};     ///< pixels, each side 1 to 16,384
    bool ignore_alpha = false;  ///< alpha masks count as solid, for the eye and for light

    /// Throws Error{input} naming the member, its value and its range.
    void validate() const;
};

/// Visibility of one light at every receiver: irradiance received / irradiance received if nothing
/// were in the way, in [0, 1]. 1 where there is no receiver; 0 where the light is wholly below the
/// receiver's horizon. Lives on the device or on the host and moves when asked.
class Visibility {
public:
    Visibility();
    ~Visibility();
    Visibility(Visibility&&) noexcept;
    Visibility& operator=(Visibility&&) noexcept;

    Extent size() const;

    /// 1 channel, values in [0, 1]. Copied from the device at the first call after a render.
    const Image& image() const;

    /// 1 channel: side of the technique's texel in metres at each receiver; empty when the
    /// technique has none.
    const Image& texel_size_m() const;

    /// How many texels from its centre the technique's filter reaches; 0 without texels.
    float filter_radius_texels() const;

    class Impl;
    Impl& impl() const { return *impl_; }  ///< moving between device and host changes no value

private:
    std::unique_ptr<Impl> impl_;
};

struct TraceOptions {
    int samples =
        256;  ///< rays per receiver for a light with extent, 1 to 65,536; else one is cast
    unsigned seed = 1;  ///< same seed, same image, on any number of threads
};

/// The ground truth: visibility by rays, one per receiver for lights without extent, else `samples`
/// stratified ones over the light. Nothing but its own triangle is ignored by a ray.
Visibility trace_visibility(Context& context, const Frame& frame, const TraceOptions& options = {});
Visibility trace_visibility(Context& context, const Frame& frame, const TraceOptions& options,
                            Progress& progress);

/// The mask of a frame: receivers whose geometric normal sees any part of the light; and edges by
/// rays to the middle of suns, point lights and spots.
ComparisonMask comparison_mask(Context& context, const Frame& frame);

/// A visibility against the truth, by the technique's own texel size and filter radius. The mask's
/// edges count for texels that lie across the light.
Comparison compare(const Visibility& visibility, const Visibility& truth,
                   const ComparisonMask& mask);

}  // namespace gnomon
