#include "raster/texture_upload.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace gnomon::raster {

namespace {

VkSamplerAddressMode address_mode(TextureWrap wrap) {
    switch (wrap) {
        case TextureWrap::mirror:
            return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
        case TextureWrap::clamp:
            return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
        case TextureWrap::repeat:
            break;
    }
    return VK_SAMPLER_ADDRESS_MODE_REPEAT;
}

/// Moves one mip level from being written to being read; the image as a whole then is copy_source.
void finish_level(const gpu::Commands& commands, const gpu::Image& image, std::uint32_t level) {
    const VkImageMemoryBarrier2 barrier{
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT | VK_PIPELINE_STAGE_2_BLIT_BIT,
        .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
        .dstStageMask = VK_PIPELINE_STAGE_2_BLIT_BIT,
        .dstAccessMask = VK_ACCESS_2_TRANSFER_READ_BIT,
        .oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
        .newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image.handle(),
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, level, 1, 0, 1}};
    const VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                      .imageMemoryBarrierCount = 1,
                                      .pImageMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands.handle(), &dependency);
}

VkOffset3D level_corner(Extent size, std::uint32_t level) {
    return {static_cast<std::int32_t>(std::max(1u, size.width >> level)),
            static_cast<std::int32_t>(std::max(1u, size.height >> level)), 1};
}

void make_levels(const gpu::Commands& commands, gpu::Image& image) {
    for (std::uint32_t level = 1; level < image.info().mip_levels; ++level) {
        finish_level(commands, image, level - 1);
        const VkImageBlit blit{.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level - 1, 0, 1},
                               .srcOffsets = {{}, level_corner(image.size(), level - 1)},
                               .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1},
                               .dstOffsets = {{}, level_corner(image.size(), level)}};
        vkCmdBlitImage(commands.handle(), image.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                       image.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit,
                       VK_FILTER_LINEAR);
    }
    finish_level(commands, image, image.info().mip_levels - 1);
    image.use = gpu::Use::copy_source;
}

}  // namespace

gpu::Image upload_texture(const gpu::Device& device, const gnomon::Texture& texture) {
    gpu::Image image(device,
                     {.size = texture.size,
                      .format = VK_FORMAT_R8G8B8A8_SRGB,
                      .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                               VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                      .mip_levels = static_cast<unsigned>(
                          std::bit_width(std::max(texture.size.width, texture.size.height)))});
    gpu::Buffer staging(device, texture.rgba.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                        gpu::Placement::upload);
    std::memcpy(staging.mapped(), texture.rgba.data(), texture.rgba.size());
    gpu::Submission submission(device);
    gpu::Commands commands = submission.begin();
    commands.use(image, gpu::Use::copy_target);
    commands.copy(staging, image);
    make_levels(commands, image);
    commands.use(image, gpu::Use::sampled);
    submission.submit_and_wait();
    return image;
}

gpu::Sampler texture_sampler(const gpu::Device& device, const gnomon::Texture& texture) {
    return gpu::Sampler(device, {.filter = VK_FILTER_LINEAR,
                                 .wrap_u = address_mode(texture.wrap_u),
                                 .wrap_v = address_mode(texture.wrap_v),
                                 .mip_levels = true});
}

}  // namespace gnomon::raster
