#include "technique/map_technique.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace gnomon {

namespace {

/// A simplified caster may be so much nearer to the light than the surface that it stands for.
BiasOptions bias(const MapOptions& options) {
    BiasOptions bias = options;
    bias.bias_constant += options.simplified_texels();
    return bias;
}

/// What is in a map that is reused must not depend on what the camera sees just now.
CasterVolume drawn_casters(const MapOptions& options, const PlannedLayer& layer) {
    CasterVolume casters;
    if (options.cull_casters)
        casters = options.reuse_maps ? CasterVolume(layer.lookup.fit) : layer.casters;
    if (layer.lost_behind_ws) casters.keep_in_front(*layer.lost_behind_ws);
    return casters;
}

}  // namespace

MapTechnique::MapTechnique(Context& context, const TechniqueInfo& info, const MapOptions& options)
    : GpuTechnique(context, info),
      options_(options),
      maps_(std::make_unique<Maps>(context.impl().device(), options)),
      lookup_(context.impl().device(), options, bias(options)) {
    if (options.fit_to == FitTo::picture)
        survey_ = std::make_unique<ReceiverSurvey>(context.impl().device());
}

MapTechnique::Maps::Maps(const gpu::Device& device, const MapOptions& options)
    : map(device), bounds(device, options) {
    if (!is_computed(options.content)) return;
    contents =
        std::make_unique<ContentMap>(device, options.content, static_cast<float>(options.exponent),
                                     static_cast<float>(options.blur));
}

std::uint64_t MapTechnique::Maps::memory_bytes() const {
    return map.memory_bytes() + (contents ? contents->memory_bytes() : 0) + bounds.memory_bytes();
}

PlannedLayer MapTechnique::directional_layer(const Frame& frame, const Seen& seen,
                                             const LightFit& fit, DepthRange range) const {
    const DVec3 to_light_ws(std::get<DirectionalLight>(frame.light).to_light_ws);
    PlannedLayer layer{
        {fit, range.near_m},
        CasterVolume(fit, to_light_ws, visible_planes(frame.camera, frame.size, seen.bounds, range),
                     static_cast<double>(frame.scene.bounds().diagonal()))};
    if (!seen.tiles.empty() && fit.affine) {
        std::vector<Box3> receivers_ws;
        for (const SeenTile& tile : seen.tiles)
            receivers_ws.push_back(tile.bounds);
        auto margin_texels = static_cast<double>(options_.margin_texels());
        // A disc in the world is longer along the axis of the shorter texels.
        const TexelSteps steps = fit.texel_steps();
        const double u_m = glm::length(steps.u_ws), v_m = glm::length(steps.v_ws);
        if (options_.filter == MapFilter::pcss)
            margin_texels *= std::max(u_m, v_m) / std::min(u_m, v_m);
        layer.casters.keep_before(ReceiverMask(fit, receivers_ws, margin_texels));
    }
    return layer;
}

PlannedLayer MapTechnique::local_layer(const Frame& frame, const Seen& seen, const LightView& view,
                                       bool tight) const {
    const auto planes = view.planes();
    const Seen inside = seen.within(seen.range, planes);
    const std::vector<DVec3> receivers_ws =
        visible_corners(frame.camera, frame.size, inside.bounds, inside.range, planes);
    const LightFit fit =
        fit_view(tight && !receivers_ws.empty() ? fitted(view, receivers_ws) : view,
                 frame.scene.bounds(), options_.size_texels(), options_.margin_texels());
    return {{fit},
            CasterVolume(fit, visible_planes(frame.camera, frame.size, inside.bounds, inside.range),
                         view.position_ws),
            !receivers_ws.empty()};
}

bool MapTechnique::survey(gpu::Commands& commands, const RecordInput& input) {
    if (!survey_) return false;
    const gpu::Pass pass(commands, "survey");
    survey_->record(commands, input.receivers);
    return true;
}

void MapTechnique::record(gpu::Commands& commands, const RecordInput& input,
                          gpu::Image& visibility) {
    auto& [map, contents, bounds] = *maps_;
    std::vector<MapLayer> drawn;
    std::vector<LightFit> fits;
    bool is_drawn = false;
    const Seen seen =
        survey_ ? survey_->seen()
                : seen_part(input.frame.camera, input.frame.size, input.scene.part_bounds_ws());
    const MapPlan planned = plan(input.frame, seen);
    layers_ = {.choice = planned.choice, .layers = {}, .blend = planned.blend};
    for (const PlannedLayer& layer : planned.layers) {
        drawn.push_back({layer.lookup.fit, drawn_casters(options_, layer),
                         static_cast<float>(options_.simplified_texels()), options_.faces,
                         layer.needed || !options_.cull_casters});
        layers_.layers.push_back(layer.lookup);
        fits.push_back(layer.lookup.fit);
    }
    const bool ids = options_.content == MapContent::object_id;
    {
        const gpu::Pass pass(commands, "depth");
        is_drawn = map.record(commands, input.scene, drawn,
                              {.ignore_alpha = input.frame.ignore_alpha,
                               .reuse = options_.reuse_maps && !ids,
                               .multi_draw = options_.multi_draw,
                               .layered = options_.layered && !ids,
                               .positions_only = options_.positions_only,
                               .optimised_indices = options_.optimised_indices,
                               .ids = ids});
    }
    for (std::size_t i = 0; i < fits.size(); ++i)
        fits[i] = map.drawn_fit(i, fits[i]);
    if (contents && (is_drawn || !contents->measures_as(fits))) {
        const gpu::Pass pass(commands, "content");
        contents->record(commands, map.image(), fits);
    }
    if (is_drawn) bounds.outdate();
    const bool is_bounded = bounds.pay(options_.skip_uniform, input.frame.size, map.image(), fits);
    if (is_bounded) {
        const gpu::Pass pass(commands, "bounds");
        bounds.record(commands, map.image());
    }
    const gpu::Pass pass(commands, "lookup");
    lookup_.record(commands, input.receivers, input.frame.light, layers_,
                   contents ? contents->image() : map.image(), map.ids(),
                   is_bounded ? &bounds : nullptr, survey_.get(), visibility);
}

void MapTechnique::describe_texels(const Frame& frame, Visibility::Impl& out) {
    out.set_texels(
        [layers = layers_, camera = frame.camera](Vec3 p_ws) {
            return layers.layers[layer_of(layers, camera, p_ws)].fit.texel_size_m(p_ws);
        },
        least_radius_texels(options_), frame);
}

}  // namespace gnomon
