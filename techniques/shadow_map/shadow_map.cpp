// Shadow map: one depth map fitted to what the camera sees, for the sun and for spots.
// L. Williams, "Casting Curved Shadows on Curved Surfaces", SIGGRAPH 1978; W. Reeves et al.,
// "Rendering Antialiased Shadows with Depth Maps", SIGGRAPH 1987; M. Bunnell and F. Pellacini,
// "Shadow Map Antialiasing", GPU Gems 2004, chapter 11, for the filters. Departures: the biases are
// in units of the map's texels at the receiver, in the world, and the normal offset (D. Holbert,
// "Saying Goodbye to Shadow Acne", GDC 2011) grows with the sine of the light's angle and the
// filter's reach, which is just what a plane needs.

#include "shadow_map.comp.spv.h"
#include "shadow_map.shared.h"
#include "technique/param_table.h"
#include "technique/technique_base.h"
#include "visibility/depth_map.h"
#include "visibility/light_fit.h"
#include "visibility/light_shape.h"
#include "visibility/lookup_pipeline.h"

#include <cmath>

namespace gnomon {

const TechniqueInfo& shadow_map_info();

namespace {

constexpr unsigned kGroupSize = 8;

enum class Filter { nearest, hardware_2x2, box_4x4 };

struct Options {
    int map_size = 2048;
    Filter filter = Filter::box_4x4;
    // A plane is free of acne when bias_slope + normal_offset is 1. Two thirds of it as an offset
    // spare thin casters, one third along the light spares corners.
    double bias_constant = 0.1;
    double bias_slope = 0.33;
    double normal_offset = 0.67;
};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table(
        "shadow_map",
        {integer("map_size", &Options::map_size, 16, 16384, "texels", "side of the map"),
         choice("filter", &Options::filter, {"nearest", "hardware_2x2", "box_4x4"},
                "how the map is read"),
         number("bias_constant", &Options::bias_constant, 0.0, 100.0, "texels",
                "receivers are moved towards the light by this"),
         number("bias_slope", &Options::bias_slope, 0.0, 16.0, "1",
                "and by this times the depth that their plane gains over the filter's reach"),
         number("normal_offset", &Options::normal_offset, 0.0, 16.0, "1",
                "and off their surface by this times what frees a plane from the filter's reach")});
    return table;
}

/// How far from the receiver the filter's outermost texels end, in texels along an axis.
float filter_radius_texels(Filter filter) {
    constexpr float kRadii[] = {0.5f, 1.0f, 2.0f};
    return kRadii[static_cast<std::size_t>(filter)];
}

/// How far from the receiver a texel's centre may lie and still decide between light and shadow. A
/// filter of several texels passes over the outer quarter of its reach, which has little weight.
float deciding_reach_texels(Filter filter) {
    constexpr float kDecidingShare = 0.75f;
    const float reach_texels = std::sqrt(2.0f) * filter_radius_texels(filter);
    return filter == Filter::nearest ? reach_texels : kDecidingShare * reach_texels;
}

class ShadowMap final : public GpuTechnique {
public:
    ShadowMap(Context& context, const Options& options)
        : GpuTechnique(context, shadow_map_info()),
          options_(options),
          map_(context.impl().device()) {
        const gpu::Device& device = context.impl().device();
        using enum gpu::BindingType;
        gpu::ComputePipelineInfo lookup;
        lookup.code = shaders::shadow_map_comp;
        lookup.layout = {{texture, storage_image, storage_image, texture, texture, uniform_buffer},
                         sizeof(shared::ReceiverPush)};
        lookup.constants = {static_cast<std::uint32_t>(options.filter)};
        lookup_ = LookupPipeline(device, lookup);
        nearest_ = gpu::Sampler(device, {});
        compare_ = gpu::Sampler(device, {.filter = VK_FILTER_LINEAR, .compare = true});
        frame_ = gpu::Buffer(device, sizeof(shared::ShadowMapFrame),
                             VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                             gpu::Placement::device);
    }

private:
    LightFit fit(const Frame& frame) const {
        // One texel more than the filter reads, for receivers that the bias moves across the
        // border.
        const float margin_texels = filter_radius_texels(options_.filter) + 1.0f;
        const auto size = static_cast<unsigned>(options_.map_size);
        if (const auto* spot = std::get_if<SpotLight>(&frame.light)) {
            return fit_spot(*spot, frame.scene.bounds(), size, margin_texels);
        }
        return fit_directional(std::get<DirectionalLight>(frame.light), frame.camera, frame.size,
                               frame.scene.bounds(), size, margin_texels);
    }

    shared::ShadowMapFrame frame_constants(const LightFit& fit) const {
        return {.clip_from_world = fit.clip_from_world,
                .eye_ws = fit.eye_ws,
                .texel_m = fit.texel_m,
                .axis_ws = fit.axis_ws,
                .perspective = fit.perspective ? 1.0f : 0.0f,
                .reach_texels = deciding_reach_texels(options_.filter),
                .bias_constant = static_cast<float>(options_.bias_constant),
                .bias_slope = static_cast<float>(options_.bias_slope),
                .normal_offset = static_cast<float>(options_.normal_offset)};
    }

    void record(gpu::Commands& commands, const RecordInput& input,
                gpu::Image& visibility) override {
        const LightFit light_fit = fit(input.frame);
        {
            const gpu::Pass pass(commands, "depth");
            map_.record(commands, input.scene, light_fit.clip_from_world,
                        static_cast<unsigned>(options_.map_size), input.frame.ignore_alpha);
        }
        const gpu::Pass pass(commands, "lookup");
        commands.update(frame_, frame_constants(light_fit));
        commands.use(visibility, gpu::Use::storage_write);
        const gpu::Pipeline& lookup = lookup_.of(input.frame.light);
        commands.bind(
            lookup,
            {gpu::Texture{input.receivers.depth.view(), &nearest_},
             gpu::StorageImage{input.receivers.normals.view()},
             gpu::StorageImage{visibility.view()}, gpu::Texture{map_.image().view(), &compare_},
             gpu::Texture{map_.image().view(), &nearest_}, gpu::UniformBuffer{&frame_}});
        commands.push(lookup, receiver_push(input.receivers, input.frame.light));
        commands.dispatch(input.frame.size, kGroupSize);
    }

    void describe_texels(const Frame& frame, Visibility::Impl& out) override {
        const LightFit light_fit = fit(frame);
        out.set_texels([light_fit](Vec3 p_ws) { return light_fit.texel_size_m(p_ws); },
                       filter_radius_texels(options_.filter), frame);
    }

    std::uint64_t memory_bytes() const override {
        return map_.memory_bytes() + frame_.memory_bytes();
    }

    Options options_;
    DepthMap map_;
    LookupPipeline lookup_;
    gpu::Sampler nearest_, compare_;
    gpu::Buffer frame_;
};

}  // namespace

const TechniqueInfo& shadow_map_info() {
    static const TechniqueInfo info{
        .name = "shadow_map",
        .title = "Shadow map",
        .source = "williams1978, reeves1987, bunnell2004, holbert2011",
        .lights = LightKinds::directional | LightKinds::spot,
        .penumbra = Penumbra::fixed_width,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<ShadowMap>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
