#include "visibility/map_lookup.h"

#include "map_lookup.comp.spv.h"
#include "visibility/light_shape.h"
#include "visibility/map_bounds.h"
#include "visibility/receiver_survey.shared.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/ext/vector_double4.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <numbers>
#include <span>
#include <utility>

namespace gnomon {

namespace {

constexpr unsigned kGroupSize = shared::kSurveyBlock_px;

// What neighbouring facets of a curved surface rise above a receiver's plane, of what the plane
// gains itself, found by sweeping over scenes and suns (bench/bias_sweep): less brings acne where
// they fold, more detaches shadows.
constexpr float kBesidePlane = 0.35f;

// Of the range of distances: what is nearer to a receiver than this half its variance's root does
// not hide it. Rounding of 32-bit moments is a hundred times less.
constexpr float kLeastDeviation = 2e-4f;

gpu::ComputePipelineInfo lookup_info(std::vector<std::uint32_t> constants) {
    using enum gpu::BindingType;
    return {.code = shaders::map_lookup_comp,
            .layout = {{texture, storage_image, storage_image, texture, uniform_buffer, texture,
                        storage_buffer, texture, storage_image},
                       sizeof(shared::MapLookupPush)},
            .constants = std::move(constants)};
}

gpu::Buffer block_buffer(const gpu::Device& device, std::uint64_t bytes) {
    return gpu::Buffer(device, bytes,
                       VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                       gpu::Placement::device);
}

/// For positions from `eye_ws`.
shared::MapLayerFrame layer_frame(const LightFit& fit, Vec3 eye_ws) {
    glm::dmat4 clip(fit.clip_from_world);
    clip[3] = clip * glm::dvec4(DVec3(eye_ws), 1.0);
    const glm::dmat4 rows = glm::transpose(clip);
    shared::MapLayerFrame layer{
        .u = 0.5 * (rows[0] + rows[3]), .v = 0.5 * (rows[1] + rows[3]), .z = rows[2], .w = rows[3]};
    layer.space = map_space(fit);
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

/// Which layer the shader chooses by a depth of the picture.
std::size_t layer_at(std::span<const shared::MapLayerFrame> layers, float depth) {
    std::size_t chosen = 0;
    for (std::size_t i = 1; i < layers.size(); ++i) {
        if (depth < layers[i].first_depth) chosen = i;
    }
    return chosen;
}

/// Taps at any distance are free of acne on a plane when what it gains over that is made up for.
float cone(const ReadingOptions& reading, const BiasOptions& bias) {
    if (reading.filter < MapFilter::disc) return 0.0f;
    return (bias.receiver_plane ? kBesidePlane : 1.0f) *
           static_cast<float>(bias.bias_slope + bias.normal_offset);
}

/// A texel's centre is up to half a diagonal away from the receiver, and is to be before the wall.
/// Wider filters read both sides alike, or are half lit by what is before it.
float grazed_texels(const ReadingOptions& reading, const BiasOptions& bias) {
    constexpr float kReads = 1.25f;
    return bias.receiver_plane ? std::max(0.0f, kReads - least_radius_texels(reading)) : 0.0f;
}

}  // namespace

float filter_radius_texels(const ReadingOptions& reading) {
    constexpr float kBilinear = 1.0f;
    if (is_blurred(reading.content)) return static_cast<float>(reading.blur) + kBilinear;
    switch (reading.filter) {
        case MapFilter::nearest:
            return 0.5f;
        case MapFilter::hardware_2x2:
            return kBilinear;
        case MapFilter::box_3x3:
            return 1.5f;
        case MapFilter::dithered_4:
        case MapFilter::taps_16:
            return 2.5f;
        case MapFilter::disc:
            return static_cast<float>(reading.filter_radius) + kBilinear;
        case MapFilter::footprint:
            return static_cast<float>(0.5 * std::numbers::sqrt2 * reading.filter_most) + kBilinear;
        case MapFilter::pcss:
            return static_cast<float>(reading.filter_most) + kBilinear;
        case MapFilter::box_4x4:
            break;
    }
    return 2.0f;
}

float least_radius_texels(const ReadingOptions& reading) {
    ReadingOptions least = reading;
    least.filter_most = reading.filter == MapFilter::pcss ? 1.0 : 0.0;
    return filter_radius_texels(least);
}

// A filter of several texels passes over the outermost part of its reach, which has little weight;
// of few taps over less.
float deciding_reach_texels(const ReadingOptions& reading) {
    const float diagonal = std::sqrt(2.0f);
    if (is_blurred(reading.content)) return 0.75f * diagonal;
    switch (reading.filter) {
        case MapFilter::nearest:
            return diagonal * 0.5f;
        case MapFilter::box_3x3:
            return diagonal * 0.75f * 1.5f;
        case MapFilter::box_4x4:
            return diagonal * 0.75f * 2.0f;
        case MapFilter::taps_16:
            return diagonal * 0.75f * 2.5f;
        case MapFilter::dithered_4:
            return diagonal * 0.8f * 2.5f;
        default:  // bilinear taps
            return diagonal * 0.75f;
    }
}

float biased_reach_texels(const ReadingOptions& reading, bool receiver_plane) {
    return (receiver_plane ? kBesidePlane : 1.0f) * deciding_reach_texels(reading);
}

std::size_t layer_of(const LookupLayers& layers, const Camera& camera, Vec3 p_ws) {
    const std::span all(layers.layers);
    if (layers.choice == LayerChoice::by_axis) {
        const auto along = [&](const LookupLayer& layer) {
            return (layer.fit.clip_from_world * glm::dvec4(DVec3(p_ws), 1.0)).w;
        };
        return static_cast<std::size_t>(
            std::distance(all.begin(), std::ranges::max_element(all, {}, along)));
    }
    const double distance_m = -(camera.view_from_world * Vec4(p_ws, 1.0f)).z;
    const auto after = std::ranges::find_if(
        all.subspan(1), [&](const LookupLayer& layer) { return distance_m <= layer.from_m; });
    return static_cast<std::size_t>(std::distance(all.subspan(1).begin(), after));
}

MapLookup::MapLookup(const gpu::Device& device, const ReadingOptions& reading,
                     const BiasOptions& bias)
    : device_(device),
      reading_(reading),
      bias_{.receiver_plane = bias.receiver_plane ? 1.0f : 0.0f,
            .reach_texels = biased_reach_texels(reading, bias.receiver_plane),
            .constant = static_cast<float>(bias.bias_constant),
            .slope = static_cast<float>(bias.bias_slope),
            .normal_offset = static_cast<float>(bias.normal_offset),
            .cone = cone(reading, bias),
            .grazed_texels = grazed_texels(reading, bias),
            .distance_scale = static_cast<float>(reading.distance_scale),
            .distance_offset = static_cast<float>(reading.distance_offset)},
      nearest_(device, {}),
      frame_(device, sizeof(shared::MapFrame),
             VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
             gpu::Placement::device),
      blocks_(block_buffer(device, sizeof(std::uint32_t))) {}

LookupPipeline& MapLookup::pipeline(const LookupLayers& layers, std::size_t layer_count,
                                    std::uint32_t proof, bool listed) {
    const bool affine = std::ranges::all_of(
        layers.layers, [](const LookupLayer& layer) { return layer.fit.affine; });
    const std::vector<std::uint32_t> constants{static_cast<std::uint32_t>(reading_.filter),
                                               static_cast<std::uint32_t>(reading_.content),
                                               static_cast<std::uint32_t>(reading_.filter_taps),
                                               static_cast<std::uint32_t>(layer_count),
                                               affine ? 1u : 0u,
                                               static_cast<std::uint32_t>(layers.choice),
                                               proof,
                                               listed ? 1u : 0u};
    LookupPipeline& pipeline = pipelines_[constants];
    if (!pipeline) pipeline = LookupPipeline(device_, lookup_info(constants));
    return pipeline;
}

// Most blocks lie in one layer, which need then not be chosen pixel by pixel; the others are looked
// up in all of them, as all are where depths do not tell the layer. Groups fill rectangles: a few
// more than there are blocks do the last one again.
std::vector<MapLookup::Part> MapLookup::list(gpu::Commands& commands, const ReceiverSurvey& survey,
                                             const shared::MapFrame& frame, LayerChoice choice,
                                             std::size_t layer_count) {
    constexpr unsigned kMostInRow = 4096;  // devices take 65535
    const std::span all(frame.layers, layer_count);
    std::vector<std::vector<std::uint32_t>> places(layer_count + 1);  // the last: of several
    for (const SeenBlock& block : survey.blocks()) {
        const std::size_t nearest = layer_at(all, block.nearest_depth);
        const bool is_one = choice == LayerChoice::by_distance &&
                            nearest == layer_at(all, block.farthest_depth * (1.0f - frame.blend));
        places[is_one ? nearest : layer_count].push_back(block.place);
    }
    std::vector<std::uint32_t> blocks;
    std::vector<Part> parts;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (places[i].empty()) continue;
        const auto count = static_cast<unsigned>(places[i].size());
        const unsigned width = std::min(count, kMostInRow);
        const Extent groups{width, (count + width - 1) / width};
        const bool is_one = i < layer_count;
        parts.push_back({is_one ? static_cast<unsigned>(i) : 0, is_one ? 1 : layer_count,
                         static_cast<unsigned>(blocks.size()), groups});
        blocks.insert(blocks.end(), places[i].begin(), places[i].end());
        blocks.resize(blocks.size() + std::size_t{groups.width} * groups.height - count,
                      blocks.back());
    }
    if (blocks.empty()) return parts;
    const std::span<const std::byte> bytes = std::as_bytes(std::span<const std::uint32_t>(blocks));
    if (blocks_.size_bytes() < bytes.size()) blocks_ = block_buffer(device_, bytes.size());
    commands.update(blocks_, bytes);
    return parts;
}

void MapLookup::record(gpu::Commands& commands, const raster::Receivers& receivers,
                       const Light& light, const LookupLayers& lookup_layers, const gpu::Image& map,
                       const gpu::Image& ids, const MapBounds* bounds, const ReceiverSurvey* survey,
                       gpu::Image& visibility) {
    const std::vector<LookupLayer>& layers = lookup_layers.layers;
    assert(!layers.empty() && layers.size() <= shared::kMaxMapLayers);
    shared::MapFrame frame{};
    frame.bias = bias_;
    frame.reading = {.radius_texels = static_cast<float>(reading_.filter_radius),
                     .most_texels = static_cast<float>(reading_.filter_most),
                     .exponent = static_cast<float>(reading_.exponent),
                     .least_variance = kLeastDeviation * kLeastDeviation,
                     .bleeding = static_cast<float>(reading_.light_bleeding)};
    frame.receivers = receiver_push(receivers, light);
    frame.size_texels = static_cast<float>(layers.front().fit.size_texels);
    frame.bounded_texels = bounds == nullptr ? Vec3(0) : bounds->reach_texels();
    frame.blend = static_cast<float>(lookup_layers.blend);
    for (std::size_t i = 0; i < layers.size(); ++i) {
        frame.layers[i] = layer_frame(layers[i].fit, receivers.camera.eye_ws());
        frame.layers[i].bias_scale = layers[i].bias_scale;
        frame.layers[i].first_depth =
            i == 0 ? 1.0f : depth_at(receivers.camera, receivers.size, layers[i].from_m);
    }
    commands.update(frame_, frame);
    if (survey != nullptr) commands.clear(visibility, {.float32 = {1.0f, 0.0f, 0.0f, 0.0f}});
    const Extent whole{(receivers.size.width + kGroupSize - 1) / kGroupSize,
                       (receivers.size.height + kGroupSize - 1) / kGroupSize};
    const std::vector<Part> parts =
        survey != nullptr ? list(commands, *survey, frame, lookup_layers.choice, layers.size())
                          : std::vector<Part>{{0, layers.size(), 0, whole}};
    commands.use(visibility, gpu::Use::storage_write);
    const std::uint32_t proof = bounds == nullptr ? shared::kProofNone
                                : shows_proven_   ? shared::kProofShown
                                                  : shared::kProofSkips;
    for (const Part& part : parts) {
        const gpu::Pipeline& lookup =
            pipeline(lookup_layers, part.layer_count, proof, survey != nullptr).of(light);
        commands.bind(
            lookup,
            {gpu::Texture{receivers.depth.view(), &nearest_},
             gpu::StorageImage{receivers.normals.view()}, gpu::StorageImage{visibility.view()},
             gpu::Texture{map.view(), &nearest_}, gpu::UniformBuffer{&frame_},
             gpu::Texture{(bounds == nullptr ? map : bounds->image()).view(), &nearest_},
             gpu::StorageBuffer{&blocks_}, gpu::Texture{ids.view(), &nearest_},
             gpu::StorageImage{receivers.ids.view()}});
        commands.push(lookup, shared::MapLookupPush{part.first_layer, part.first_block});
        commands.dispatch(part.groups, 1);
    }
}

}  // namespace gnomon
