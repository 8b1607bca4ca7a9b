// Blurred projection: what the light sees of a receiver is a picture, which is blurred and
// projected onto it, of up to four receivers in its channels. S. Kozlov, "Perspective Shadow Maps:
// Care and Feeding", GPU Gems, 2004, section "Blurring"; projected shadows as in M. Segal et al.,
// "Fast Shadows and Lighting Effects Using Texture Mapping", SIGGRAPH 1992. Departures: receivers
// are chosen by themselves, the largest in the picture; the picture also tells where a receiver is,
// so that no shadow falls on it from what is beside or behind it, and both are averaged at its
// rims; other receivers are told by ids and depths instead of depths with a bias.

#include "blurred_projection.comp.spv.h"
#include "blurred_projection.shared.h"
#include "coverage.h"
#include "owner_choice.h"
#include "technique/param_table.h"
#include "technique/technique_base.h"
#include "visibility/light_shape.h"
#include "visibility/lookup_pipeline.h"
#include "visibility/object_map.h"
#include "visibility/seen.h"

namespace gnomon {

const TechniqueInfo& blurred_projection_info();

namespace {

constexpr unsigned kGroupSize = 8;

/// How far from a receiver the texels end that are read for it, without the blur.
constexpr float kBilinear = 1.0f;

/// Around what receivers need, for rounding.
constexpr float kRoundingTexels = 0.5f;

struct Options {
    int map_size = 2048;
    double blur = 4.0;
    int groups = static_cast<int>(blurred_projection::shared::kMaxChannels);

    float radius_texels() const { return kBilinear + static_cast<float>(blur); }
};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table(
        "blurred_projection",
        {integer("map_size", &Options::map_size, 16, 16384, "texels", "side of the map"),
         number("blur", &Options::blur, 0.0, 32.0, "texels", "radius of the blur"),
         integer("groups", &Options::groups, 1, blurred_projection::shared::kMaxChannels, "1",
                 "of the largest objects in the picture, shadows on so many are blurred; on "
                 "others they are not")});
    return table;
}

class BlurredProjection final : public GpuTechnique {
public:
    BlurredProjection(Context& context, const Options& options)
        : GpuTechnique(context, blurred_projection_info()),
          options_(options),
          map_(context.impl().device()),
          choice_(context.impl().device(), static_cast<unsigned>(options.groups)),
          coverage_(context.impl().device(), static_cast<unsigned>(options.groups),
                    static_cast<float>(options.blur)),
          nearest_(context.impl().device(), {}),
          linear_(context.impl().device(), {.filter = VK_FILTER_LINEAR}) {
        using enum gpu::BindingType;
        lookup_ = LookupPipeline(
            context.impl().device(),
            {.code = shaders::blurred_projection_comp,
             .layout = {{texture, storage_image, storage_image, storage_image, texture,
                         storage_image, texture, storage_buffer, uniform_buffer},
                        sizeof(shared::ReceiverPush)},
             .constants = {}});
    }

private:
    void prepare_scene(const Scene& scene, Progress& progress) override {
        GpuTechnique::prepare_scene(scene, progress);
        choice_.prepare(scene.instances().size());
    }

    void record(gpu::Commands& commands, const RecordInput& input,
                gpu::Image& visibility) override {
        const Frame& frame = input.frame;
        fit_ = fit_to_seen(frame, seen_part(frame.camera, frame.size, input.scene.part_bounds_ws()),
                           static_cast<unsigned>(options_.map_size),
                           options_.radius_texels() + kRoundingTexels);
        {
            const gpu::Pass pass(commands, "choice");
            choice_.record(commands, input.receivers);
        }
        {
            const gpu::Pass pass(commands, "ids");
            map_.record(commands, input.scene, fit_, input.receivers.camera, frame.ignore_alpha);
        }
        {
            const gpu::Pass pass(commands, "coverage");
            coverage_.record(commands, input.scene, fit_, map_, choice_.owners(),
                             frame.ignore_alpha);
        }
        const gpu::Pass pass(commands, "lookup");
        look_up(commands, input, visibility);
    }

    void look_up(gpu::Commands& commands, const RecordInput& input, gpu::Image& visibility) {
        commands.use(visibility, gpu::Use::storage_write);
        const gpu::Pipeline& lookup = lookup_.of(input.frame.light);
        commands.bind(
            lookup,
            {gpu::Texture{input.receivers.depth.view(), &nearest_},
             gpu::StorageImage{input.receivers.normals.view()},
             gpu::StorageImage{visibility.view()}, gpu::StorageImage{input.receivers.ids.view()},
             gpu::Texture{map_.depths().view(), &nearest_}, gpu::StorageImage{map_.ids().view()},
             gpu::Texture{coverage_.image().view(), &linear_},
             gpu::StorageBuffer{&choice_.owners()}, gpu::UniformBuffer{&map_.frame()}});
        commands.push(lookup, receiver_push(input.receivers, input.frame.light));
        commands.dispatch(input.frame.size, kGroupSize);
    }

    void describe_texels(const Frame& frame, Visibility::Impl& out) override {
        out.set_texels([fit = fit_](Vec3 p_ws) { return fit.texel_size_m(p_ws); },
                       options_.radius_texels(), frame);
    }

    std::uint64_t memory_bytes() const override {
        return map_.memory_bytes() + choice_.memory_bytes() + coverage_.memory_bytes();
    }

    Options options_;
    ObjectMap map_;
    blurred_projection::OwnerChoice choice_;
    blurred_projection::Coverage coverage_;
    LightFit fit_;
    LookupPipeline lookup_;
    gpu::Sampler nearest_, linear_;
};

}  // namespace

const TechniqueInfo& blurred_projection_info() {
    static const TechniqueInfo info{
        .name = "blurred_projection",
        .title = "Blurred projection",
        .source = "kozlov2004, segal1992",
        .lights = LightKinds::directional | LightKinds::spot,
        .penumbra = Penumbra::fixed_width,
        .self_shadows = false,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<BlurredProjection>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
