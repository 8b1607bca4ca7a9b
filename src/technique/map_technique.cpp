#include "technique/map_technique.h"

namespace gnomon {

namespace {

/// A simplified caster may be so much nearer to the light than the surface that it stands for.
BiasOptions bias(const MapOptions& options) {
    BiasOptions bias = options;
    bias.bias_constant += options.caster_error;
    return bias;
}

}  // namespace

MapTechnique::MapTechnique(Context& context, const TechniqueInfo& info, const MapOptions& options)
    : GpuTechnique(context, info),
      options_(options),
      map_(context.impl().device()),
      lookup_(context.impl().device(), options.filter, bias(options)) {}

PlannedLayer MapTechnique::directional_layer(const Frame& frame, const Seen& seen,
                                             const LightFit& fit, DepthRange range) {
    const DVec3 to_light_ws(std::get<DirectionalLight>(frame.light).to_light_ws);
    return {
        {fit, range.near_m},
        CasterVolume(fit, to_light_ws, visible_planes(frame.camera, frame.size, seen.bounds, range),
                     static_cast<double>(frame.scene.bounds().diagonal()))};
}

PlannedLayer MapTechnique::local_layer(const Frame& frame, const Seen& seen, const LightView& view,
                                       bool tight) const {
    const std::vector<DVec3> receivers_ws =
        visible_corners(frame.camera, frame.size, seen.bounds, seen.range, view.planes());
    const LightFit fit =
        fit_view(tight && !receivers_ws.empty() ? fitted(view, receivers_ws) : view,
                 frame.scene.bounds(), options_.size_texels(), options_.margin_texels());
    return {{fit},
            CasterVolume(fit, visible_planes(frame.camera, frame.size, seen.bounds, seen.range),
                         view.position_ws),
            !receivers_ws.empty()};
}

void MapTechnique::record(gpu::Commands& commands, const RecordInput& input,
                          gpu::Image& visibility) {
    std::vector<MapLayer> drawn;
    const Seen seen = seen_part(input.frame.camera, input.frame.size, input.scene.part_bounds_ws());
    const MapPlan planned = plan(input.frame, seen);
    layers_ = {.choice = planned.choice};
    for (const PlannedLayer& layer : planned.layers) {
        drawn.push_back({layer.lookup.fit, options_.cull_casters ? layer.casters : CasterVolume(),
                         static_cast<float>(options_.caster_error),
                         layer.needed || !options_.cull_casters});
        layers_.layers.push_back(layer.lookup);
    }
    {
        const gpu::Pass pass(commands, "depth");
        map_.record(commands, input.scene, drawn, input.frame.ignore_alpha, options_.reuse_maps);
    }
    const gpu::Pass pass(commands, "lookup");
    lookup_.record(commands, input.receivers, input.frame.light, layers_, map_.image(), visibility);
}

void MapTechnique::describe_texels(const Frame& frame, Visibility::Impl& out) {
    out.set_texels(
        [layers = layers_, camera = frame.camera](Vec3 p_ws) {
            return layers.layers[layer_of(layers, camera, p_ws)].fit.texel_size_m(p_ws);
        },
        filter_radius_texels(options_.filter), frame);
}

}  // namespace gnomon
