#pragma once

#include "gpu/commands.h"
#include "paraboloid.h"
#include "raster/gpu_scene.h"
#include "visibility/caster_volume.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::dual_paraboloid {

/// What is drawn into a layer.
struct LayerCasters {
    Side side = Side::along;
    bool needed = true;      ///< false: nothing is looked up there
    CasterVolume casters{};  ///< worth drawing
};

/// Both hemispheres around a light, a layer each: D32, near_m over the distance, so that floats are
/// as fine at every distance as anywhere; 0 is nothing.
class ParaboloidMap {
public:
    /// Throws Error{machine} when the device has no tessellation.
    ParaboloidMap(const gpu::Device& device, bool subdivide);

    /// Draws both sides of the casters, alpha masks honoured unless `ignore_alpha`. The map is
    /// ready to be sampled afterwards, as an array.
    void record(gpu::Commands& commands, const raster::GpuScene& scene, const ParaboloidView& view,
                std::span<const LayerCasters> layers, bool ignore_alpha);

    const gpu::Image& image() const { return image_; }
    std::uint64_t memory_bytes() const {
        return image_.memory_bytes() + instance_matrices_.memory_bytes();
    }

private:
    /// Triangles of instances one after the other in the scene's slots.
    struct CasterDraw {
        const raster::Draw* draw;
        std::uint32_t first_index, index_count;
        std::uint32_t first_slot, slot_count;
    };

    void make_image(unsigned size_texels, unsigned layers);
    void upload_matrices(gpu::Commands& commands, const raster::GpuScene& scene,
                         const ParaboloidView& view);
    static std::vector<CasterDraw> place_casters(const raster::GpuScene& scene,
                                                 const ParaboloidView& view,
                                                 const LayerCasters& layer);
    void draw(gpu::Commands& commands, const raster::GpuScene& scene, const ParaboloidView& view,
              const LayerCasters& layer, bool ignore_alpha) const;

    const gpu::Device& device_;
    bool subdivide_;
    gpu::Pipeline opaque_, masked_;
    gpu::Image image_;
    gpu::Buffer instance_matrices_;  // to the light's space, by slot
};

}  // namespace gnomon::dual_paraboloid
