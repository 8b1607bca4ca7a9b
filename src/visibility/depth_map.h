#pragma once

#include "gpu/commands.h"
#include "visibility/caster_draws.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace gnomon {

/// How casters are drawn.
struct CasterOptions {
    bool ignore_alpha = false;
    bool reuse = false;      ///< nothing is drawn that would be as what is there
    bool multi_draw = true;  ///< what one state of the pipeline draws, by one command
    bool layered = false;    ///< all layers in one pass, where they and the device allow it
};

/// A depth map of one or more square layers: D32, reversed, so that 1 is nearest to the light and 0
/// is nothing.
class DepthMap {
public:
    explicit DepthMap(const gpu::Device& device);

    /// Draws the casters of each layer, both sides unless the layer culls some, alpha masks
    /// honoured unless they are ignored. The layers have one size. The map is ready to be sampled
    /// afterwards, as an array. False when nothing was drawn because all of it is there.
    bool record(gpu::Commands& commands, const raster::GpuScene& scene,
                std::span<const MapLayer> layers, const CasterOptions& options);

    const gpu::Image& image() const { return image_; }
    std::uint64_t memory_bytes() const {
        return image_.memory_bytes() + instances_.memory_bytes() + commands_.memory_bytes();
    }
    /// Of the last record(), over all layers.
    std::uint64_t triangles() const { return casters_.triangles(); }

private:
    /// What is drawn at once: a layer, or all.
    struct Pass {
        int layer = -1;  ///< all
        bool clamps_near = true;
        std::vector<CasterDraw> draws;
        bool operator==(const Pass&) const = default;
    };
    /// All that decides what is in the map.
    struct Contents {
        std::vector<Pass> passes;
        std::vector<CasterInstance> instances;
        bool ignore_alpha = false;
        bool operator==(const Contents&) const = default;
    };
    /// Pipelines for one way to draw.
    struct Pipelines {
        gpu::Pipeline opaque, masked;
    };

    /// False when there is one already.
    bool make_image(unsigned size_texels, unsigned layers);
    void make_buffers(std::size_t most_draws);
    bool holds(const raster::GpuScene& scene) const;
    std::vector<Pass> place_casters(const raster::GpuScene& scene, std::span<const MapLayer> layers,
                                    bool layered);
    void upload(gpu::Commands& commands);
    void draw(gpu::Commands& commands, const raster::GpuScene& scene, const Pass& pass,
              std::uint64_t first_command, const CasterOptions& options);
    Pipelines& pipelines(const Pass& pass);

    const gpu::Device& device_;
    std::optional<Pipelines> pipelines_[2][2];  // by whether the near plane clamps; layered or not
    gpu::Image image_;
    CasterDraws casters_;
    Contents drawn_;
    std::weak_ptr<const SceneData> drawn_scene_;
    gpu::Buffer instances_;
    gpu::Buffer commands_;  // of all passes, one after the other
};

}  // namespace gnomon
