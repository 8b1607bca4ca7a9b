// Local illumination: a receiver sees all of a light that is above its horizon; nothing casts
// shadows. What every picture was before A. Appel, "Some Techniques for Shading Machine Renderings
// of Solids", AFIPS 1968, and what other techniques are measured against.

#include "local_illumination.comp.spv.h"
#include "technique/param_table.h"
#include "technique/technique_base.h"
#include "visibility/light_shape.h"
#include "visibility/lookup_pipeline.h"

namespace gnomon {

const TechniqueInfo& local_illumination_info();

namespace {

constexpr unsigned kGroupSize = 8;

struct Options {};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table("local_illumination", {});
    return table;
}

class LocalIllumination final : public GpuTechnique {
public:
    explicit LocalIllumination(Context& context)
        : GpuTechnique(context, local_illumination_info()) {
        const gpu::Device& device = context.impl().device();
        using enum gpu::BindingType;
        lookup_ = LookupPipeline(device, {.code = shaders::local_illumination_comp,
                                          .layout = {{texture, storage_image, storage_image},
                                                     sizeof(shared::ReceiverPush)}});
        nearest_ = gpu::Sampler(device, {});
    }

private:
    void record(gpu::Commands& commands, const RecordInput& input,
                gpu::Image& visibility) override {
        const gpu::Pass pass(commands, "facing");
        commands.use(visibility, gpu::Use::storage_write);
        const gpu::Pipeline& lookup = lookup_.of(input.frame.light);
        commands.bind(lookup, {gpu::Texture{input.receivers.depth.view(), &nearest_},
                               gpu::StorageImage{input.receivers.normals.view()},
                               gpu::StorageImage{visibility.view()}});
        commands.push(lookup, receiver_push(input.receivers, input.frame.light));
        commands.dispatch(input.frame.size, kGroupSize);
    }

    std::uint64_t memory_bytes() const override { return 0; }

    LookupPipeline lookup_;
    gpu::Sampler nearest_;
};

}  // namespace

const TechniqueInfo& local_illumination_info() {
    static const TechniqueInfo info{
        .name = "local_illumination",
        .title = "Local illumination",
        .source = "appel1968",
        .lights = LightKinds::all,
        .penumbra = Penumbra::none,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            param_table().options(params);
            return std::make_unique<LocalIllumination>(context);
        }};
    return info;
}

}  // namespace gnomon
