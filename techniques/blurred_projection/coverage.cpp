#include "coverage.h"

#include "blurred_projection.shared.h"
#include "coverage.comp.spv.h"
#include "presence.frag.spv.h"
#include "presence.vert.spv.h"

namespace gnomon::blurred_projection {

namespace {

constexpr VkFormat kPresenceFormat = VK_FORMAT_R8G8B8A8_UNORM;
/// Halves: what is left of an owner at its rim is divided by.
constexpr VkFormat kCoverageFormat = VK_FORMAT_R16G16B16A16_SFLOAT;
constexpr unsigned kGroupSize = 8;

gpu::Pipeline presence_pipeline(const gpu::Device& device) {
    using enum gpu::BindingType;
    gpu::GraphicsPipelineInfo info;
    info.vertex = shaders::presence_vert;
    info.fragment = shaders::presence_frag;
    info.layout = {{storage_buffer, storage_buffer, storage_buffer, texture, storage_buffer},
                   sizeof(shared::PresencePush)};
    info.color_formats = {kPresenceFormat};
    info.add_colors = true;
    raster::set_position_input(info);
    return gpu::Pipeline(device, info);
}

}  // namespace

Coverage::Coverage(const gpu::Device& device, unsigned owners, float blur_texels)
    : device_(device),
      layers_((owners + shared::kOwnersPerLayer - 1) / shared::kOwnersPerLayer),
      draw_(presence_pipeline(device)),
      nearest_(device, {}),
      blur_(device, blur_texels) {
    using enum gpu::BindingType;
    cover_ = gpu::Pipeline(
        device,
        gpu::ComputePipelineInfo{.code = shaders::coverage_comp,
                                 .layout = {{storage_image, texture, storage_buffer, storage_image},
                                            sizeof(shared::CoveragePush)},
                                 .constants = {}});
}

void Coverage::record(gpu::Commands& commands, const raster::GpuScene& scene, const LightFit& fit,
                      const ObjectMap& map, const gpu::Buffer& owners, bool ignore_alpha) {
    make_images(map.ids().size());
    draw_presence(commands, scene, fit, owners, ignore_alpha);
    commands.use(image_, gpu::Use::storage_write);
    commands.bind(cover_,
                  {gpu::StorageImage{map.ids().view()}, gpu::Texture{presence_.view(), &nearest_},
                   gpu::StorageBuffer{&owners}, gpu::StorageImage{image_.view()}});
    commands.push(cover_, shared::CoveragePush{fit.size_texels, layers_});
    commands.dispatch(image_.size(), kGroupSize);
    blur_.record(commands, image_);
}

void Coverage::make_images(Extent size) {
    if (image_ && image_.size() == size) return;
    presence_ = gpu::Image(
        device_, {.size = size,
                  .format = kPresenceFormat,
                  .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT});
    image_ = gpu::Image(device_, {.size = size,
                                  .format = kCoverageFormat,
                                  .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                                  .layers = layers_,
                                  .array = true});
}

void Coverage::draw_presence(gpu::Commands& commands, const raster::GpuScene& scene,
                             const LightFit& fit, const gpu::Buffer& owners, bool ignore_alpha) {
    commands.use(presence_, gpu::Use::color_target);
    commands.begin_drawing({.colors = {&presence_}, .size = presence_.size()});
    const VkBuffer positions = scene.positions().handle();
    const VkDeviceSize offset = 0;
    vkCmdBindVertexBuffers(commands.handle(), 0, 1, &positions, &offset);
    vkCmdBindIndexBuffer(commands.handle(), scene.indices().handle(), 0, VK_INDEX_TYPE_UINT32);
    for (const raster::Draw& draw : scene.draws()) {
        commands.bind(
            draw_, {gpu::StorageBuffer{&scene.instances()}, gpu::StorageBuffer{&scene.attributes()},
                    gpu::StorageBuffer{&scene.materials()}, scene.base_color(draw.material),
                    gpu::StorageBuffer{&owners}});
        commands.push(draw_,
                      shared::PresencePush{.clip_from_world = Mat4(fit.clip_from_world),
                                           .material = draw.material,
                                           .masked = draw.masked && !ignore_alpha ? 1u : 0u});
        vkCmdDrawIndexed(commands.handle(), draw.index_count, draw.slot_count, draw.first_index,
                         static_cast<std::int32_t>(draw.first_vertex), draw.first_slot);
    }
    commands.end_drawing();
    commands.use(presence_, gpu::Use::sampled);
}

}  // namespace gnomon::blurred_projection
