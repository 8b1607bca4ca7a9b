#include "visibility/depth_map.h"

#include "caster.vert.spv.h"
#include "caster_id.frag.spv.h"
#include "caster_id.vert.spv.h"
#include "caster_id_masked.frag.spv.h"
#include "caster_id_masked.vert.spv.h"
#include "caster_layered.vert.spv.h"
#include "caster_masked.frag.spv.h"
#include "caster_masked.vert.spv.h"
#include "caster_masked_layered.vert.spv.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <span>
#include <utility>

namespace gnomon {

namespace {

constexpr VkFormat kDepthMapFormat = VK_FORMAT_D32_SFLOAT;
constexpr VkFormat kIdFormat = VK_FORMAT_R32_UINT;

/// Of maps that are reused.
constexpr VkImageUsageFlags kCopied =
    VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;

/// Of a layer that moves, drawn one by one.
constexpr std::size_t kMostStrips = 2;

/// Share of a layer: where less stays, copying it saves little.
constexpr double kLeastKept = 0.5;

/// Share of a layer: where boxes around casters hold less, a software device clears it faster in
/// rows, by itself, than in tiles as it draws. Other devices clear as they draw.
constexpr double kSparse = 0.5;

/// What a pipeline for casters depends on.
struct CasterState {
    bool clamps_near = true, layered = false, positions_only = true, ids = false;
};

void set_shaders(gpu::GraphicsPipelineInfo& info, bool masked, const CasterState& state) {
    using Code = std::span<const std::uint32_t>;
    if (!masked) {
        info.vertex = state.layered ? Code(shaders::caster_layered_vert) : shaders::caster_vert;
        if (state.ids) info.vertex = shaders::caster_id_vert;
        if (state.ids) info.fragment = shaders::caster_id_frag;
        return;
    }
    using enum gpu::BindingType;
    info.vertex =
        state.layered ? Code(shaders::caster_masked_layered_vert) : shaders::caster_masked_vert;
    if (state.ids) info.vertex = shaders::caster_id_masked_vert;
    info.fragment = state.ids ? Code(shaders::caster_id_masked_frag) : shaders::caster_masked_frag;
    info.layout = {{storage_buffer, storage_buffer, texture}, sizeof(raster::shared::CasterPush)};
}

gpu::Pipeline caster_pipeline(const gpu::Device& device, bool masked, const CasterState& state) {
    gpu::GraphicsPipelineInfo info;
    set_shaders(info, masked, state);
    info.depth_format = kDepthMapFormat;
    if (state.ids) info.color_formats = {kIdFormat};
    info.depth_clamp = state.clamps_near;
    raster::set_position_input(info);
    if (!state.positions_only) info.vertex_stride = sizeof(raster::WholeVertex);
    info.instance_stride = sizeof(CasterInstance);
    for (std::uint32_t column = 0; column < 4; ++column) {
        info.attributes.push_back({.location = 1 + column,
                                   .binding = 1,
                                   .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                   .offset = column * static_cast<std::uint32_t>(sizeof(Vec4))});
    }
    const auto add_number = [&](std::uint32_t location, std::size_t offset) {
        info.attributes.push_back({.location = location,
                                   .binding = 1,
                                   .format = VK_FORMAT_R32_UINT,
                                   .offset = static_cast<std::uint32_t>(offset)});
    };
    if (state.layered) add_number(5, offsetof(CasterInstance, layer));
    if (state.ids) add_number(6, offsetof(CasterInstance, object));
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

VkRect2D area_of(const TexelRect& texels) {
    return {{texels.x, texels.y}, {texels.width, texels.height}};
}

bool clears_in_rows(const gpu::Device& device) {
    return device.info().type == DeviceType::cpu;
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
    assert(!options.ids || (!options.reuse && !options.layered));
    make_image(layers.front().fit.size_texels, static_cast<unsigned>(layers.size()), options.reuse);
    make_ids(options.ids);
    make_buffers(scene.parts().size() * layers.size() * (options.reuse ? kMostStrips : 1));
    make_vertices(commands, scene.scene(), options);
    keep_what_holds(scene, options);
    plan(scene, layers, options);
    if (passes_.empty() && moves_.empty() && patches_.empty() && image_.use == gpu::Use::sampled)
        return false;

    move(commands);
    upload(commands);
    draw_passes(commands, scene, options);
    draw_patches(commands, scene, options);
    commands.use(image_, gpu::Use::sampled);
    commands.use(ids_, gpu::Use::sampled);
    return true;
}

void DepthMap::keep_what_holds(const raster::GpuScene& scene, const CasterOptions& options) {
    if (!options.reuse) moving_.clear();
    const bool holds = options.reuse && moving_.follow(scene.scene()) &&
                       options.ignore_alpha == held_ignores_alpha_;
    if (!holds) held_.assign(held_.size(), {});
    held_ignores_alpha_ = options.ignore_alpha;
    make_still_image();
}

void DepthMap::make_image(unsigned size_texels, unsigned layers, bool reuse) {
    const Extent size{size_texels, size_texels};
    VkImageUsageFlags usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT |
                              VK_IMAGE_USAGE_SAMPLED_BIT | (reuse ? kCopied : 0);
    if (clears_in_rows(device_)) usage |= VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    if (image_ && image_.size() == size && image_.info().layers == layers &&
        image_.info().usage == usage) {
        return;
    }
    held_.assign(layers, {});
    still_ = gpu::Image();
    image_ = gpu::Image(
        device_,
        {.size = size, .format = kDepthMapFormat, .usage = usage, .layers = layers, .array = true});
    scratch_ = gpu::Image();
    if (!reuse) return;
    scratch_ = gpu::Image(device_, {.size = size, .format = kDepthMapFormat, .usage = usage});
}

void DepthMap::make_ids(bool wanted) {
    const Extent size = wanted ? image_.size() : Extent{1, 1};
    const unsigned layers = wanted ? image_.info().layers : 1;
    if (ids_ && ids_.size() == size && ids_.info().layers == layers) return;
    ids_ = gpu::Image(device_,
                      {.size = size,
                       .format = kIdFormat,
                       .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                       .layers = layers,
                       .array = true});
}

void DepthMap::make_still_image() {
    if (moving_.empty()) still_ = gpu::Image();
    if (moving_.empty() || still_) return;
    gpu::ImageInfo info = image_.info();
    info.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | kCopied;
    still_ = gpu::Image(device_, info);
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

void DepthMap::make_vertices(gpu::Commands& commands, const Scene& scene,
                             const CasterOptions& options) {
    if (options.positions_only || (vertices_ && same(vertices_of_, scene.contents_identity())))
        return;
    const std::vector<raster::WholeVertex> vertices = raster::whole_vertices(scene);
    const auto bytes = std::as_bytes(std::span(vertices));
    vertices_ = gpu::Buffer(device_, bytes.size(),
                            VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                            gpu::Placement::device);
    vertices_of_ = scene.contents_identity();
    commands.update(vertices_, bytes, gpu::Use::vertex_read);
}

void DepthMap::plan(const raster::GpuScene& scene, std::span<const MapLayer> layers,
                    const CasterOptions& options) {
    casters_.clear();
    passes_.clear();
    patches_.clear();
    moves_.clear();
    texels_ = 0;
    const TexelRect whole = whole_map(layers.front().fit.size_texels);
    for (unsigned i = 0; i < layers.size(); ++i) {
        const MapLayer& layer = layers[i];
        if (!layer.needed) continue;
        const std::optional<MapScroll> scrolled = what_stays(layer, i);
        if (scrolled) {
            if (!scrolled->comes.empty()) moves_.push_back({i, *scrolled});
            for (const TexelRect& strip : scrolled->comes)
                place_casters(scene, layer, i, options, strip);
            held_[i]->fit = scrolled->fit;
        } else {
            place_casters(scene, layer, i, options, whole);
            held_[i] = {layer.fit, layer.caster_error_texels, layer.faces, {}};
        }
        if (!moving_.empty())
            place_moving(scene, layer, i, options, !scrolled || !scrolled->comes.empty());
    }
    const bool all_are_whole = moves_.empty() && passes_.size() == layers.size();
    if (options.layered && device_.optional().layered_output && all_are_whole && agree(layers))
        join_passes();
    for (Pass& pass : passes_)
        sort_by_state(pass.draws);
    for (Patch& patch : patches_)
        sort_by_state(patch.draws);
}

void DepthMap::join_passes() {
    Pass& all = passes_.front();
    all.layer = -1;
    all.is_cleared = false;
    for (const Pass& pass : std::span(passes_).subspan(1))
        all.draws.insert(all.draws.end(), pass.draws.begin(), pass.draws.end());
    passes_.resize(1);
}

std::optional<MapScroll> DepthMap::what_stays(const MapLayer& layer, unsigned index) const {
    const std::optional<Held>& held = held_[index];
    if (!held || held->caster_error_texels != layer.caster_error_texels ||
        held->faces != layer.faces) {
        return {};
    }
    std::optional<MapScroll> scrolled = scroll(held->fit, layer.fit);
    const double whole = static_cast<double>(whole_map(layer.fit.size_texels).area());
    if (scrolled && static_cast<double>(scrolled->stays.area()) < kLeastKept * whole) return {};
    return scrolled;
}

void DepthMap::place_casters(const raster::GpuScene& scene, const MapLayer& layer, unsigned index,
                             const CasterOptions& options, const TexelRect& texels) {
    MapLayer part = layer;
    const bool is_whole = texels == whole_map(layer.fit.size_texels);
    if (!is_whole) part.casters.keep_within(layer.fit, texels);
    const std::uint64_t boxed_before = casters_.boxed_texels();
    passes_.push_back({static_cast<int>(index), layer.fit.clamps_near, texels,
                       casters_.add(scene, part, index, options, moving_.still())});
    const auto boxed = static_cast<double>(casters_.boxed_texels() - boxed_before);
    passes_.back().is_cleared =
        is_whole && clears_in_rows(device_) && boxed < kSparse * static_cast<double>(texels.area());
    texels_ += texels.area();
}

// With the fit that the layer holds: while it rests, each caster covers the same texels in every
// frame, and one that rests is drawn over itself where another one passes it.
void DepthMap::place_moving(const raster::GpuScene& scene, const MapLayer& layer, unsigned index,
                            const CasterOptions& options, bool whole) {
    Held& held = *held_[index];
    MapLayer part = layer;
    part.fit = held.fit;
    std::vector<TexelRect> texels{whole_map(held.fit.size_texels)};
    if (!whole) texels = moving_.changed(held.fit, held.moving);
    held.moving = moving_.places();
    if (texels.empty()) return;
    for (const TexelRect& rect : texels)
        texels_ += rect.area();
    const std::vector<std::uint8_t> wanted = moving_.reaching(held.fit, texels);
    patches_.push_back(
        {index, held.fit.clamps_near, texels, casters_.add(scene, part, index, options, wanted)});
}

// Through the scratch image, because a copy must not overlap what it reads.
void DepthMap::move(gpu::Commands& commands) {
    gpu::Image& map = kept();
    for (const Move& move : moves_) {
        const TexelRect& to = move.by.stays;
        const Extent size{to.width, to.height};
        const gpu::LayerPlace from{move.layer, {to.x - move.by.x_texels, to.y - move.by.y_texels}};
        commands.use(map, gpu::Use::copy_source);
        commands.use(scratch_, gpu::Use::copy_target);
        commands.copy(map, from, scratch_, {}, size);
        commands.use(scratch_, gpu::Use::copy_source);
        commands.use(map, gpu::Use::copy_target);
        commands.copy(scratch_, {}, map, {move.layer, {to.x, to.y}}, size);
    }
}

void DepthMap::upload(gpu::Commands& commands) {
    std::vector<VkDrawIndexedIndirectCommand> draws;
    for (const Pass& pass : passes_) {
        for (const CasterDraw& draw : pass.draws)
            draws.push_back(command_of(draw));
    }
    for (const Patch& patch : patches_) {
        for (const CasterDraw& draw : patch.draws)
            draws.push_back(command_of(draw));
    }
    if (draws.empty()) return;
    commands.update(instances_, std::as_bytes(std::span(casters_.instances())),
                    gpu::Use::vertex_read);
    commands.update(commands_, std::as_bytes(std::span(draws)), gpu::Use::vertex_read);
}

DepthMap::Pipelines& DepthMap::pipelines(bool clamps_near, bool layered,
                                         const CasterOptions& options) {
    const CasterState state{clamps_near, layered, options.positions_only, options.ids};
    std::optional<Pipelines>& made =
        pipelines_[clamps_near ? 1 : 0][layered ? 1 : 0][options.positions_only ? 1 : 0]
                  [options.ids ? 1 : 0];
    if (!made) {
        made.emplace(Pipelines{caster_pipeline(device_, false, state),
                               caster_pipeline(device_, true, state)});
    }
    return *made;
}

void DepthMap::clear_sparse(gpu::Commands& commands) {
    for (const Pass& pass : passes_) {
        if (pass.is_cleared) commands.clear_depth(kept(), static_cast<unsigned>(pass.layer));
    }
}

void DepthMap::draw_passes(gpu::Commands& commands, const raster::GpuScene& scene,
                           const CasterOptions& options) {
    if (passes_.empty()) return;
    gpu::Image& map = kept();
    clear_sparse(commands);
    commands.use(map, gpu::Use::depth_target);
    std::vector<const gpu::Image*> ids;
    if (options.ids) {
        commands.use(ids_, gpu::Use::color_target);
        ids = {&ids_};
    }
    std::uint64_t first_command = 0;
    for (const Pass& pass : passes_) {
        commands.begin_drawing({.colors = ids,
                                .depth = &map,
                                .layer = pass.layer,
                                .size = map.size(),
                                .area = area_of(pass.texels),
                                .clear_depth = !pass.is_cleared});
        draw(commands, scene, pipelines(pass.clamps_near, pass.layer < 0, options), pass.draws,
             first_command, options);
        commands.end_drawing();
        first_command += pass.draws.size();
    }
}

void DepthMap::draw_patches(gpu::Commands& commands, const raster::GpuScene& scene,
                            const CasterOptions& options) {
    if (patches_.empty()) return;
    std::vector<gpu::LayerArea> areas;
    for (const Patch& patch : patches_) {
        for (const TexelRect& rect : patch.texels)
            areas.push_back({patch.layer, area_of(rect)});
    }
    commands.use(still_, gpu::Use::copy_source);
    commands.use(image_, gpu::Use::copy_target);
    commands.copy(still_, image_, areas);
    commands.use(image_, gpu::Use::depth_target);
    std::uint64_t first_command = 0;
    for (const Pass& pass : passes_)
        first_command += pass.draws.size();
    for (const Patch& patch : patches_) {
        commands.begin_drawing({.depth = &image_,
                                .layer = static_cast<int>(patch.layer),
                                .size = image_.size(),
                                .area = area_of(around(patch.texels)),
                                .clear_depth = false});
        draw(commands, scene, pipelines(patch.clamps_near, false, options), patch.draws,
             first_command, options);
        commands.end_drawing();
        first_command += patch.draws.size();
    }
}

void DepthMap::bind_triangles(gpu::Commands& commands, const raster::GpuScene& scene,
                              const CasterOptions& options) const {
    const gpu::Buffer& vertices = options.positions_only ? scene.positions() : vertices_;
    const gpu::Buffer& indices =
        options.optimised_indices ? scene.caster_indices() : scene.indices();
    const std::array buffers{vertices.handle(), instances_.handle()};
    const std::array<VkDeviceSize, 2> offsets{};
    vkCmdBindVertexBuffers(commands.handle(), 0, 2, buffers.data(), offsets.data());
    vkCmdBindIndexBuffer(commands.handle(), indices.handle(), 0, VK_INDEX_TYPE_UINT32);
}

void DepthMap::draw(gpu::Commands& commands, const raster::GpuScene& scene, const Pipelines& with,
                    std::span<const CasterDraw> draws, std::uint64_t first_command,
                    const CasterOptions& options) {
    const VkCommandBuffer handle = commands.handle();
    bind_triangles(commands, scene, options);
    const bool multi_draw = options.multi_draw && device_.optional().multi_draw;
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
