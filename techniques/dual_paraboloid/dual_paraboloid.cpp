// Dual-paraboloid shadow maps: two layers, each a half-space around a point light as a paraboloid
// mirror shows it; one for a spot. S. Brabec, T. Annen, H.-P. Seidel, "Shadow Mapping for
// Hemispherical and Omnidirectional Light Sources", CGI 2002; W. Heidrich, H.-P. Seidel,
// "View-independent Environment Maps", 1998, for the map. Departures: edges, which the map bends,
// are subdivided until they are off by half a texel at most, where the article asks for models that
// are fine enough; depths are the triangles' own at texels' centres instead of interpolated, and
// reciprocal; receivers are compared as planes, so that no bias has to be found.

#include "dual_paraboloid.comp.spv.h"
#include "dual_paraboloid.shared.h"
#include "paraboloid_map.h"
#include "technique/param_table.h"
#include "technique/technique_base.h"
#include "visibility/light_shape.h"
#include "visibility/lookup_pipeline.h"
#include "visibility/map_lookup.h"
#include "visibility/seen.h"

#include <array>

namespace gnomon {

const TechniqueInfo& dual_paraboloid_info();

namespace {

using dual_paraboloid::LayerCasters;
using dual_paraboloid::ParaboloidMap;
using dual_paraboloid::ParaboloidView;
using dual_paraboloid::Side;

constexpr unsigned kGroupSize = 8;

/// Texels around a layer's circle: what filters read, up to 1.5, the bias's move across the map, up
/// to 0.4, and a half for rounding.
constexpr double kMarginTexels = 2.5;

/// In the order of kFilterNearest, ...
enum class Filter { nearest, bilinear_2x2, box_3x3 };

struct Options {
    int map_size = 2048;
    Filter filter = Filter::box_3x3;
    bool subdivide = true;
};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table(
        "dual_paraboloid",
        {integer("map_size", &Options::map_size, 16, 16384, "texels", "side of a layer"),
         choice("filter", &Options::filter, {"nearest", "bilinear_2x2", "box_3x3"},
                "how texels are compared"),
         boolean("subdivide", &Options::subdivide,
                 "edges that the map bends are drawn in pieces that are off by no more than half a "
                 "texel; off: straight, as hardware draws them")});
    return table;
}

/// The same filter of other maps, which are biased for what is true of any map.
ReadingOptions reading(Filter filter) {
    constexpr std::array kSame{MapFilter::nearest, MapFilter::hardware_2x2, MapFilter::box_3x3};
    return {.filter = kSame[static_cast<std::size_t>(filter)]};
}

class DualParaboloid final : public GpuTechnique {
public:
    DualParaboloid(Context& context, const Options& options)
        : GpuTechnique(context, dual_paraboloid_info()),
          options_(options),
          map_(context.impl().device(), options.subdivide),
          nearest_(context.impl().device(), {}),
          frame_(context.impl().device(), sizeof(dual_paraboloid::shared::MapFrame),
                 VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                 gpu::Placement::device) {
        using enum gpu::BindingType;
        lookup_ = LookupPipeline(
            context.impl().device(),
            {.code = shaders::dual_paraboloid_comp,
             .layout = {{texture, storage_image, storage_image, texture, uniform_buffer},
                        sizeof(shared::ReceiverPush)},
             .constants = {static_cast<std::uint32_t>(options.filter)}});
    }

private:
    void record(gpu::Commands& commands, const RecordInput& input,
                gpu::Image& visibility) override {
        const Frame& frame = input.frame;
        view_ = dual_paraboloid::paraboloid_view(frame.light, frame.scene.bounds(),
                                                 static_cast<unsigned>(options_.map_size),
                                                 kMarginTexels);
        {
            const gpu::Pass pass(commands, "depth");
            map_.record(commands, input.scene, view_, layers(input), frame.ignore_alpha);
        }
        const gpu::Pass pass(commands, "lookup");
        look_up(commands, input, visibility);
    }

    /// A layer that no receiver is in is not drawn, nor are casters behind the receivers.
    std::vector<LayerCasters> layers(const RecordInput& input) const {
        const Frame& frame = input.frame;
        const Seen seen = seen_part(frame.camera, frame.size, input.scene.part_bounds_ws());
        LightFit no_sides;
        no_sides.clip_from_world = glm::dmat4(0.0);
        const CasterVolume casters(
            no_sides, visible_planes(frame.camera, frame.size, seen.bounds, seen.range),
            view_.position_ws);
        std::vector<LayerCasters> result;
        for (const Side side : {Side::along, Side::against}) {
            if (view_.layers == 1 && side == Side::against) continue;
            const std::array inside{view_.half_space(side)};
            const bool needed =
                !visible_corners(frame.camera, frame.size, seen.bounds, seen.range, inside).empty();
            result.push_back({side, needed, casters});
        }
        return result;
    }

    dual_paraboloid::shared::MapFrame map_frame() const {
        const ReadingOptions same = reading(options_.filter);
        const BiasOptions bias;
        const float reach_texels = biased_reach_texels(same, bias.receiver_plane);
        return {.right = Vec3(view_.right_ws),
                .up = Vec3(view_.up_ws),
                .forward = Vec3(view_.forward_ws),
                .reach = static_cast<float>(view_.reach),
                .cone = static_cast<float>(view_.cone),
                .layers = static_cast<std::uint32_t>(view_.layers),
                .size_texels = static_cast<float>(view_.size_texels),
                .near_m = static_cast<float>(view_.near_m),
                .bias_constant = static_cast<float>(bias.bias_constant),
                .bias_slope = reach_texels * static_cast<float>(bias.bias_slope),
                .normal_offset = reach_texels * static_cast<float>(bias.normal_offset)};
    }

    void look_up(gpu::Commands& commands, const RecordInput& input, gpu::Image& visibility) {
        commands.update(frame_, map_frame());
        commands.use(visibility, gpu::Use::storage_write);
        const gpu::Pipeline& lookup = lookup_.of(input.frame.light);
        commands.bind(lookup,
                      {gpu::Texture{input.receivers.depth.view(), &nearest_},
                       gpu::StorageImage{input.receivers.normals.view()},
                       gpu::StorageImage{visibility.view()},
                       gpu::Texture{map_.image().view(), &nearest_}, gpu::UniformBuffer{&frame_}});
        commands.push(lookup, receiver_push(input.receivers, input.frame.light));
        commands.dispatch(input.frame.size, kGroupSize);
    }

    void describe_texels(const Frame& frame, Visibility::Impl& out) override {
        out.set_texels([view = view_](Vec3 p_ws) { return view.texel_size_m(p_ws); },
                       filter_radius_texels(reading(options_.filter)), frame);
    }

    std::uint64_t memory_bytes() const override {
        return map_.memory_bytes() + frame_.memory_bytes();
    }

    Options options_;
    ParaboloidMap map_;
    ParaboloidView view_;  // of the last frame
    LookupPipeline lookup_;
    gpu::Sampler nearest_;
    gpu::Buffer frame_;
};

}  // namespace

const TechniqueInfo& dual_paraboloid_info() {
    static const TechniqueInfo info{
        .name = "dual_paraboloid",
        .title = "Dual-paraboloid shadow map",
        .source = "brabec2002, heidrich1998",
        .lights = LightKinds::point | LightKinds::spot,
        .penumbra = Penumbra::fixed_width,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<DualParaboloid>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
