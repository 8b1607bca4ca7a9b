#pragma once

#include "raster/receivers.h"
#include "visibility/content_map.h"
#include "visibility/light_fit.h"
#include "visibility/lookup_pipeline.h"
#include "visibility/map_lookup.shared.h"
#include "visibility/receiver_survey.h"

#include <cstdint>
#include <map>
#include <vector>

namespace gnomon {

/// How texels are compared, in the order of kFilterNearest, ...: map_filter.glsl.
enum class MapFilter {
    nearest,
    hardware_2x2,
    box_3x3,
    box_4x4,
    dithered_4,
    taps_16,
    disc,
    footprint,
    pcss
};

/// How a map is read: compared through a filter, or, of contents that are blurred, once.
struct ReadingOptions {
    MapContent content = MapContent::depth;
    MapFilter filter = MapFilter::box_4x4;
    int filter_taps = 16;         // of disc, footprint, pcss
    double filter_radius = 2.5;   // texels, of disc
    double filter_most = 24.0;    // texels, of footprint, pcss
    double blur = 2.0;            // texels, of contents that are blurred
    double exponent = 40.0;       // of exponential contents
    double light_bleeding = 0.2;  // shadows lighter than this are light
    double distance_scale = 1.0;
    double distance_offset = 0.0;
};

/// How far from the receiver the filter's outermost texels end, in texels along an axis.
float filter_radius_texels(const ReadingOptions& reading);
/// The same of the narrowest that a filter of varying width can be: what texels explain of an edge.
float least_radius_texels(const ReadingOptions& reading);
/// How far from the receiver a texel's centre may lie and still decide between light and shadow; of
/// filters of any width without what `cone` adds.
float deciding_reach_texels(const ReadingOptions& reading);
/// For how much of that receivers are moved: for all, or, when texels are compared with the
/// receiver's plane, for what surfaces differ from it.
float biased_reach_texels(const ReadingOptions& reading, bool receiver_plane);

/// By how much receivers are moved before they are looked up: MapBias.
struct BiasOptions {
    double bias_constant = 0.3;
    // A plane is free of acne when bias_slope + normal_offset is 1. Two thirds of it as an offset
    // spare thin casters, one third along the light spares corners.
    double bias_slope = 0.33;
    double normal_offset = 0.67;
    bool receiver_plane = true;  ///< compare each texel with the receiver's plane there
};

/// In which layer a receiver is looked up: the last that begins before its distance from the
/// camera, or the one along whose axis it is farthest from the light. In the order of
/// kChooseByDistance, ...
enum class LayerChoice { by_distance, by_axis };

/// A layer of a map as receivers choose it.
struct LookupLayer {
    LightFit fit;
    double from_m = 0.0;      ///< by distance: nearer receivers look in the layer before
    float bias_scale = 1.0f;  ///< of BiasOptions::bias_constant
};

struct LookupLayers {
    LayerChoice choice = LayerChoice::by_distance;
    std::vector<LookupLayer> layers;  ///< between one and kMaxMapLayers, in the order of distance
    /// By distance: of that at which a layer begins, over how much before it pixels mix with it,
    /// some looking in it and some in the one before.
    double blend = 0.0;
};

/// Which layer a point is looked up in.
std::size_t layer_of(const LookupLayers& layers, const Camera& camera, Vec3 p_ws);

class MapBounds;

/// Compares receivers with a map; what lies outside of a spot's map is lit.
class MapLookup {
public:
    MapLookup(const gpu::Device& device, const ReadingOptions& reading, const BiasOptions& bias);

    /// `ids`: of the map's depths, read where the content is object ids. `bounds`: of the map's
    /// tiles, where there are some; filters are skipped by them, which changes no pixel. `survey`:
    /// of the same receivers, where there is one; pixels without receivers are then not looked at.
    void record(gpu::Commands& commands, const raster::Receivers& receivers, const Light& light,
                const LookupLayers& layers, const gpu::Image& map, const gpu::Image& ids,
                const MapBounds* bounds, const ReceiverSurvey* survey, gpu::Image& visibility);

    /// From now on, where there are bounds: 1 and 0 where they prove a receiver lit and dark, a
    /// half where it is filtered.
    void show_proven() { shows_proven_ = true; }

    std::uint64_t memory_bytes() const { return frame_.memory_bytes() + blocks_.memory_bytes(); }

private:
    /// Groups of pixels that are looked up in the same layers.
    struct Part {
        unsigned first_layer = 0;
        std::size_t layer_count = 1;
        unsigned first_block = 0;
        Extent groups;
    };

    LookupPipeline& pipeline(const LookupLayers& layers, std::size_t layer_count,
                             std::uint32_t proof, bool listed);
    std::vector<Part> list(gpu::Commands& commands, const ReceiverSurvey& survey,
                           const shared::MapFrame& frame, LayerChoice choice,
                           std::size_t layer_count);

    const gpu::Device& device_;
    ReadingOptions reading_;
    shared::MapBias bias_;
    std::map<std::vector<std::uint32_t>, LookupPipeline> pipelines_;  // by constants
    gpu::Sampler nearest_;
    gpu::Buffer frame_;
    gpu::Buffer blocks_;  // of pixels that are looked at
    bool shows_proven_ = false;
};

}  // namespace gnomon
