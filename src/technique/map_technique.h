#pragma once

#include "technique/param_table.h"
#include "technique/technique_base.h"
#include "visibility/depth_map.h"
#include "visibility/light_view.h"
#include "visibility/map_bounds.h"
#include "visibility/map_lookup.h"
#include "visibility/receiver_survey.h"
#include "visibility/seen.h"

#include <algorithm>
#include <concepts>
#include <iterator>
#include <memory>
#include <optional>
#include <vector>

namespace gnomon {

/// What receivers are taken to be, in the order of the table: all parts of the scene that the
/// camera can see, or what its picture shows.
enum class FitTo { parts, picture };

/// What all techniques with depth maps leave open to their users.
struct MapOptions : BiasOptions, ReadingOptions {
    int map_size = 2048;
    FitTo fit_to = FitTo::parts;
    bool cull_casters = true;
    double caster_error = 0.25;
    bool reuse_maps = false;
    CasterFaces faces = CasterFaces::lit;
    bool multi_draw = true;
    bool layered = false;
    bool positions_only = true;
    bool optimised_indices = true;
    SkipUniform skip_uniform = SkipUniform::automatic;

    /// Texels around what receivers need: what the filter reads, how far the bias moves receivers
    /// across the map, and a half for rounding.
    float margin_texels() const {
        return filter_radius_texels(*this) +
               static_cast<float>(normal_offset) * biased_reach_texels(*this, receiver_plane) +
               0.5f;
    }
    /// Levels are of clusters, so that meshes that are drawn whole are never simplified.
    double simplified_texels() const { return optimised_indices ? caster_error : 0.0; }
    unsigned size_texels() const { return static_cast<unsigned>(map_size); }
};

/// Those of MapOptions' rows that say what is drawn, and how.
template <std::derived_from<MapOptions> Options>
std::vector<typename ParamTable<Options>::Row> caster_rows() {
    return {
        boolean<Options>("cull_casters", &Options::cull_casters,
                         "casters whose shadow no receiver can meet are not drawn"),
        choice<Options, CasterFaces>(
            "faces", &Options::faces, {"all", "lit", "unlit"},
            "of casters that close and have no holes, as a light at infinity sees them, which "
            "faces are drawn: those towards it hide the others, and those away from it need no "
            "bias, but leak where something stands on them"),
        number<Options>("caster_error", &Options::caster_error, 0.0, 4.0, "texels",
                        "casters are simplified by no more than this; receivers are moved as much "
                        "farther towards the light"),
        boolean<Options>(
            "reuse_maps", &Options::reuse_maps,
            "what is in a map stays while its light, casters and texels do: nothing is drawn of "
            "maps that rest, only what comes into maps that move by whole texels, and only the "
            "instances that move; casters are then culled by the map's sides alone"),
        boolean<Options>("multi_draw", &Options::multi_draw,
                         "casters that are drawn alike are drawn by one command"),
        boolean<Options>("layered", &Options::layered,
                         "all layers of a map are drawn in one pass, where the device can; it pays "
                         "where passes cost more than what is in them"),
        boolean<Options>("positions_only", &Options::positions_only,
                         "casters are drawn from positions alone; otherwise from whole vertices, "
                         "as a mesh stores them"),
        boolean<Options>("optimised_indices", &Options::optimised_indices,
                         "casters' triangles in an order that reuses vertices, in clusters of "
                         "which only those that are needed are drawn; otherwise in the order of "
                         "the file, each mesh whole and, whatever caster_error says, never "
                         "simplified"),
        choice<Options, SkipUniform>(
            "skip_uniform", &Options::skip_uniform, {"automatic", "never", "always"},
            "where bounds of the map's tiles prove a receiver lit or dark, its filter is skipped, "
            "which changes no pixel; automatic: where that saves more than the bounds take")};
}

/// The rows of MapOptions, for the table of a technique whose options are derived from it.
template <std::derived_from<MapOptions> Options>
std::vector<typename ParamTable<Options>::Row> map_rows() {
    std::vector<typename ParamTable<Options>::Row> rows{
        integer<Options>("map_size", &Options::map_size, 16, 16384, "texels", "side of a map"),
        choice<Options, FitTo>("fit_to", &Options::fit_to, {"parts", "picture"},
                               "what maps must cover: all parts of the scene that the camera can "
                               "see, or what its depths show of them, which the host waits for"),
        choice<Options, MapContent>(
            "content", &Options::content,
            {"depth", "distance", "packed", "packed_two", "object_id", "exponential", "variance",
             "exponential_variance", "moments"},
            "what a texel holds: what the light saw, as a depth or as a distance in a float, four "
            "bytes or two; whose depth it is, so that no object shadows itself; or what is "
            "blurred, and bounds how much of it hides a receiver"),
        choice<Options, MapFilter>(
            "filter", &Options::filter,
            {"nearest", "hardware_2x2", "box_3x3", "box_4x4", "dithered_4", "taps_16", "disc",
             "footprint", "pcss"},
            "how texels are compared, where they are not blurred; pcss makes "
            "the penumbra physical"),
        integer<Options>("filter_taps", &Options::filter_taps, 1, 64, "1",
                         "of disc, footprint and pcss, which searches with as many again"),
        number<Options>("filter_radius", &Options::filter_radius, 0.0, 64.0, "texels", "of disc"),
        number<Options>("filter_most", &Options::filter_most, 1.0, 256.0, "texels",
                        "footprint and pcss reach no farther than this"),
        number<Options>("blur", &Options::blur, 0.0, 32.0, "texels",
                        "radius of the blur, of contents that are blurred"),
        number<Options>("exponent", &Options::exponent, 1.0, 42.0, "1",
                        "of exponential contents: the greater, the nearer to its caster a shadow "
                        "can be told from light"),
        number<Options>("light_bleeding", &Options::light_bleeding, 0.0, 0.9, "1",
                        "of contents that are blurred: shadows that are lighter than this are "
                        "light, which darkens what shines through them"),
        number<Options>("bias_constant", &Options::bias_constant, 0.0, 100.0, "texels",
                        "receivers are moved towards the light by this"),
        number<Options>("bias_slope", &Options::bias_slope, 0.0, 16.0, "1",
                        "and by this times the depth that their plane gains over the filter's "
                        "reach"),
        number<Options>("normal_offset", &Options::normal_offset, 0.0, 16.0, "1",
                        "and off their surface by this times what frees a plane from the filter's "
                        "reach"),
        boolean<Options>("receiver_plane", &Options::receiver_plane,
                         "texels are compared with the receiver's plane at their centres; the "
                         "offset and the slope then make up for a third of the filter's reach")};
    std::ranges::copy(caster_rows<Options>(), std::back_inserter(rows));
    return rows;
}

/// One layer of a technique's map: where its texels are, which receivers look it up, and what can
/// cast on them.
struct PlannedLayer {
    LookupLayer lookup;
    CasterVolume casters;
    bool needed = true;  ///< false: no receiver looks there
    /// A plane (unit normal, offset) behind which casters are not drawn, though they cast.
    std::optional<glm::dvec4> lost_behind_ws = {};
};

struct MapPlan {
    LayerChoice choice = LayerChoice::by_distance;
    std::vector<PlannedLayer> layers;  ///< by distance: in its order
    double blend = 0.0;                ///< LookupLayers::blend; layers begin so much earlier
};

/// A technique with a depth map: says where its texels go. Everything else is alike for all.
class MapTechnique : public GpuTechnique {
public:
    /// MapLookup::show_proven(), for those who count.
    void show_proven() { lookup_.show_proven(); }
    /// The map of the last frame, for them as well.
    const DepthMap& map() const { return maps_->map; }

protected:
    MapTechnique(Context& context, const TechniqueInfo& info, const MapOptions& options);

    /// The layers of the frame's map.
    virtual MapPlan plan(const Frame& frame, const Seen& seen) const = 0;

    /// A layer of the map of a light at infinity, for the receivers within a range of distances.
    PlannedLayer directional_layer(const Frame& frame, const Seen& seen, const LightFit& fit,
                                   DepthRange range) const;

    /// A layer of the map of a light within the world. Tight: fitted to the receivers in its view.
    PlannedLayer local_layer(const Frame& frame, const Seen& seen, const LightView& view,
                             bool tight) const;

    void record(gpu::Commands& commands, const RecordInput& input, gpu::Image& visibility) override;

private:
    /// What frames leave for later ones.
    struct Maps {
        Maps(const gpu::Device& device, const MapOptions& options);
        DepthMap map;
        std::unique_ptr<ContentMap> contents;  // where they are not the depths
        MapBounds bounds;                      // where filters are skipped by them
        std::uint64_t memory_bytes() const;
    };

    bool survey(gpu::Commands& commands, const RecordInput& input) final;
    void forget() final { maps_ = std::make_unique<Maps>(context().device(), options_); }
    void describe_texels(const Frame& frame, Visibility::Impl& out) final;
    std::uint64_t memory_bytes() const final {
        return maps_->memory_bytes() + (survey_ ? survey_->memory_bytes() : 0) +
               lookup_.memory_bytes();
    }

    MapOptions options_;
    std::unique_ptr<ReceiverSurvey> survey_;  // where maps are fitted to the picture
    std::unique_ptr<Maps> maps_;
    MapLookup lookup_;
    LookupLayers layers_;  // of the last frame
};

}  // namespace gnomon
