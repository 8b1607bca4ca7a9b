#include "paraboloid_map.h"

#include "base/check.h"
#include "dual_paraboloid.frag.spv.h"
#include "dual_paraboloid.shared.h"
#include "dual_paraboloid.tesc.spv.h"
#include "dual_paraboloid.tese.spv.h"
#include "dual_paraboloid.vert.spv.h"
#include "dual_paraboloid_masked.frag.spv.h"
#include "dual_paraboloid_masked.tese.spv.h"

#include <array>

namespace gnomon::dual_paraboloid {

namespace {

constexpr VkFormat kMapFormat = VK_FORMAT_D32_SFLOAT;

gpu::Pipeline caster_pipeline(const gpu::Device& device, bool masked) {
    gpu::GraphicsPipelineInfo info;
    info.vertex = shaders::dual_paraboloid_vert;
    info.tessellation_control = shaders::dual_paraboloid_tesc;
    info.layout.push_bytes = sizeof(shared::LayerPush);
    if (masked) {
        using enum gpu::BindingType;
        info.tessellation_evaluation = shaders::dual_paraboloid_masked_tese;
        info.fragment = shaders::dual_paraboloid_masked_frag;
        info.layout.bindings = {storage_buffer, storage_buffer, texture};
    } else {
        info.tessellation_evaluation = shaders::dual_paraboloid_tese;
        info.fragment = shaders::dual_paraboloid_frag;
    }
    info.depth_format = kMapFormat;
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

const gpu::Device& tessellating(const gpu::Device& device) {
    if (!device.tessellates()) {
        fail_machine(
            "dual_paraboloid: device \"{}\" lacks tessellation with clip distances; use omni",
            device.info().name);
    }
    return device;
}

}  // namespace

ParaboloidMap::ParaboloidMap(const gpu::Device& device, bool subdivide)
    : device_(tessellating(device)),
      subdivide_(subdivide),
      opaque_(caster_pipeline(device, false)),
      masked_(caster_pipeline(device, true)) {}

void ParaboloidMap::record(gpu::Commands& commands, const raster::GpuScene& scene,
                           const ParaboloidView& view, std::span<const LayerCasters> layers,
                           bool ignore_alpha) {
    make_image(view.size_texels, static_cast<unsigned>(layers.size()));
    upload_matrices(commands, scene, view);
    commands.use(image_, gpu::Use::depth_target);
    for (std::size_t i = 0; i < layers.size(); ++i) {
        if (!layers[i].needed) continue;
        commands.begin_drawing(
            {.depth = &image_, .layer = static_cast<int>(i), .size = image_.size()});
        draw(commands, scene, view, layers[i], ignore_alpha);
        commands.end_drawing();
    }
    commands.use(image_, gpu::Use::sampled);
}

void ParaboloidMap::make_image(unsigned size_texels, unsigned layers) {
    const Extent size{size_texels, size_texels};
    if (image_ && image_.size() == size && image_.info().layers == layers) return;
    image_ = gpu::Image(
        device_, {.size = size,
                  .format = kMapFormat,
                  .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                  .layers = layers,
                  .array = true});
}

void ParaboloidMap::upload_matrices(gpu::Commands& commands, const raster::GpuScene& scene,
                                    const ParaboloidView& view) {
    const glm::dmat4 ls_from_world = view.ls_from_world();
    const std::span<const Instance> instances = scene.scene().instances();
    std::vector<Mat4> ls_from_local;
    for (const raster::Draw& draw : scene.draws()) {
        for (std::uint32_t i = 0; i < draw.slot_count; ++i) {
            const Instance& instance = instances[scene.instance_at(draw.first_slot + i)];
            ls_from_local.emplace_back(ls_from_world * glm::dmat4(instance.world_from_local));
        }
    }
    const std::span<const std::byte> bytes = std::as_bytes(std::span(ls_from_local));
    if (bytes.empty()) return;
    if (!instance_matrices_ || instance_matrices_.size_bytes() < bytes.size()) {
        instance_matrices_ =
            gpu::Buffer(device_, bytes.size(),
                        VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                        gpu::Placement::device);
    }
    commands.update(instance_matrices_, bytes, gpu::Use::vertex_read);
}

// Instances of the same triangles become one draw, and so do neighbouring triangles of one
// instance.
std::vector<ParaboloidMap::CasterDraw> ParaboloidMap::place_casters(const raster::GpuScene& scene,
                                                                    const ParaboloidView& view,
                                                                    const LayerCasters& layer) {
    std::vector<CasterDraw> draws;
    for (const raster::Draw& draw : scene.draws()) {
        for (std::uint32_t i = draw.first_part; i < draw.first_part + draw.part_count; ++i) {
            const Box3& bounds_ws = scene.part_bounds_ws()[i];
            if (!view.sees(layer.side, bounds_ws) || !layer.casters.holds(bounds_ws)) continue;
            const raster::CasterPart& part = scene.parts()[i];
            const raster::CasterLevel& whole = scene.levels(draw, part).front();
            const CasterDraw next{&draw, part.first_index + 3 * whole.first_triangle,
                                  3 * whole.triangle_count, part.slot, 1};
            if (!draws.empty() && draws.back().draw == &draw) {
                CasterDraw& last = draws.back();
                if (last.slot_count == 1 && next.first_slot == last.first_slot &&
                    next.first_index == last.first_index + last.index_count) {
                    last.index_count += next.index_count;
                    continue;
                }
                if (next.first_index == last.first_index && next.index_count == last.index_count &&
                    next.first_slot == last.first_slot + last.slot_count) {
                    ++last.slot_count;
                    continue;
                }
            }
            draws.push_back(next);
        }
    }
    return draws;
}

void ParaboloidMap::draw(gpu::Commands& commands, const raster::GpuScene& scene,
                         const ParaboloidView& view, const LayerCasters& layer,
                         bool ignore_alpha) const {
    const std::vector<CasterDraw> draws = place_casters(scene, view, layer);
    if (draws.empty()) return;
    const std::array buffers{scene.positions().handle(), instance_matrices_.handle()};
    const std::array<VkDeviceSize, 2> offsets{};
    vkCmdBindVertexBuffers(commands.handle(), 0, 2, buffers.data(), offsets.data());
    vkCmdBindIndexBuffer(commands.handle(), scene.caster_indices().handle(), 0,
                         VK_INDEX_TYPE_UINT32);
    shared::LayerPush push{.side = layer.side == Side::along ? 1.0f : -1.0f,
                           .reach = static_cast<float>(view.reach),
                           .rim = static_cast<float>(view.rim()),
                           .size_texels = static_cast<float>(view.size_texels),
                           .near_m = static_cast<float>(view.near_m)};
    if (subdivide_) {
        push.segments_per_rad = static_cast<float>(segments_per_rad(view.reach, view.size_texels));
    }
    const gpu::Pipeline* bound = nullptr;
    for (const CasterDraw& caster : draws) {
        const raster::Draw& draw = *caster.draw;
        if (draw.masked && !ignore_alpha) {
            commands.bind(
                masked_, {gpu::StorageBuffer{&scene.attributes()},
                          gpu::StorageBuffer{&scene.materials()}, scene.base_color(draw.material)});
            push.material = draw.material;
            commands.push(masked_, push);
            bound = &masked_;
        } else if (bound != &opaque_) {
            commands.bind(opaque_, {});
            commands.push(opaque_, push);
            bound = &opaque_;
        }
        vkCmdDrawIndexed(commands.handle(), caster.index_count, caster.slot_count,
                         caster.first_index, static_cast<std::int32_t>(draw.first_vertex),
                         caster.first_slot);
    }
}

}  // namespace gnomon::dual_paraboloid
