// Object-id maps: the light's map tells whose surface it sees, and what sees only itself there is
// lit. S. Dietrich, "Robust Object ID Shadows", ShaderX2, 2003, of which his journal tells; J.-C.
// Hourcade, A. Nicolas, "Algorithms for Antialiased Cast Shadows", Computers & Graphics 9(3), 1985,
// were first. Departure: with depths, ids only end self-shadowing, so that no bias is needed.

#include "object_id.comp.spv.h"
#include "object_id.shared.h"
#include "technique/param_table.h"
#include "technique/technique_base.h"
#include "visibility/light_shape.h"
#include "visibility/lookup_pipeline.h"
#include "visibility/object_map.h"
#include "visibility/seen.h"

namespace gnomon {

const TechniqueInfo& object_id_info();

namespace {

constexpr unsigned kGroupSize = 8;

/// Texels around what receivers need: what is read, and a half for rounding.
constexpr float kMarginTexels = 1.5f;

enum class Compare { ids, ids_and_depths };

struct Options {
    int map_size = 2048;
    Compare compare = Compare::ids_and_depths;
};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table(
        "object_id",
        {integer("map_size", &Options::map_size, 16, 16384, "texels", "side of the map"),
         choice("compare", &Options::compare, {"ids", "ids_and_depths"},
                "lit is what the light sees of the receiver's own object; or also what is not "
                "behind another")});
    return table;
}

class ObjectId final : public GpuTechnique {
public:
    ObjectId(Context& context, const Options& options)
        : GpuTechnique(context, object_id_info()),
          options_(options),
          map_(context.impl().device()),
          nearest_(context.impl().device(), {}) {
        using enum gpu::BindingType;
        lookup_ = LookupPipeline(context.impl().device(),
                                 {.code = shaders::object_id_comp,
                                  .layout = {{texture, storage_image, storage_image, storage_image,
                                              texture, storage_image, uniform_buffer},
                                             sizeof(shared::ReceiverPush)},
                                  .constants = {static_cast<std::uint32_t>(options.compare)}});
    }

private:
    void record(gpu::Commands& commands, const RecordInput& input,
                gpu::Image& visibility) override {
        const Frame& frame = input.frame;
        fit_ = fit_to_seen(frame, seen_part(frame.camera, frame.size, input.scene.part_bounds_ws()),
                           static_cast<unsigned>(options_.map_size), kMarginTexels);
        {
            const gpu::Pass pass(commands, "ids");
            map_.record(commands, input.scene, fit_, input.receivers.camera, frame.ignore_alpha);
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
             gpu::UniformBuffer{&map_.frame()}});
        commands.push(lookup, receiver_push(input.receivers, input.frame.light));
        commands.dispatch(input.frame.size, kGroupSize);
    }

    void describe_texels(const Frame& frame, Visibility::Impl& out) override {
        constexpr float kBilinear = 1.0f;
        out.set_texels([fit = fit_](Vec3 p_ws) { return fit.texel_size_m(p_ws); }, kBilinear,
                       frame);
    }

    std::uint64_t memory_bytes() const override { return map_.memory_bytes(); }

    Options options_;
    ObjectMap map_;
    LightFit fit_;
    LookupPipeline lookup_;
    gpu::Sampler nearest_;
};

}  // namespace

const TechniqueInfo& object_id_info() {
    static const TechniqueInfo info{
        .name = "object_id",
        .title = "Object-id shadow map",
        .source = "hourcade1985, dietrich2003",
        .lights = LightKinds::directional | LightKinds::spot,
        .penumbra = Penumbra::fixed_width,
        .self_shadows = false,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<ObjectId>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
