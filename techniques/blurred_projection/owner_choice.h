#pragma once

#include "gpu/commands.h"
#include "raster/receivers.h"

namespace gnomon::blurred_projection {

/// Gives the channels to the instances that most pixels of a picture show; without a pixel, to
/// none. All on the device, so that nothing waits for it.
class OwnerChoice {
public:
    /// `channels`: of kMaxChannels, how many are given away.
    OwnerChoice(const gpu::Device& device, unsigned channels);

    /// To be called once per scene.
    void prepare(std::size_t instances);
    void record(gpu::Commands& commands, const raster::Receivers& receivers);

    const gpu::Buffer& owners() const { return owners_; }  ///< shared::Owners
    std::uint64_t memory_bytes() const { return counts_.memory_bytes() + owners_.memory_bytes(); }

private:
    const gpu::Device& device_;
    unsigned channels_;
    unsigned instances_ = 0;
    gpu::Pipeline count_, choose_;
    gpu::Buffer counts_;  // by instance; zero between frames
    gpu::Buffer owners_;
};

}  // namespace gnomon::blurred_projection
