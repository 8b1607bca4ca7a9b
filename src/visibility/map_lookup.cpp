#include "visibility/map_lookup.h"

#include "map_lookup.comp.spv.h"
#include "visibility/light_shape.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/ext/vector_double4.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

namespace gnomon {

namespace {

constexpr unsigned kGroupSize = 8;

gpu::ComputePipelineInfo lookup_info(std::vector<std::uint32_t> constants) {
    using enum gpu::BindingType;
    return {.code = shaders::map_lookup_comp,
            .layout = {{texture, storage_image, storage_image, texture, uniform_buffer},
                       sizeof(shared::ReceiverPush)},
            .constants = std::move(constants)};
}

shared::MapLayerFrame layer_frame(const LightFit& fit) {
    const glm::dmat4 rows = glm::transpose(glm::dmat4(fit.clip_from_world));
    shared::MapLayerFrame layer{
        .u = 0.5 * (rows[0] + rows[3]), .v = 0.5 * (rows[1] + rows[3]), .z = rows[2], .w = rows[3]};
    if (fit.affine) {
        const TexelSteps steps = fit.texel_steps();
        const float u_m = glm::length(steps.u_ws);
        const float v_m = glm::length(steps.v_ws);
        // A step is along its row's vector, as long as that is short.
        layer.steps = {u_m / glm::length(Vec3(layer.u)), v_m / glm::length(Vec3(layer.v)),
                       std::max(u_m, v_m)};
    }
    return layer;
}

}  // namespace

float filter_radius_texels(MapFilter filter) {
    constexpr float kRadii[] = {0.5f, 1.0f, 1.5f, 2.0f, 2.5f};
    return kRadii[static_cast<std::size_t>(filter)];
}

// A filter of several texels passes over the outermost part of its reach, which has little weight;
// of few taps over less.
float deciding_reach_texels(MapFilter filter) {
    constexpr float kDecidingShares[] = {1.0f, 0.75f, 0.75f, 0.75f, 0.8f};
    return std::sqrt(2.0f) * kDecidingShares[static_cast<std::size_t>(filter)] *
           filter_radius_texels(filter);
}

float biased_reach_texels(MapFilter filter, bool receiver_plane) {
    // What neighbouring facets of a curved surface rise above the plane, found by sweeping over
    // scenes and suns (bench/bias_sweep): less brings acne where they fold, more detaches shadows.
    constexpr float kBesidePlane = 0.35f;
    return (receiver_plane ? kBesidePlane : 1.0f) * deciding_reach_texels(filter);
}

float depth_at(const Camera& camera, Extent size, double distance_m) {
    const glm::dvec4 p =
        glm::dmat4(camera.clip_from_view(size)) * glm::dvec4(0.0, 0.0, -distance_m, 1.0);
    return static_cast<float>(p.z / p.w);
}

std::size_t layer_of(const LookupLayers& layers, const Camera& camera, Vec3 p_ws) {
    const std::span all(layers.layers);
    if (layers.choice == LayerChoice::by_axis) {
        const auto along = [&](const LookupLayer& layer) {
            return (layer.fit.clip_from_world * Vec4(p_ws, 1.0f)).w;
        };
        return static_cast<std::size_t>(
            std::distance(all.begin(), std::ranges::max_element(all, {}, along)));
    }
    const double distance_m = -(camera.view_from_world * Vec4(p_ws, 1.0f)).z;
    const auto after = std::ranges::find_if(
        all.subspan(1), [&](const LookupLayer& layer) { return distance_m <= layer.from_m; });
    return static_cast<std::size_t>(std::distance(all.subspan(1).begin(), after));
}

MapLookup::MapLookup(const gpu::Device& device, MapFilter filter, const BiasOptions& bias)
    : device_(device),
      filter_(filter),
      bias_{.receiver_plane = bias.receiver_plane ? 1.0f : 0.0f,
            .reach_texels = biased_reach_texels(filter, bias.receiver_plane),
            .constant = static_cast<float>(bias.bias_constant),
            .slope = static_cast<float>(bias.bias_slope),
            .normal_offset = static_cast<float>(bias.normal_offset)},
      nearest_(device, {}),
      frame_(device, sizeof(shared::MapFrame),
             VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
             gpu::Placement::device) {}

LookupPipeline& MapLookup::pipeline(const LookupLayers& layers) {
    const bool affine = std::ranges::all_of(
        layers.layers, [](const LookupLayer& layer) { return layer.fit.affine; });
    const std::vector<std::uint32_t> constants{
        static_cast<std::uint32_t>(filter_), static_cast<std::uint32_t>(layers.layers.size()),
        affine ? 1u : 0u, static_cast<std::uint32_t>(layers.choice)};
    LookupPipeline& pipeline = pipelines_[constants];
    if (!pipeline) pipeline = LookupPipeline(device_, lookup_info(constants));
    return pipeline;
}

void MapLookup::record(gpu::Commands& commands, const raster::Receivers& receivers,
                       const Light& light, const LookupLayers& lookup_layers, const gpu::Image& map,
                       gpu::Image& visibility) {
    const std::vector<LookupLayer>& layers = lookup_layers.layers;
    assert(!layers.empty() && layers.size() <= shared::kMaxMapLayers);
    shared::MapFrame frame{};
    frame.bias = bias_;
    frame.size_texels = static_cast<float>(layers.front().fit.size_texels);
    for (std::size_t i = 0; i < layers.size(); ++i) {
        frame.layers[i] = layer_frame(layers[i].fit);
        frame.layers[i].first_depth =
            i == 0 ? 1.0f : depth_at(receivers.camera, receivers.size, layers[i].from_m);
    }
    commands.update(frame_, frame);
    commands.use(visibility, gpu::Use::storage_write);
    const gpu::Pipeline& lookup = pipeline(lookup_layers).of(light);
    commands.bind(
        lookup, {gpu::Texture{receivers.depth.view(), &nearest_},
                 gpu::StorageImage{receivers.normals.view()}, gpu::StorageImage{visibility.view()},
                 gpu::Texture{map.view(), &nearest_}, gpu::UniformBuffer{&frame_}});
    commands.push(lookup, receiver_push(receivers, light));
    commands.dispatch(receivers.size, kGroupSize);
}

}  // namespace gnomon
