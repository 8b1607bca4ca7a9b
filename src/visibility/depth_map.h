#pragma once

#include "gpu/commands.h"
#include "visibility/caster_draws.h"
#include "visibility/moving_casters.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace gnomon {

/// A depth map of one or more square layers: D32, reversed, so that 1 is nearest to the light and 0
/// is nothing.
class DepthMap {
public:
    explicit DepthMap(const gpu::Device& device);

    /// Draws the casters of each layer, both sides unless the layer culls some, alpha masks
    /// honoured unless they are ignored. The layers have one size. The map is ready to be sampled
    /// afterwards, as an array. To reuse what is there, the casters of a layer must be all that its
    /// fit sees; a layer that is not needed keeps what it holds. Casters that have moved or
    /// changed are then apart: a second map keeps the others, and where those go or go from, it is
    /// copied and they are drawn over it. False when nothing was drawn because all of it is there.
    bool record(gpu::Commands& commands, const raster::GpuScene& scene,
                std::span<const MapLayer> layers, const CasterOptions& options);

    const gpu::Image& image() const { return image_; }
    /// Where ids were asked for: whose depths these are, index into Scene::instances(); R32UI. Else
    /// a texel that stands in for them.
    const gpu::Image& ids() const { return ids_; }
    /// Of a layer that was planned as `planned`: one that is not needed may hold what an earlier
    /// frame drew into it.
    LightFit drawn_fit(std::size_t layer, LightFit planned) const {
        if (held_[layer]) planned.clip_from_world = held_[layer]->fit.clip_from_world;
        return planned;
    }
    std::uint64_t memory_bytes() const {
        return image_.memory_bytes() + still_.memory_bytes() + scratch_.memory_bytes() +
               ids_.memory_bytes() + instances_.memory_bytes() + commands_.memory_bytes() +
               vertices_.memory_bytes();
    }
    /// Drawn by the last record(), over all layers: triangles, and the texels that they could
    /// reach.
    std::uint64_t triangles() const { return casters_.triangles(); }
    std::uint64_t texels() const { return texels_; }
    /// Whether it drew any casters that stay, or cleared texels for them.
    bool drew_still() const { return !passes_.empty(); }

private:
    /// What is drawn at once: a layer, a strip of it, or all layers.
    struct Pass {
        int layer = -1;  ///< all
        bool clamps_near = true;
        TexelRect texels;
        std::vector<CasterDraw> draws;
        bool is_cleared = false;  ///< before drawing begins
    };
    /// Texels of a layer that are copied, and what moves and is drawn over them.
    struct Patch {
        unsigned layer = 0;
        bool clamps_near = true;
        std::vector<TexelRect> texels;  ///< apart
        std::vector<CasterDraw> draws;
    };
    /// All that decides what is in a layer, beside what decides it for all layers.
    struct Held {
        LightFit fit;
        float caster_error_texels = 0.0f;
        CasterFaces faces = CasterFaces::all;
        std::vector<CasterPlace> moving;  ///< where the casters are drawn that move
    };
    /// What is in a layer and moves.
    struct Move {
        unsigned layer = 0;
        MapScroll by;
    };
    /// Pipelines for one way to draw.
    struct Pipelines {
        gpu::Pipeline opaque, masked;
    };

    void make_image(unsigned size_texels, unsigned layers, bool reuse);
    void make_ids(bool wanted);
    void make_still_image();
    void make_buffers(std::size_t most_draws);
    void make_vertices(gpu::Commands& commands, const Scene& scene, const CasterOptions& options);
    void keep_what_holds(const raster::GpuScene& scene, const CasterOptions& options);
    void plan(const raster::GpuScene& scene, std::span<const MapLayer> layers,
              const CasterOptions& options);
    std::optional<MapScroll> what_stays(const MapLayer& layer, unsigned index) const;
    void place_casters(const raster::GpuScene& scene, const MapLayer& layer, unsigned index,
                       const CasterOptions& options, const TexelRect& texels);
    void place_moving(const raster::GpuScene& scene, const MapLayer& layer, unsigned index,
                      const CasterOptions& options, bool whole);
    void join_passes();
    void move(gpu::Commands& commands);
    void upload(gpu::Commands& commands);
    void clear_sparse(gpu::Commands& commands);
    void draw_passes(gpu::Commands& commands, const raster::GpuScene& scene,
                     const CasterOptions& options);
    void draw_patches(gpu::Commands& commands, const raster::GpuScene& scene,
                      const CasterOptions& options);
    void draw(gpu::Commands& commands, const raster::GpuScene& scene, const Pipelines& with,
              std::span<const CasterDraw> draws, std::uint64_t first_command,
              const CasterOptions& options);
    void bind_triangles(gpu::Commands& commands, const raster::GpuScene& scene,
                        const CasterOptions& options) const;
    Pipelines& pipelines(bool clamps_near, bool layered, const CasterOptions& options);
    /// What passes are drawn into.
    gpu::Image& kept() { return moving_.empty() ? image_ : still_; }

    const gpu::Device& device_;
    // By whether the near plane clamps, layered, from positions alone, with ids.
    std::optional<Pipelines> pipelines_[2][2][2][2];
    gpu::Image image_;
    gpu::Image ids_;
    gpu::Image still_;    // without the casters that move; only where some do
    gpu::Image scratch_;  // for what moves within a layer; only where maps are reused
    CasterDraws casters_;
    MovingCasters moving_;
    std::vector<Pass> passes_;
    std::vector<Patch> patches_;
    std::vector<Move> moves_;
    std::uint64_t texels_ = 0;
    std::vector<std::optional<Held>> held_;  // by layer
    bool held_ignores_alpha_ = false;
    gpu::Buffer instances_;
    gpu::Buffer commands_;  // of all passes, one after the other
    gpu::Buffer vertices_;  // whole; only where casters are drawn from them
    SceneKey vertices_of_;
};

}  // namespace gnomon
