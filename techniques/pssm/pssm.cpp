// Parallel-split shadow maps: the view cut across its axis, a map for each piece. F. Zhang, H. Sun,
// L. Xu, L. K. Lun, "Parallel-Split Shadow Maps for Large-scale Virtual Environments", VRCIA 2006;
// W. Engel, "Cascaded Shadow Maps", ShaderX5, 2006. Departures: a split's map is the smallest
// rectangle around what the camera sees of the scene in it, or, stable, a sphere that does not move
// with the camera (M. Valient, ShaderX6, 2008); or it is warped along the view as well.

#include "split_distances.h"
#include "technique/map_technique.h"
#include "visibility/light_view.h"
#include "visibility/light_warp.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon {

const TechniqueInfo& pssm_info();

namespace {

enum class Fit { tight, stable };

struct Options : MapOptions {
    Options() { filter = MapFilter::box_3x3; }
    int splits = 4;
    bool fewer_splits = false;
    double split_lambda = 0.8;
    double split_blend = 0.0;
    double split_bias = 1.0;
    double camera_shift = 0.0;
    Fit fit = Fit::tight;
    int stable_step = 1;
    Warp warp = Warp::none;
};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table(
        "pssm",
        {integer("splits", &Options::splits, 1, static_cast<int>(shared::kMaxMapLayers), "1",
                 "pieces that the view is cut into"),
         boolean("fewer_splits", &Options::fewer_splits,
                 "only as many as the farthest receiver needs, were all that a camera may see from "
                 "here cut into splits: where little is seen, fewer maps with larger texels"),
         number("split_lambda", &Options::split_lambda, 0.0, 1.0, "1",
                "0: pieces of equal length; 1: each longer than the one before by one factor"),
         number("split_blend", &Options::split_blend, 0.0, 0.5, "1",
                "of the distance at which a split begins, over how much before it pixels mix with "
                "it by turns"),
         number("split_bias", &Options::split_bias, 0.125, 8.0, "1",
                "bias_constant of a split, of that of the one before"),
         number("camera_shift", &Options::camera_shift, 0.0, 1e6, "m",
                "maps also hold what is up to so far behind the camera; casters there are drawn "
                "without it too"),
         choice("fit", &Options::fit, {"tight", "stable"},
                "tight: the smallest map around what is seen; stable: edges do not crawl when the "
                "camera moves"),
         integer("stable_step", &Options::stable_step, 1, 256, "texels",
                 "a stable map moves by as many at once, for which it spends as many; no more than "
                 "an eighth of it. With reuse_maps most frames then draw none"),
         choice("warp", &Options::warp, {"none", "lispsm", "trapezoidal"},
                "smaller texels towards the camera within a split; only with a tight fit")},
        map_rows<Options>());
    return table;
}

/// The camera moved against its view.
Camera moved_back(Camera camera, double by_m) {
    camera.view_from_world[3].z -= static_cast<float>(by_m);
    return camera;
}

/// A range that holds this one and stays the same while the camera moves a little: its ends are
/// powers of 2 and three steps between them, lest splits and so texels change with each frame.
DepthRange in_steps(DepthRange range) {
    constexpr double kSteps = 4.0;
    return {std::exp2(std::floor(kSteps * std::log2(range.near_m)) / kSteps),
            std::exp2(std::ceil(kSteps * std::log2(range.far_m)) / kSteps)};
}

class ParallelSplits final : public MapTechnique {
public:
    ParallelSplits(Context& context, const Options& options)
        : MapTechnique(context, pssm_info(), options), options_(options) {}

private:
    MapPlan plan(const Frame& frame, const Seen& seen) const override {
        MapPlan plan;
        // In a parallel view depths are no inverses of distances, by which the look-up mixes.
        if (frame.camera.ortho_height_m == 0.0f) plan.blend = options_.split_blend;
        if (seen.range.far_m > seen.range.near_m) {  // else no receiver is seen
            const std::vector<DepthRange> occupied =
                options_.fit == Fit::stable ? std::vector{in_steps(seen.range)} : seen.occupied();
            const std::vector<double> distances_m =
                pssm::split_distances(occupied, splits_of(frame, seen), options_.split_lambda);
            for (std::size_t i = 0; i + 1 < distances_m.size(); ++i) {
                const DepthRange range{distances_m[i] * (1.0 - plan.blend), distances_m[i + 1]};
                const Seen inside = seen.within(range);
                std::vector<DVec3> receivers_ws =
                    visible_corners(frame.camera, frame.size, inside.bounds, inside.range);
                // A stable map that no receiver needs now keeps its place, and what is in it.
                if (receivers_ws.empty() && options_.fit != Fit::stable) continue;
                const bool is_needed = !receivers_ws.empty();
                add_shifted(receivers_ws, frame, range);
                plan.layers.push_back(split(frame, inside, range, receivers_ws));
                plan.layers.back().needed = is_needed;
                plan.layers.back().lookup.from_m = distances_m[i];
                plan.layers.back().lookup.bias_scale =
                    static_cast<float>(std::pow(options_.split_bias, static_cast<double>(i)));
            }
        }
        if (plan.layers.empty()) plan.layers.push_back(split(frame, seen, {0.0, 0.0}, {}));
        return plan;
    }

    int splits_of(const Frame& frame, const Seen& seen) const {
        if (!options_.fewer_splits) return options_.splits;
        const DVec3 eye_ws(glm::inverse(glm::dmat4(frame.camera.view_from_world))[3]);
        const DepthRange whole{
            std::min(seen.range.near_m, double{frame.camera.near_m}),
            std::max(seen.range.far_m, farthest_m(frame.scene.bounds(), eye_ws))};
        return pssm::splits_needed(whole, seen.range.far_m, options_.splits, options_.split_lambda);
    }

    /// Also what a camera that is moved back would see of the scene in the split.
    void add_shifted(std::vector<DVec3>& receivers_ws, const Frame& frame, DepthRange range) const {
        if (!(options_.camera_shift > 0.0)) return;
        range.far_m += options_.camera_shift;
        const std::vector<DVec3> more =
            visible_corners(moved_back(frame.camera, options_.camera_shift), frame.size,
                            frame.scene.bounds(), range);
        receivers_ws.insert(receivers_ws.end(), more.begin(), more.end());
    }

    PlannedLayer split(const Frame& frame, const Seen& seen, DepthRange range,
                       std::span<const DVec3> receivers_ws) const {
        const auto& light = std::get<DirectionalLight>(frame.light);
        const Box3 bounds = frame.scene.bounds();
        const bool stable = options_.fit == Fit::stable && range.far_m > range.near_m;
        constexpr int kLeastSteps = 8;  // across a map, which else would be all margin
        const int step_texels =
            std::clamp(options_.stable_step, 1, std::max(options_.map_size / kLeastSteps, 1));
        const LightFit fit =
            stable ? fit_directional_stable(
                         light, moved_back(frame.camera, options_.camera_shift), frame.size,
                         {range.near_m, range.far_m + options_.camera_shift}, bounds,
                         options_.size_texels(), options_.margin_texels(), step_texels)
                   : fit_warped(options_.warp, kDefaultFocus, light, frame.camera, receivers_ws,
                                bounds, options_.size_texels(), options_.margin_texels());
        return directional_layer(frame, seen, fit, stable ? range : seen.range);
    }

    Options options_;
};

}  // namespace

const TechniqueInfo& pssm_info() {
    static const TechniqueInfo info{
        .name = "pssm",
        .title = "Parallel-split shadow maps",
        .source = "zhang2006, lauritzen2011, engel2006, valient2008, wimmer2004",
        .lights = LightKinds::directional,
        .penumbra = Penumbra::fixed_width,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<ParallelSplits>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
