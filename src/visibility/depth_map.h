#pragma once

#include "gpu/commands.h"
#include "raster/gpu_scene.h"
#include "visibility/caster_volume.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gnomon {

/// One layer of a map: what it shows, and which casters are worth drawing into it.
struct MapLayer {
    LightFit fit;
    CasterVolume casters;
    float caster_error_texels = 0.0f;  ///< how far simplified casters may be off; 0: none are
    bool needed = true;                ///< nothing is looked up in a layer that is not
};

/// A depth map of one or more square layers: D32, reversed, so that 1 is nearest to the light and 0
/// is nothing.
class DepthMap {
public:
    explicit DepthMap(const gpu::Device& device);

    /// Draws the casters of each layer, both sides, alpha masks honoured unless `ignore_alpha`. The
    /// layers have one size. The map is ready to be sampled afterwards, as an array. With `reuse`
    /// nothing is drawn, and false returned, when that would draw what is there.
    bool record(gpu::Commands& commands, const raster::GpuScene& scene,
                std::span<const MapLayer> layers, bool ignore_alpha, bool reuse = false);

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
        bool operator==(const CasterDraw&) const = default;
    };
    /// All that decides what is in the map.
    struct Contents {
        std::vector<bool> needed;                    ///< by layer
        std::vector<std::vector<CasterDraw>> draws;  ///< by layer
        std::vector<Mat4> clip_from_local;           ///< of the casters of all layers
        bool ignore_alpha = false;
        bool operator==(const Contents&) const = default;
    };

    /// False when there is one already.
    bool make_image(unsigned size_texels, unsigned layers);
    bool holds(const raster::GpuScene& scene) const;
    std::vector<CasterDraw> place_casters(const raster::GpuScene& scene, const MapLayer& layer);
    void add_part(std::vector<CasterDraw>& draws, const raster::Draw& draw,
                  const raster::CasterPart& part, const raster::CasterLevel& level,
                  const Mat4& clip_from_local);
    /// `most`: how many there can be in any frame of this scene.
    void upload_matrices(gpu::Commands& commands, std::size_t most);
    void draw(gpu::Commands& commands, const raster::GpuScene& scene,
              std::span<const CasterDraw> draws, bool clamps_near, bool ignore_alpha) const;

    const gpu::Device& device_;
    struct Pipelines {
        gpu::Pipeline opaque, masked;
    };
    std::array<Pipelines, 2> pipelines_;  // clipping at the near plane, and clamping to it
    gpu::Image image_;
    std::vector<Mat4> clip_from_local_;  // of the casters of all layers
    Contents drawn_;
    std::weak_ptr<const SceneData> drawn_scene_;
    gpu::Buffer instance_matrices_;
    std::uint64_t triangles_ = 0;
};

}  // namespace gnomon
