#pragma once

#include "gpu/commands.h"
#include "visibility/light_fit.h"
#include "visibility/map_blur.h"
#include "visibility/map_lookup.shared.h"

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

namespace gnomon {

/// What a map's texels hold, in the order of kContentDepth, ...: what the light saw, or, from
/// `exponential` on, what can be blurred and bounds how much of it is nearer than a receiver.
enum class MapContent {
    depth,       ///< as it was drawn
    distance,    ///< 32-bit float; of lights within the world squared
    packed,      ///< the distance in four bytes
    packed_two,  ///< and in two, a whole part and a fraction
    object_id,   ///< whose surface it is, beside the depth as it was drawn
    exponential,
    variance,
    exponential_variance,
    moments
};

/// Whether a ContentMap makes it from depths.
inline bool is_computed(MapContent content) {
    return content != MapContent::depth && content != MapContent::object_id;
}

inline bool is_blurred(MapContent content) {
    return content >= MapContent::exponential;
}

/// How a layer's depths become distances from its light.
shared::MapSpace map_space(const LightFit& fit);

/// A map's contents, where they are not the depths themselves: a layer for each of its.
class ContentMap {
public:
    /// `exponent` of exponential contents; `blur_texels`: where the blur ends.
    ContentMap(const gpu::Device& device, MapContent content, float exponent, float blur_texels);

    /// From a map of square layers, as many as `fits`, that is ready to be sampled; so are the
    /// contents afterwards.
    void record(gpu::Commands& commands, const gpu::Image& depths, std::span<const LightFit> fits);

    /// Whether the contents, of depths that rest, are in the measure of these fits: distances are
    /// told in parts of how far the scene reaches, which changes when its instances move.
    bool measures_as(std::span<const LightFit> fits) const {
        return std::ranges::equal(reach_m_, fits, {}, {}, &LightFit::far_m);
    }

    const gpu::Image& image() const { return image_; }
    std::uint64_t memory_bytes() const { return image_.memory_bytes() + blur_.memory_bytes(); }

private:
    void make_image(const gpu::Image& depths);

    const gpu::Device& device_;
    MapContent content_;
    float exponent_;
    gpu::Pipeline fill_;
    gpu::Sampler nearest_;
    MapBlur blur_;
    gpu::Image image_;
    std::vector<double> reach_m_;  // LightFit::far_m of each layer
};

}  // namespace gnomon
