#pragma once

#include "gpu/commands.h"
#include "raster/receivers.h"
#include "visibility/seen.h"

#include <cstdint>
#include <vector>

namespace gnomon {

/// Pixels of a block of kSurveyBlock_px that have receivers.
struct SeenBlock {
    std::uint32_t place;                  ///< x in the lower 16 bits, y in the upper
    float nearest_depth, farthest_depth;  ///< of the picture, reversed
};

/// Finds where a picture's receivers are, from its depths: A. Lauritzen, M. Salvi, A. Lefohn,
/// "Sample Distribution Shadow Maps", I3D 2011. Departures: bounds are kept tile by tile, and in
/// each depth by depth, as T. Harada, "A 2.5D Culling for Forward+", SIGGRAPH Asia 2012 technical
/// briefs, does; they are read by the host, which plans maps and culls casters by them.
class ReceiverSurvey {
public:
    explicit ReceiverSurvey(const gpu::Device& device);

    /// The receivers are in use to be read, and stay so.
    void record(gpu::Commands& commands, const raster::Receivers& receivers);
    /// When the device has finished.
    Seen seen();
    /// After seen(): the blocks that have receivers.
    const std::vector<SeenBlock>& blocks() const { return with_receivers_; }

    std::uint64_t memory_bytes() const { return blocks_.memory_bytes(); }

private:
    const gpu::Device& device_;
    gpu::Pipeline pipeline_;
    gpu::Sampler nearest_;
    gpu::Buffer blocks_;
    std::vector<SeenBlock> with_receivers_;
    Camera camera_;
    Extent size_;
};

}  // namespace gnomon
