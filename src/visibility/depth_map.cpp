#include "visibility/depth_map.h"

#include "caster.vert.spv.h"
#include "caster_masked.frag.spv.h"
#include "caster_masked.vert.spv.h"

#include <glm/ext/matrix_double4x4.hpp>

#include <array>
#include <span>

namespace gnomon {

namespace {

constexpr VkFormat kDepthMapFormat = VK_FORMAT_D32_SFLOAT;

gpu::Pipeline caster_pipeline(const gpu::Device& device, bool masked) {
    gpu::GraphicsPipelineInfo info;
    if (masked) {
        using enum gpu::BindingType;
        info.vertex = shaders::caster_masked_vert;
        info.fragment = shaders::caster_masked_frag;
        info.layout = {{storage_buffer, storage_buffer, texture},
                       sizeof(raster::shared::CasterPush)};
    } else {
        info.vertex = shaders::caster_vert;
    }
    info.depth_format = kDepthMapFormat;
    info.depth_clamp = true;
    raster::set_position_input(info);
    info.instance_stride = sizeof(Mat4);
    for (std::uint32_t column = 0; column < 4; ++column) {
        info.attributes.push_back({.location = 1 + column,
                                   .binding = 1,
                                   .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                   .offset = column * static_cast<std::uint32_t>(sizeof(Vec4))});
    }
    return gpu::Pipeline(device, info);
}

}  // namespace

DepthMap::DepthMap(const gpu::Device& device)
    : device_(device),
      opaque_(caster_pipeline(device, false)),
      masked_(caster_pipeline(device, true)) {}

void DepthMap::record(gpu::Commands& commands, const raster::GpuScene& scene,
                      const Mat4& clip_from_world, unsigned size_texels, bool ignore_alpha) {
    make_image(size_texels);
    place_instances(commands, scene, clip_from_world);
    commands.use(image_, gpu::Use::depth_target);
    commands.begin_drawing({.depth = &image_, .size = image_.size()});
    draw(commands, scene, ignore_alpha);
    commands.end_drawing();
    commands.use(image_, gpu::Use::sampled);
}

void DepthMap::make_image(unsigned size_texels) {
    const Extent size{size_texels, size_texels};
    if (image_ && image_.size() == size) return;
    image_ = gpu::Image(device_, {.size = size,
                                  .format = kDepthMapFormat,
                                  .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT |
                                           VK_IMAGE_USAGE_SAMPLED_BIT});
}

void DepthMap::place_instances(gpu::Commands& commands, const raster::GpuScene& scene,
                               const Mat4& clip_from_world) {
    const std::vector<Instance>& instances = scene.scene().instances();
    clip_from_local_.resize(instances.size());
    const glm::dmat4 from_world(clip_from_world);
    for (std::uint32_t slot = 0; slot < instances.size(); ++slot) {
        const Mat4& world_from_local = instances[scene.instance_at(slot)].world_from_local;
        clip_from_local_[slot] = Mat4(from_world * glm::dmat4(world_from_local));
    }
    const std::span<const std::byte> bytes = std::as_bytes(std::span(clip_from_local_));
    if (!instance_matrices_ || instance_matrices_.size_bytes() < bytes.size()) {
        instance_matrices_ =
            gpu::Buffer(device_, bytes.size(),
                        VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                        gpu::Placement::device);
    }
    commands.update(instance_matrices_, bytes, gpu::Use::vertex_read);
}

void DepthMap::draw(gpu::Commands& commands, const raster::GpuScene& scene,
                    bool ignore_alpha) const {
    const std::array buffers{scene.positions().handle(), instance_matrices_.handle()};
    const std::array<VkDeviceSize, 2> offsets{};
    vkCmdBindVertexBuffers(commands.handle(), 0, 2, buffers.data(), offsets.data());
    vkCmdBindIndexBuffer(commands.handle(), scene.indices().handle(), 0, VK_INDEX_TYPE_UINT32);
    const gpu::Pipeline* bound = nullptr;
    for (const raster::Draw& draw : scene.draws()) {
        if (draw.masked && !ignore_alpha) {
            commands.bind(
                masked_, {gpu::StorageBuffer{&scene.attributes()},
                          gpu::StorageBuffer{&scene.materials()}, scene.base_color(draw.material)});
            commands.push(masked_, raster::shared::CasterPush{draw.material});
            bound = &masked_;
        } else if (bound != &opaque_) {
            commands.bind(opaque_, {});
            bound = &opaque_;
        }
        vkCmdDrawIndexed(commands.handle(), draw.index_count, draw.slot_count, draw.first_index,
                         static_cast<std::int32_t>(draw.first_vertex), draw.first_slot);
    }
}

}  // namespace gnomon
