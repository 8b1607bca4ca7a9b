#include "visibility/depth_map.h"

#include "caster.vert.spv.h"
#include "caster_layered.vert.spv.h"
#include "caster_masked.frag.spv.h"
#include "caster_masked.vert.spv.h"
#include "caster_masked_layered.vert.spv.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>

namespace gnomon {

namespace {

constexpr VkFormat kDepthMapFormat = VK_FORMAT_D32_SFLOAT;

gpu::Pipeline caster_pipeline(const gpu::Device& device, bool masked, bool clamps_near,
                              bool layered) {
    gpu::GraphicsPipelineInfo info;
    if (masked) {
        using enum gpu::BindingType;
        info.vertex = layered ? std::span<const std::uint32_t>(shaders::caster_masked_layered_vert)
                              : shaders::caster_masked_vert;
        info.fragment = shaders::caster_masked_frag;
        info.layout = {{storage_buffer, storage_buffer, texture},
                       sizeof(raster::shared::CasterPush)};
    } else {
        info.vertex = layered ? std::span<const std::uint32_t>(shaders::caster_layered_vert)
                              : shaders::caster_vert;
    }
    info.depth_format = kDepthMapFormat;
    info.depth_clamp = clamps_near;
    raster::set_position_input(info);
    info.instance_stride = sizeof(CasterInstance);
    for (std::uint32_t column = 0; column < 4; ++column) {
        info.attributes.push_back({.location = 1 + column,
                                   .binding = 1,
                                   .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                   .offset = column * static_cast<std::uint32_t>(sizeof(Vec4))});
    }
    if (layered) {
        info.attributes.push_back({.location = 5,
                                   .binding = 1,
                                   .format = VK_FORMAT_R32_UINT,
                                   .offset = offsetof(CasterInstance, layer)});
    }
    return gpu::Pipeline(device, info);
}

VkCullModeFlags cull_mode(Culled culled) {
    switch (culled) {
        case Culled::none:
            break;
        case Culled::clockwise:
            return VK_CULL_MODE_BACK_BIT;
        case Culled::counter_clockwise:
            return VK_CULL_MODE_FRONT_BIT;
    }
    return VK_CULL_MODE_NONE;
}

VkDrawIndexedIndirectCommand command_of(const CasterDraw& draw) {
    return {draw.index_count, draw.instance_count, draw.first_index,
            static_cast<std::int32_t>(draw.draw->first_vertex), draw.first_instance};
}

/// Whether all that is drawn can be drawn in one pass.
bool agree(std::span<const MapLayer> layers) {
    return std::ranges::all_of(layers, [&](const MapLayer& layer) {
        return layer.needed && layer.fit.clamps_near == layers.front().fit.clamps_near;
    });
}

}  // namespace

DepthMap::DepthMap(const gpu::Device& device) : device_(device) {}

bool DepthMap::record(gpu::Commands& commands, const raster::GpuScene& scene,
                      std::span<const MapLayer> layers, const CasterOptions& options) {
    const bool is_new =
        make_image(layers.front().fit.size_texels, static_cast<unsigned>(layers.size()));
    make_buffers(scene.parts().size() * layers.size());
    Contents contents{.ignore_alpha = options.ignore_alpha};
    contents.passes = place_casters(scene, layers, options.layered);
    contents.instances = casters_.instances();
    if (options.reuse && !is_new && holds(scene) && contents == drawn_) return false;
    drawn_ = std::move(contents);
    drawn_scene_ = scene.scene().identity();

    upload(commands);
    commands.use(image_, gpu::Use::depth_target);
    std::uint64_t first_command = 0;
    for (const Pass& pass : drawn_.passes) {
        commands.begin_drawing(
            {.depth = &image_, .depth_layer = pass.layer, .size = image_.size()});
        draw(commands, scene, pass, first_command, options);
        commands.end_drawing();
        first_command += pass.draws.size();
    }
    commands.use(image_, gpu::Use::sampled);
    return true;
}

bool DepthMap::holds(const raster::GpuScene& scene) const {
    const std::weak_ptr<const SceneData> identity = scene.scene().identity();
    return !drawn_scene_.owner_before(identity) && !identity.owner_before(drawn_scene_);
}

bool DepthMap::make_image(unsigned size_texels, unsigned layers) {
    const Extent size{size_texels, size_texels};
    if (image_ && image_.size() == size && image_.info().layers == layers) return false;
    image_ = gpu::Image(
        device_, {.size = size,
                  .format = kDepthMapFormat,
                  .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                  .layers = layers,
                  .array = true});
    return true;
}

// As many as there can be in any frame of a scene.
void DepthMap::make_buffers(std::size_t most_draws) {
    if (instances_ && instances_.size_bytes() >= most_draws * sizeof(CasterInstance)) return;
    instances_ = gpu::Buffer(device_, most_draws * sizeof(CasterInstance),
                             VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                             gpu::Placement::device);
    commands_ = gpu::Buffer(device_, most_draws * sizeof(VkDrawIndexedIndirectCommand),
                            VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                            gpu::Placement::device);
}

std::vector<DepthMap::Pass> DepthMap::place_casters(const raster::GpuScene& scene,
                                                    std::span<const MapLayer> layers,
                                                    bool layered) {
    casters_.clear();
    std::vector<Pass> passes;
    const bool together = layered && device_.optional().layered_output && agree(layers);
    for (std::size_t i = 0; i < layers.size(); ++i) {
        if (!layers[i].needed) continue;
        std::vector<CasterDraw> draws =
            casters_.add(scene, layers[i], static_cast<std::uint32_t>(i));
        if (!together || passes.empty()) {
            passes.push_back({together ? -1 : static_cast<int>(i), layers[i].fit.clamps_near, {}});
        }
        std::vector<CasterDraw>& all = passes.back().draws;
        all.insert(all.end(), draws.begin(), draws.end());
    }
    for (Pass& pass : passes)
        sort_by_state(pass.draws);
    return passes;
}

void DepthMap::upload(gpu::Commands& commands) {
    std::vector<VkDrawIndexedIndirectCommand> draws;
    for (const Pass& pass : drawn_.passes) {
        for (const CasterDraw& draw : pass.draws)
            draws.push_back(command_of(draw));
    }
    if (draws.empty()) return;
    commands.update(instances_, std::as_bytes(std::span(drawn_.instances)), gpu::Use::vertex_read);
    commands.update(commands_, std::as_bytes(std::span(draws)), gpu::Use::vertex_read);
}

DepthMap::Pipelines& DepthMap::pipelines(const Pass& pass) {
    const bool layered = pass.layer < 0;
    std::optional<Pipelines>& made = pipelines_[pass.clamps_near ? 1 : 0][layered ? 1 : 0];
    if (!made) {
        made.emplace(Pipelines{caster_pipeline(device_, false, pass.clamps_near, layered),
                               caster_pipeline(device_, true, pass.clamps_near, layered)});
    }
    return *made;
}

void DepthMap::draw(gpu::Commands& commands, const raster::GpuScene& scene, const Pass& pass,
                    std::uint64_t first_command, const CasterOptions& options) {
    const Pipelines& with = pipelines(pass);
    const VkCommandBuffer handle = commands.handle();
    const std::array buffers{scene.positions().handle(), instances_.handle()};
    const std::array<VkDeviceSize, 2> offsets{};
    vkCmdBindVertexBuffers(handle, 0, 2, buffers.data(), offsets.data());
    vkCmdBindIndexBuffer(handle, scene.caster_indices().handle(), 0, VK_INDEX_TYPE_UINT32);
    const bool multi_draw = options.multi_draw && device_.optional().multi_draw;
    const std::span<const CasterDraw> draws = pass.draws;
    const auto needs_texture = [&](const CasterDraw& draw) {
        return draw.draw->masked && !options.ignore_alpha;
    };
    for (std::size_t first = 0, end = 0; first < draws.size(); first = end) {
        const CasterDraw& one = draws[first];
        end = first + 1;
        vkCmdSetCullMode(handle, cull_mode(one.culled));
        if (needs_texture(one)) {
            const std::uint32_t material = one.draw->material;
            commands.bind(with.masked,
                          {gpu::StorageBuffer{&scene.attributes()},
                           gpu::StorageBuffer{&scene.materials()}, scene.base_color(material)});
            commands.push(with.masked, raster::shared::CasterPush{material});
        } else {
            commands.bind(with.opaque, {});
            while (end < draws.size() && !needs_texture(draws[end]) &&
                   draws[end].culled == one.culled) {
                ++end;
            }
        }
        if (multi_draw) {
            commands.draw_indexed(commands_, first_command + first, end - first);
            continue;
        }
        for (const CasterDraw& draw : draws.subspan(first, end - first)) {
            const VkDrawIndexedIndirectCommand c = command_of(draw);
            vkCmdDrawIndexed(handle, c.indexCount, c.instanceCount, c.firstIndex, c.vertexOffset,
                             c.firstInstance);
        }
    }
}

}  // namespace gnomon
