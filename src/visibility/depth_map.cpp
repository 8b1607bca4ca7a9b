#include "visibility/depth_map.h"

#include "caster.vert.spv.h"
#include "caster_masked.frag.spv.h"
#include "caster_masked.vert.spv.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <utility>

namespace gnomon {

namespace {

constexpr VkFormat kDepthMapFormat = VK_FORMAT_D32_SFLOAT;

gpu::Pipeline caster_pipeline(const gpu::Device& device, bool masked, bool clamps_near) {
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
    info.depth_clamp = clamps_near;
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

/// The side of the smallest texel that the box can touch, in metres.
float least_texel_m(const LightFit& fit, const Box3& box) {
    if (fit.affine) {
        const TexelSteps steps = fit.texel_steps();
        return std::min(glm::length(steps.u_ws), glm::length(steps.v_ws));
    }
    float least_m = std::numeric_limits<float>::infinity();
    for (unsigned i = 0; i < 8; ++i) {
        const Vec3 corner((i & 1) != 0 ? box.max.x : box.min.x,
                          (i & 2) != 0 ? box.max.y : box.min.y,
                          (i & 4) != 0 ? box.max.z : box.min.z);
        least_m = std::min(least_m, fit.texel_size_m(corner));
    }
    return least_m;
}

/// The fewest triangles that show the part as the map's texels can.
const raster::CasterLevel& level_for(const MapLayer& layer,
                                     const std::vector<raster::CasterLevel>& levels,
                                     const raster::CasterPart& part, const Box3& bounds_ws) {
    std::size_t chosen = 0;
    if (layer.caster_error_texels > 0.0f && levels.size() > 1) {
        const float error_m = layer.caster_error_texels * least_texel_m(layer.fit, bounds_ws);
        while (chosen + 1 < levels.size() && levels[chosen + 1].error_m * part.scale <= error_m)
            ++chosen;
    }
    return levels[chosen];
}

}  // namespace

DepthMap::DepthMap(const gpu::Device& device)
    : device_(device),
      pipelines_{{{caster_pipeline(device, false, false), caster_pipeline(device, true, false)},
                  {caster_pipeline(device, false, true), caster_pipeline(device, true, true)}}} {}

bool DepthMap::record(gpu::Commands& commands, const raster::GpuScene& scene,
                      std::span<const MapLayer> layers, bool ignore_alpha, bool reuse) {
    const bool is_new =
        make_image(layers.front().fit.size_texels, static_cast<unsigned>(layers.size()));
    clip_from_local_.clear();
    triangles_ = 0;
    Contents contents{.ignore_alpha = ignore_alpha};
    for (const MapLayer& layer : layers) {
        contents.needed.push_back(layer.needed);
        contents.draws.push_back(layer.needed ? place_casters(scene, layer)
                                              : std::vector<CasterDraw>());
    }
    contents.clip_from_local = clip_from_local_;
    if (reuse && !is_new && holds(scene) && contents == drawn_) return false;
    drawn_ = std::move(contents);
    drawn_scene_ = scene.scene().identity();

    upload_matrices(commands, scene.parts().size() * layers.size());
    commands.use(image_, gpu::Use::depth_target);
    for (std::size_t i = 0; i < layers.size(); ++i) {
        if (!layers[i].needed) continue;
        commands.begin_drawing(
            {.depth = &image_, .depth_layer = static_cast<int>(i), .size = image_.size()});
        draw(commands, scene, drawn_.draws[i], layers[i].fit.clamps_near, ignore_alpha);
        commands.end_drawing();
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

std::vector<DepthMap::CasterDraw> DepthMap::place_casters(const raster::GpuScene& scene,
                                                          const MapLayer& layer) {
    const glm::dmat4& from_world = layer.fit.clip_from_world;
    std::vector<CasterDraw> draws;
    for (const raster::Draw& draw : scene.draws()) {
        for (std::uint32_t i = draw.first_part; i < draw.first_part + draw.part_count; ++i) {
            const Box3& bounds_ws = scene.part_bounds_ws()[i];
            if (!layer.casters.holds(bounds_ws)) continue;
            const raster::CasterPart& part = scene.parts()[i];
            const Instance& instance = scene.scene().instances()[scene.instance_at(part.slot)];
            add_part(draws, draw, part, level_for(layer, scene.levels(draw, part), part, bounds_ws),
                     Mat4(from_world * glm::dmat4(instance.world_from_local)));
        }
    }
    return draws;
}

// Instances of the same triangles become one draw, and so do neighbouring triangles of one
// instance.
void DepthMap::add_part(std::vector<CasterDraw>& draws, const raster::Draw& draw,
                        const raster::CasterPart& part, const raster::CasterLevel& level,
                        const Mat4& clip_from_local) {
    const std::uint32_t first_index = part.first_index + 3 * level.first_triangle;
    const std::uint32_t index_count = 3 * level.triangle_count;
    triangles_ += level.triangle_count;
    if (!draws.empty() && draws.back().draw == &draw) {
        CasterDraw& last = draws.back();
        if (part.slot == last.slot && last.instance_count == 1 &&
            first_index == last.first_index + last.index_count) {
            last.index_count += index_count;
            return;
        }
        if (first_index == last.first_index && index_count == last.index_count) {
            last.slot = part.slot;
            ++last.instance_count;
            clip_from_local_.push_back(clip_from_local);
            return;
        }
    }
    draws.push_back({&draw, first_index, index_count,
                     static_cast<std::uint32_t>(clip_from_local_.size()), 1, part.slot});
    clip_from_local_.push_back(clip_from_local);
}

void DepthMap::upload_matrices(gpu::Commands& commands, std::size_t most) {
    if (!instance_matrices_ || instance_matrices_.size_bytes() < most * sizeof(Mat4)) {
        instance_matrices_ =
            gpu::Buffer(device_, most * sizeof(Mat4),
                        VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                        gpu::Placement::device);
    }
    const std::span<const std::byte> bytes = std::as_bytes(std::span(clip_from_local_));
    if (!bytes.empty()) commands.update(instance_matrices_, bytes, gpu::Use::vertex_read);
}

void DepthMap::draw(gpu::Commands& commands, const raster::GpuScene& scene,
                    std::span<const CasterDraw> draws, bool clamps_near, bool ignore_alpha) const {
    const Pipelines& pipelines = pipelines_[clamps_near ? 1 : 0];
    const std::array buffers{scene.positions().handle(), instance_matrices_.handle()};
    const std::array<VkDeviceSize, 2> offsets{};
    vkCmdBindVertexBuffers(commands.handle(), 0, 2, buffers.data(), offsets.data());
    vkCmdBindIndexBuffer(commands.handle(), scene.caster_indices().handle(), 0,
                         VK_INDEX_TYPE_UINT32);
    const gpu::Pipeline* bound = nullptr;
    for (const CasterDraw& caster : draws) {
        const raster::Draw& draw = *caster.draw;
        if (draw.masked && !ignore_alpha) {
            commands.bind(pipelines.masked, {gpu::StorageBuffer{&scene.attributes()},
                                             gpu::StorageBuffer{&scene.materials()},
                                             scene.base_color(draw.material)});
            commands.push(pipelines.masked, raster::shared::CasterPush{draw.material});
            bound = &pipelines.masked;
        } else if (bound != &pipelines.opaque) {
            commands.bind(pipelines.opaque, {});
            bound = &pipelines.opaque;
        }
        vkCmdDrawIndexed(commands.handle(), caster.index_count, caster.instance_count,
                         caster.first_index, static_cast<std::int32_t>(draw.first_vertex),
                         caster.first_instance);
    }
}

}  // namespace gnomon
