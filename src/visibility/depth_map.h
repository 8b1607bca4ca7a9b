#pragma once

#include "gpu/commands.h"
#include "raster/gpu_scene.h"
#include "visibility/caster_volume.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon {

/// One layer of a map: what it shows, and which casters are worth drawing into it.
struct MapLayer {
    LightFit fit;
    CasterVolume casters;
    float caster_error_texels = 0.0f;  ///< how far simplified casters may be off; 0: none are
};

/// A depth map of one or more square layers: D32, reversed, so that 1 is nearest to the light and 0
/// is nothing.
class DepthMap {
public:
    explicit DepthMap(const gpu::Device& device);

    /// Draws the casters of each layer, both sides, alpha masks honoured unless `ignore_alpha`;
    /// casters nearer than the near plane are clamped to it. The layers have one size. The map is
    /// ready to be sampled afterwards, as an array.
    void record(gpu::Commands& commands, const raster::GpuScene& scene,
                std::span<const MapLayer> layers, bool ignore_alpha);

    const gpu::Image& image() const { return image_; }
    std::uint64_t memory_bytes() const {
        return image_.memory_bytes() + instance_matrices_.memory_bytes();
    }
    /// Of the last record(), over all layers.
    std::uint64_t triangles() const { return triangles_; }

private:
    /// One range of triangles, of instances one after the other in the buffer of matrices.
    struct CasterDraw {
        const raster::Draw* draw;
        std::uint32_t first_index, index_count;
        std::uint32_t first_instance, instance_count;
        std::uint32_t slot;  ///< of the last instance
    };

    void make_image(unsigned size_texels, unsigned layers);
    std::vector<CasterDraw> place_casters(const raster::GpuScene& scene, const MapLayer& layer);
    void add_part(std::vector<CasterDraw>& draws, const raster::Draw& draw,
                  const raster::CasterPart& part, const raster::CasterLevel& level,
                  const Mat4& clip_from_local);
    /// `most`: how many there can be in any frame of this scene.
    void upload_matrices(gpu::Commands& commands, std::size_t most);
    void draw(gpu::Commands& commands, const raster::GpuScene& scene,
              std::span<const CasterDraw> draws, bool ignore_alpha) const;

    const gpu::Device& device_;
    gpu::Pipeline opaque_, masked_;
    gpu::Image image_;
    std::vector<Mat4> clip_from_local_;  // of the casters of all layers
    gpu::Buffer instance_matrices_;
    std::uint64_t triangles_ = 0;
};

}  // namespace gnomon
