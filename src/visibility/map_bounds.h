#pragma once

#include "gpu/commands.h"
#include "visibility/map_lookup.h"

#include <span>

namespace gnomon {

/// Whether filters are skipped where a map's bounds prove a receiver lit or dark.
enum class SkipUniform { automatic, never, always };

/// Two planes of one slope for each tile of a depth map, between which are all its depths and those
/// of some tiles around it: for filters of several widths of one, of two and of five tiles.
class MapBounds {
public:
    MapBounds(const gpu::Device& device, const ReadingOptions& reading);

    /// Whether what they save receivers of a picture of `size` is worth making them.
    bool pay(SkipUniform skip, Extent size, const gpu::Image& depths,
             std::span<const LightFit> fits) const;

    /// The map is drawn anew.
    void outdate() { outdated_ = true; }

    /// Of a map that is ready to be sampled, as the bounds are afterwards. Does nothing when they
    /// are not outdated.
    void record(gpu::Commands& commands, const gpu::Image& depths);

    /// MapFrame::bounded_texels.
    Vec3 reach_texels() const;

    const gpu::Image& image() const { return image_; }
    std::uint64_t memory_bytes() const { return image_.memory_bytes() + tiles_.memory_bytes(); }

private:
    void make_pipelines();
    void make_images(const gpu::Image& depths);

    const gpu::Device& device_;
    ReadingOptions reading_;
    unsigned widths_;  // one, or up to three for filters of varying reach
    bool outdated_ = true;
    gpu::Pipeline fill_, widen_;
    gpu::Sampler nearest_;
    gpu::Image tiles_,
        image_;  // `tiles_`: none around them; `image_`: the map's layers, for each width
};

}  // namespace gnomon
