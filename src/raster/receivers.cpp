#include "raster/receivers.h"

#include "normal.comp.spv.h"
#include "receiver.frag.spv.h"
#include "receiver.vert.spv.h"
#include "receiver_masked.frag.spv.h"
#include "surface.frag.spv.h"
#include "surface.vert.spv.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/matrix.hpp>

namespace gnomon::raster {

namespace {

constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT_S8_UINT;
constexpr VkFormat kIdFormat = VK_FORMAT_R32G32_UINT;
constexpr VkFormat kNormalFormat = VK_FORMAT_R32_UINT;
constexpr VkFormat kAlbedoFormat = VK_FORMAT_R8G8B8A8_SRGB;
constexpr VkFormat kGlossFormat = VK_FORMAT_R16G16B16A16_SFLOAT;
constexpr unsigned kGroupSize = 8;

gpu::Pipeline receiver_pipeline(const gpu::Device& device, bool masked) {
    gpu::GraphicsPipelineInfo info;
    if (masked) {
        info.vertex = shaders::surface_vert;
        info.fragment = shaders::receiver_masked_frag;
        info.layout = material_layout();
    } else {
        info.vertex = shaders::receiver_vert;
        info.fragment = shaders::receiver_frag;
        info.layout = opaque_layout();
    }
    info.color_formats = {kIdFormat};
    info.depth_format = kDepthFormat;
    set_position_input(info);
    return gpu::Pipeline(device, info);
}

gpu::Pipeline normal_pipeline(const gpu::Device& device) {
    using enum gpu::BindingType;
    return gpu::Pipeline(
        device, gpu::ComputePipelineInfo{.code = shaders::normal_comp,
                                         .layout = {{storage_buffer, storage_buffer, storage_buffer,
                                                     storage_buffer, storage_image, storage_image},
                                                    sizeof(shared::NormalPush)}});
}

void allocate(const gpu::Device& device, Extent size, SeenIds& out) {
    if (out.depth && out.depth.size() == size) return;
    out.depth =
        gpu::Image(device, {.size = size,
                            .format = kDepthFormat,
                            .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT |
                                     VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    out.ids =
        gpu::Image(device, {.size = size,
                            .format = kIdFormat,
                            .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                     VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
}

shared::NormalPush normal_push(const Camera& camera, Extent size) {
    const bool perspective = camera.ortho_height_m == 0.0f;
    const Mat4 world_from_view = glm::inverse(camera.view_from_world);
    return {.eye_ws = Vec3(perspective ? world_from_view[3] : world_from_view[2]),
            .perspective = perspective ? 1.0f : 0.0f,
            .size = {size.width, size.height}};
}

}  // namespace

Mat4 Receivers::world_from_clip() const {
    // In double: the projection of a far scene is nearly singular in float.
    return Mat4(
        glm::inverse(glm::dmat4(camera.clip_from_view(size)) * glm::dmat4(camera.view_from_world)));
}

Mat4 Receivers::eye_from_clip() const {
    glm::dmat4 view(camera.view_from_world);
    view[3] = view * glm::dvec4(DVec3(camera.eye_ws()), 1.0);
    return Mat4(glm::inverse(glm::dmat4(camera.clip_from_view(size)) * view));
}

IdPass::IdPass(const gpu::Device& device)
    : device_(device),
      opaque_(receiver_pipeline(device, false)),
      masked_(receiver_pipeline(device, true)) {}

void IdPass::record(gpu::Commands& commands, const GpuScene& scene, const Mat4& clip_from_world,
                    Extent size, bool ignore_alpha, bool hide_backs, SeenIds& out) {
    allocate(device_, size, out);
    commands.use(out.depth, gpu::Use::depth_target);
    commands.use(out.ids, gpu::Use::color_target);
    commands.begin_drawing({.colors = {&out.ids},
                            .depth = &out.depth,
                            .size = size,
                            .clear_stencil = true,
                            .clear_value = {.uint32 = {kNoReceiver, 0, 0, 0}}});
    draw_scene(commands, scene, {.opaque = &opaque_, .masked = &masked_, .hide_backs = hide_backs},
               clip_from_world, ignore_alpha);
    commands.end_drawing();
}

ReceiverPass::ReceiverPass(const gpu::Device& device)
    : device_(device), ids_(device), normal_(normal_pipeline(device)) {}

void ReceiverPass::record(gpu::Commands& commands, const GpuScene& scene, const Camera& camera,
                          Extent size, bool ignore_alpha, Receivers& out) {
    const gpu::Pass pass(commands, "receivers");
    if (!out.normals || out.size != size) {
        out.normals = gpu::Image(
            device_, {.size = size,
                      .format = kNormalFormat,
                      .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    }
    out.size = size;
    out.camera = camera;
    ids_.record(commands, scene, camera.clip_from_world(size), size, ignore_alpha, true, out);

    commands.use(out.ids, gpu::Use::storage_read);
    commands.use(out.normals, gpu::Use::storage_write);
    commands.bind(normal_,
                  {gpu::StorageBuffer{&scene.instances()}, gpu::StorageBuffer{&scene.slots()},
                   gpu::StorageBuffer{&scene.positions()}, gpu::StorageBuffer{&scene.indices()},
                   gpu::StorageImage{out.ids.view()}, gpu::StorageImage{out.normals.view()}});
    commands.push(normal_, normal_push(camera, size));
    commands.dispatch(size, kGroupSize);
    commands.use(out.normals, gpu::Use::storage_read);
    commands.use(out.depth, gpu::Use::sampled);
}

SurfacePass::SurfacePass(const gpu::Device& device) : device_(device) {
    gpu::GraphicsPipelineInfo info;
    info.vertex = shaders::surface_vert;
    info.fragment = shaders::surface_frag;
    info.layout = material_layout();
    info.color_formats = {kAlbedoFormat, kGlossFormat};
    info.depth_format = kDepthFormat;
    info.depth_write = false;
    info.depth_compare = VK_COMPARE_OP_EQUAL;
    set_position_input(info);
    surface_ = gpu::Pipeline(device, info);
}

void SurfacePass::record(gpu::Commands& commands, const GpuScene& scene, Receivers& receivers,
                         Surfaces& out) {
    const gpu::Pass pass(commands, "surfaces");
    const Extent size = receivers.size;
    if (!out.albedo || out.albedo.size() != size) {
        constexpr VkImageUsageFlags kUsage =
            VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
        out.albedo = gpu::Image(device_, {.size = size, .format = kAlbedoFormat, .usage = kUsage});
        out.normal_gloss =
            gpu::Image(device_, {.size = size, .format = kGlossFormat, .usage = kUsage});
    }
    commands.use(receivers.depth, gpu::Use::depth_test);
    commands.use(out.albedo, gpu::Use::color_target);
    commands.use(out.normal_gloss, gpu::Use::color_target);
    commands.begin_drawing({.colors = {&out.albedo, &out.normal_gloss},
                            .depth = &receivers.depth,
                            .size = size,
                            .clear_depth = false});
    draw_scene(commands, scene, {.surface = &surface_, .hide_backs = true},
               receivers.camera.clip_from_world(size), true);
    commands.end_drawing();
    commands.use(receivers.depth, gpu::Use::sampled);
    commands.use(out.albedo, gpu::Use::sampled);
    commands.use(out.normal_gloss, gpu::Use::sampled);
}

}  // namespace gnomon::raster
