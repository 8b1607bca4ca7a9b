#pragma once

#include "gpu/commands.h"

namespace gnomon {

/// Blurs what the texels of a map's square layers hold, along one axis and then along the other, by
/// a bell that ends at the radius.
class MapBlur {
public:
    MapBlur(const gpu::Device& device, float radius_texels);

    /// `image` is a storage image that can be sampled, an array; ready to be sampled afterwards. A
    /// radius of 0 leaves it as it is.
    void record(gpu::Commands& commands, gpu::Image& image);

    std::uint64_t memory_bytes() const { return between_.memory_bytes(); }

private:
    void blur(gpu::Commands& commands, gpu::Image& source, gpu::Image& target, glm::uvec2 step);

    const gpu::Device& device_;
    float radius_texels_;
    gpu::Pipeline pipeline_;
    gpu::Sampler nearest_;
    gpu::Image between_;  // blurred along one axis
};

}  // namespace gnomon
