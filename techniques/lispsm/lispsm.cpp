// Light-space perspective shadow map: one map whose texels shrink towards the camera. M. Wimmer,
// D. Scherzer, W. Purgathofer, "Light Space Perspective Shadow Maps", EGSR 2004. The projection is
// in visibility/light_warp.

#include "technique/map_technique.h"
#include "visibility/light_warp.h"

namespace gnomon {

const TechniqueInfo& lispsm_info();

namespace {

using Options = MapOptions;

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table("lispsm", {}, map_rows<Options>());
    return table;
}

class LightSpacePerspective final : public MapTechnique {
public:
    LightSpacePerspective(Context& context, const Options& options)
        : MapTechnique(context, lispsm_info(), options), options_(options) {}

private:
    MapPlan plan(const Frame& frame, const Seen& seen) const override {
        const Box3 bounds = frame.scene.bounds();
        const auto& light = std::get<DirectionalLight>(frame.light);
        const LightFit fit =
            fit_warped(Warp::lispsm, kDefaultFocus, light, frame.camera,
                       visible_corners(frame.camera, frame.size, seen.bounds, seen.range), bounds,
                       options_.size_texels(), options_.margin_texels());
        return {.layers = {directional_layer(frame, seen, fit, seen.range)}};
    }

    Options options_;
};

}  // namespace

const TechniqueInfo& lispsm_info() {
    static const TechniqueInfo info{
        .name = "lispsm",
        .title = "Light-space perspective shadow map",
        .source = "wimmer2004",
        .lights = LightKinds::directional,
        .penumbra = Penumbra::fixed_width,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<LightSpacePerspective>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
