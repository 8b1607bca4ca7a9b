#include "visibility/depth_map.h"

#include "caster.vert.spv.h"
#include "caster_masked.frag.spv.h"
#include "caster_masked.vert.spv.h"

namespace gnomon {

namespace {

constexpr VkFormat kDepthMapFormat = VK_FORMAT_D32_SFLOAT;

gpu::Pipeline caster_pipeline(const gpu::Device& device, bool masked) {
    gpu::GraphicsPipelineInfo info;
    if (masked) {
        info.vertex = shaders::caster_masked_vert;
        info.fragment = shaders::caster_masked_frag;
        info.layout = raster::material_layout();
    } else {
        info.vertex = shaders::caster_vert;
        info.layout = raster::opaque_layout();
    }
    info.depth_format = kDepthMapFormat;
    info.depth_clamp = true;
    raster::set_position_input(info);
    return gpu::Pipeline(device, info);
}

}  // namespace

DepthMap::DepthMap(const gpu::Device& device)
    : device_(device),
      opaque_(caster_pipeline(device, false)),
      masked_(caster_pipeline(device, true)) {}

void DepthMap::record(gpu::Commands& commands, const raster::GpuScene& scene,
                      const Mat4& clip_from_world, unsigned size_texels, bool ignore_alpha) {
    const Extent size{size_texels, size_texels};
    if (!image_ || image_.size() != size) {
        image_ = gpu::Image(device_, {.size = size,
                                      .format = kDepthMapFormat,
                                      .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT |
                                               VK_IMAGE_USAGE_SAMPLED_BIT});
    }
    commands.use(image_, gpu::Use::depth_target);
    commands.begin_drawing({.depth = &image_, .size = size});
    raster::draw_scene(commands, scene, {.opaque = &opaque_, .masked = &masked_}, clip_from_world,
                       ignore_alpha);
    commands.end_drawing();
    commands.use(image_, gpu::Use::sampled);
}

}  // namespace gnomon
