// Shadow map: one depth map fitted to what the camera sees, for the sun and for spots.
// L. Williams, "Casting Curved Shadows on Curved Surfaces", SIGGRAPH 1978; W. Reeves et al.,
// "Rendering Antialiased Shadows with Depth Maps", SIGGRAPH 1987. Contents, filters and biases,
// which all techniques with depth maps share, name their sources in visibility/contents,
// visibility/filters and visibility/map_bias.glsl.

#include "technique/map_technique.h"

namespace gnomon {

const TechniqueInfo& shadow_map_info();

namespace {

using Options = MapOptions;

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table("shadow_map", {}, map_rows<Options>());
    return table;
}

class ShadowMap final : public MapTechnique {
public:
    ShadowMap(Context& context, const Options& options)
        : MapTechnique(context, shadow_map_info(), options), options_(options) {}

private:
    MapPlan plan(const Frame& frame, const Seen& seen) const override {
        if (const auto* spot = std::get_if<SpotLight>(&frame.light)) {
            return {.layers = {local_layer(frame, seen, spot_view(*spot), true)}};
        }
        const LightFit fit =
            fit_to_seen(frame, seen, options_.size_texels(), options_.margin_texels());
        return {.layers = {directional_layer(frame, seen, fit, seen.range)}};
    }

    Options options_;
};

}  // namespace

const TechniqueInfo& shadow_map_info() {
    static const TechniqueInfo info{
        .name = "shadow_map",
        .title = "Shadow map",
        .source =
            "williams1978, wang1994, reeves1987, bunnell2004, gerasimov2004, king2004, "
            "heckbert1989, fernando2005, isidoro2006, donnelly2006, annen2008, "
            "lauritzen2008, holbert2011, peters2015",
        .lights = LightKinds::directional | LightKinds::spot,
        .penumbra = Penumbra::fixed_width,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<ShadowMap>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
