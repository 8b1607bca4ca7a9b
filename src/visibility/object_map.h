#pragma once

#include "raster/receivers.h"
#include "visibility/light_fit.h"

namespace gnomon {

/// A light's map that tells whose surface it sees: the nearest instance's number beside its depth.
/// For shaders that include object_map.glsl.
class ObjectMap {
public:
    explicit ObjectMap(const gpu::Device& device);

    /// Draws all casters, alpha masks honoured unless `ignore_alpha`, for receivers of `camera`.
    /// Ready to be looked up afterwards.
    void record(gpu::Commands& commands, const raster::GpuScene& scene, const LightFit& fit,
                const Camera& camera, bool ignore_alpha);

    const gpu::Image& depths() const { return map_.depth; }  ///< D32S8, reversed Z
    const gpu::Image& ids() const { return map_.ids; }       ///< RG32UI, as of raster::SeenIds
    const gpu::Buffer& frame() const { return frame_; }      ///< an ObjectMapFrame
    std::uint64_t memory_bytes() const {
        return map_.depth.memory_bytes() + map_.ids.memory_bytes() + frame_.memory_bytes();
    }

private:
    raster::IdPass draw_;
    raster::SeenIds map_;
    gpu::Buffer frame_;
};

}  // namespace gnomon
