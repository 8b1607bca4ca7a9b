#pragma once

#include "gpu/commands.h"
#include "raster/gpu_scene.h"

#include <vector>

namespace gnomon {

/// A square depth map: D32, reversed, so that 1 is nearest to the light and 0 is nothing.
class DepthMap {
public:
    explicit DepthMap(const gpu::Device& device);

    /// Draws all casters, both sides, alpha masks honoured unless `ignore_alpha`; casters nearer
    /// than the near plane are clamped to it. The map is ready to be sampled afterwards.
    void record(gpu::Commands& commands, const raster::GpuScene& scene, const Mat4& clip_from_world,
                unsigned size_texels, bool ignore_alpha);

    const gpu::Image& image() const { return image_; }
    std::uint64_t memory_bytes() const {
        return image_.memory_bytes() + instance_matrices_.memory_bytes();
    }

private:
    void make_image(unsigned size_texels);
    void place_instances(gpu::Commands& commands, const raster::GpuScene& scene,
                         const Mat4& clip_from_world);
    void draw(gpu::Commands& commands, const raster::GpuScene& scene, bool ignore_alpha) const;

    const gpu::Device& device_;
    gpu::Pipeline opaque_, masked_;
    gpu::Image image_;
    std::vector<Mat4> clip_from_local_;  // by slot, for one frame; kept for its memory
    gpu::Buffer instance_matrices_;
};

}  // namespace gnomon
