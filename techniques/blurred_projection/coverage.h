#pragma once

#include "visibility/light_fit.h"
#include "visibility/map_blur.h"
#include "visibility/object_map.h"

namespace gnomon::blurred_projection {

/// A light's coloured picture: of each channel's owner what the light sees, beside where the owner
/// is at all, both blurred.
class Coverage {
public:
    /// `owners`: of the channels, how many have one.
    Coverage(const gpu::Device& device, unsigned owners, float blur_texels);

    /// From a map of the same fit. Ready to be sampled afterwards; `owners`, a shared::Owners, is
    /// ready to be read.
    void record(gpu::Commands& commands, const raster::GpuScene& scene, const LightFit& fit,
                const ObjectMap& map, const gpu::Buffer& owners, bool ignore_alpha);

    /// An array, RGBA16F: each layer kOwnersPerLayer owners.
    const gpu::Image& image() const { return image_; }
    std::uint64_t memory_bytes() const {
        return presence_.memory_bytes() + image_.memory_bytes() + blur_.memory_bytes();
    }

private:
    void make_images(Extent size);
    void draw_presence(gpu::Commands& commands, const raster::GpuScene& scene, const LightFit& fit,
                       const gpu::Buffer& owners, bool ignore_alpha);

    const gpu::Device& device_;
    unsigned layers_;
    gpu::Pipeline draw_, cover_;
    gpu::Sampler nearest_;
    MapBlur blur_;
    gpu::Image presence_, image_;
};

}  // namespace gnomon::blurred_projection
