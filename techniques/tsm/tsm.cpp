// Trapezoidal shadow map: one map in which the nearer part of the view fills four fifths. T.
// Martin, T.-S. Tan, "Anti-aliasing and Continuity with Trapezoidal Shadow Maps", EGSR 2004. The
// projection is in visibility/light_warp.

#include "technique/map_technique.h"
#include "visibility/light_warp.h"

namespace gnomon {

const TechniqueInfo& tsm_info();

namespace {

struct Options : MapOptions {
    double focus = kDefaultFocus;
};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table(
        "tsm",
        {number("focus", &Options::focus, 0.01, 0.99, "1",
                "how much of the depth of the view, from the nearest receiver on, fills four "
                "fifths of the map")},
        map_rows<Options>());
    return table;
}

class Trapezoidal final : public MapTechnique {
public:
    Trapezoidal(Context& context, const Options& options)
        : MapTechnique(context, tsm_info(), options), options_(options) {}

private:
    MapPlan plan(const Frame& frame, const Seen& seen) const override {
        const Box3 bounds = frame.scene.bounds();
        const auto& light = std::get<DirectionalLight>(frame.light);
        const LightFit fit =
            fit_warped(Warp::trapezoidal, options_.focus, light, frame.camera,
                       visible_corners(frame.camera, frame.size, seen.bounds, seen.range), bounds,
                       options_.size_texels(), options_.margin_texels());
        return {.layers = {directional_layer(frame, seen, fit, seen.range)}};
    }

    Options options_;
};

}  // namespace

const TechniqueInfo& tsm_info() {
    static const TechniqueInfo info{
        .name = "tsm",
        .title = "Trapezoidal shadow map",
        .source = "martin2004",
        .lights = LightKinds::directional,
        .penumbra = Penumbra::fixed_width,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<Trapezoidal>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
