#include <gnomon/lighting.h>
#include <gnomon/vertex_lighting.h>

#include "base/check.h"
#include "compose.comp.spv.h"
#include "lighting/exposure.h"
#include "lighting/lighting.shared.h"
#include "lighting/vertex_lights.h"
#include "shade.comp.spv.h"
#include "shade_vertices.comp.spv.h"
#include "visibility/light_shape.h"
#include "visibility/visibility_impl.h"

#include <glm/matrix.hpp>

#include <cmath>
#include <cstring>

namespace gnomon {

namespace {

constexpr unsigned kGroupSize = 8;

shared::ShadeFrame shade_frame(const raster::Receivers& receivers, const Light& light, bool first) {
    const Camera& camera = receivers.camera;
    const bool perspective = camera.ortho_height_m == 0.0f;
    const Mat4 world_from_view = glm::inverse(camera.view_from_world);
    shared::ShadeFrame frame{.world_from_clip = receivers.world_from_clip(),
                             .eye_ws = Vec3(perspective ? world_from_view[3] : world_from_view[2]),
                             .perspective = perspective ? 1.0f : 0.0f,
                             .light = light_shape(light),
                             .strength = light_strength(light),
                             .spot_axis = Vec3(0.0f),
                             .spot_scale = 0.0f,
                             .spot_offset = 1.0f,
                             .first = first ? 1u : 0u,
                             .size = {receivers.size.width, receivers.size.height}};
    frame.emits_one_side = frame.light.kind >= shared::kLightDisc ? 1.0f : 0.0f;
    if (const auto* spot = std::get_if<SpotLight>(&light)) {
        // KHR_lights_punctual's falloff between the two cones.
        const float inner = std::cos(spot->inner_angle_rad);
        const float outer = std::cos(spot->outer_angle_rad);
        frame.spot_axis = spot->direction_ws;
        frame.spot_scale = 1.0f / std::max(inner - outer, 1e-4f);
        frame.spot_offset = -outer * frame.spot_scale;
    }
    return frame;
}

/// One picture's worth of device work.
class Painter {
public:
    Painter(Context::Impl& context, const Frame& frame)
        : context_(context), frame_(frame), receivers_(context.receivers(frame)) {
        const gpu::Device& device = context.device();
        using enum gpu::BindingType;
        shade_ = gpu::Pipeline(device,
                               {.code = shaders::shade_comp,
                                .layout = {{texture, storage_image, texture, texture, storage_image,
                                            storage_image, storage_image, uniform_buffer}}});
        compose_ = gpu::Pipeline(
            device, {.code = shaders::compose_comp,
                     .layout = {{texture, texture, storage_image, storage_image, storage_image},
                                sizeof(shared::ComposePush)}});
        nearest_ = gpu::Sampler(device, {});
        shade_frame_ =
            gpu::Buffer(device, sizeof(shared::ShadeFrame),
                        VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                        gpu::Placement::device);
        for (gpu::Image* image : {&lit_, &full_, &picture_}) {
            *image = gpu::Image(
                device, {.size = frame.size,
                         .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                         .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
        }
    }

    void shade(std::span<const LitBy> lights) {
        std::vector<gpu::Image*> seen;
        for (const LitBy& lit : lights) {
            // on_device() may submit an upload of its own.
            seen.push_back(&lit.visibility->impl().on_device());
        }
        gpu::Commands commands = context_.submission().begin();
        context_.surface_pass().record(commands, context_.gpu_scene(frame_.scene),
                                       receivers_->device, surfaces_);
        for (std::size_t i = 0; i < lights.size(); ++i) {
            record_light(commands, lights[i].light, *seen[i], i == 0);
        }
        context_.submission().submit_and_wait();
    }

    /// Instead of what lights shaded, but as bright as these were.
    void shade_vertices(std::span<const shared::VertexShade> shades, bool averaged) {
        const gpu::Device& device = context_.device();
        using enum gpu::BindingType;
        const gpu::Pipeline pipeline(
            device,
            {.code = shaders::shade_vertices_comp,
             .layout = {{texture, storage_image, texture, texture, storage_image, storage_buffer},
                        sizeof(shared::VertexPush)}});
        gpu::Buffer buffer = gpu::make_buffer(device, shades, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        gpu::Commands commands = context_.submission().begin();
        commands.use(buffer, gpu::Use::storage_read);
        commands.use(lit_, gpu::Use::storage_write);
        commands.bind(pipeline, {gpu::Texture{receivers_->device.depth.view(), &nearest_},
                                 gpu::StorageImage{receivers_->device.normals.view()},
                                 gpu::Texture{surfaces_.albedo.view(), &nearest_},
                                 gpu::Texture{surfaces_.normal_gloss.view(), &nearest_},
                                 gpu::StorageImage{lit_.view()}, gpu::StorageBuffer{&buffer}});
        commands.push(pipeline,
                      shared::VertexPush{.size = {frame_.size.width, frame_.size.height},
                                         .most_factor = averaged ? kMostBumpFactor : 0.0f});
        commands.dispatch(frame_.size, kGroupSize);
        context_.submission().submit_and_wait();
    }

    std::vector<Vec4> read_full() { return read(full_); }

    Image compose(const LightingOptions& options, Vec3 ambient, float exposure) {
        gpu::Commands commands = context_.submission().begin();
        commands.use(lit_, gpu::Use::storage_read);
        commands.use(full_, gpu::Use::storage_read);
        commands.use(picture_, gpu::Use::storage_write);
        commands.bind(compose_, {gpu::Texture{receivers_->device.depth.view(), &nearest_},
                                 gpu::Texture{surfaces_.albedo.view(), &nearest_},
                                 gpu::StorageImage{lit_.view()}, gpu::StorageImage{full_.view()},
                                 gpu::StorageImage{picture_.view()}});
        commands.push(
            compose_,
            shared::ComposePush{.ambient = ambient,
                                .exposure = exposure,
                                .background_srgb = options.background_srgb,
                                .subtractive = options.compose == Compose::subtractive ? 1u : 0u,
                                .size = {frame_.size.width, frame_.size.height}});
        commands.dispatch(frame_.size, kGroupSize);
        context_.submission().submit_and_wait();
        const std::vector<Vec4> pixels = read(picture_);
        Image picture(frame_.size, 3);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            for (int c = 0; c < 3; ++c) {
                picture.pixels()[3 * i + static_cast<std::size_t>(c)] = pixels[i][c];
            }
        }
        return picture;
    }

private:
    void record_light(gpu::Commands& commands, const Light& light, gpu::Image& seen, bool first) {
        commands.update(shade_frame_, shade_frame(receivers_->device, light, first));
        commands.use(seen, gpu::Use::storage_read);
        commands.use(lit_, gpu::Use::storage_write);
        commands.use(full_, gpu::Use::storage_write);
        commands.bind(shade_, {gpu::Texture{receivers_->device.depth.view(), &nearest_},
                               gpu::StorageImage{receivers_->device.normals.view()},
                               gpu::Texture{surfaces_.albedo.view(), &nearest_},
                               gpu::Texture{surfaces_.normal_gloss.view(), &nearest_},
                               gpu::StorageImage{seen.view()}, gpu::StorageImage{lit_.view()},
                               gpu::StorageImage{full_.view()}, gpu::UniformBuffer{&shade_frame_}});
        commands.dispatch(frame_.size, kGroupSize);
    }

    std::vector<Vec4> read(gpu::Image& image) {
        std::vector<Vec4> pixels(static_cast<std::size_t>(frame_.size.width) * frame_.size.height);
        const std::uint64_t bytes = pixels.size() * sizeof(Vec4);
        gpu::Buffer staging(context_.device(), bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                            gpu::Placement::readback);
        gpu::Commands commands = context_.submission().begin();
        commands.use(image, gpu::Use::copy_source);
        commands.use(staging, gpu::Use::copy_target);
        commands.copy(image, staging);
        commands.use(staging, gpu::Use::host_read);
        context_.submission().submit_and_wait();
        std::memcpy(pixels.data(), staging.mapped(), bytes);
        return pixels;
    }

    Context::Impl& context_;
    const Frame& frame_;
    std::shared_ptr<FrameReceivers> receivers_;
    raster::Surfaces surfaces_;
    gpu::Pipeline shade_, compose_;
    gpu::Sampler nearest_;
    gpu::Buffer shade_frame_;
    gpu::Image lit_, full_, picture_;
};

void check(const LightingOptions& options) {
    if (!std::isfinite(options.exposure) || options.exposure < 0.0f) {
        fail_input("light_picture: exposure is {}; it must be 0 (automatic) or above",
                   options.exposure);
    }
    for (const float ambient : {options.ambient.x, options.ambient.y, options.ambient.z}) {
        if (std::isfinite(ambient)) continue;
        fail_input("light_picture: ambient is {}; it must be finite", ambient);
    }
}

/// Of one value everywhere.
Visibility even_visibility(Context& context, Extent size, float value) {
    Visibility even;
    for (float& v : even.impl().host_target(context.impl(), size).pixels())
        v = value;
    return even;
}

Image composed(Painter& painter, const LightingOptions& options) {
    const lighting::LightLevel level = lighting::measure(painter.read_full());
    const Vec3 ambient =
        options.ambient.x < 0.0f ? lighting::default_ambient(level) : options.ambient;
    const float exposure =
        options.exposure > 0.0f ? options.exposure : lighting::default_exposure(level, ambient);
    return painter.compose(options, ambient, exposure);
}

/// Ambient light alone has a light that is dark, too.
Light no_light() {
    return DirectionalLight{.irradiance = Vec3(0.0f)};
}

}  // namespace

Image light_picture(Context& context, const Frame& frame, std::span<const LitBy> lights,
                    const LightingOptions& options) {
    frame.validate();
    for (const LitBy& lit : lights) {
        if (lit.visibility == nullptr || lit.visibility->size() != frame.size) {
            fail_input("light_picture: the visibility of \"{}\" is not of the frame's size, {}x{}",
                       light_name(lit.light), frame.size.width, frame.size.height);
        }
    }
    check(options);
    const Visibility none = even_visibility(context, frame.size, 0.0f);
    std::vector<LitBy> shaded(lights.begin(), lights.end());
    if (shaded.empty()) shaded.push_back({no_light(), &none});
    Painter painter(context.impl(), frame);
    painter.shade(shaded);
    return composed(painter, options);
}

Image vertex_lit_picture(Context& context, const Frame& frame, const VertexLighting& lighting,
                         std::span<const Light> lights, const LightingOptions& options,
                         VertexShading shading) {
    frame.validate();
    check(options);
    if (options.compose == Compose::subtractive) {
        fail_input(
            "vertex_lit_picture: compose is subtractive, which darkens by visibility; vertices "
            "keep "
            "light: take additive");
    }
    if (!same(frame.scene.identity(), lighting.impl().scene().identity())) {
        fail_input("vertex_lit_picture: frame.scene is \"{}\"; vertices were traced in \"{}\"",
                   frame.scene.source(), lighting.impl().scene().source());
    }
    lighting.impl().check(lights);
    const Visibility all = even_visibility(context, frame.size, 1.0f);
    std::vector<LitBy> shaded;
    for (const Light& light : lights)
        shaded.push_back({light, &all});
    if (shaded.empty()) shaded.push_back({no_light(), &all});
    Painter painter(context.impl(), frame);
    painter.shade(shaded);
    Progress silent;
    const std::shared_ptr<FrameReceivers> receivers = context.impl().receiver_points(frame, silent);
    painter.shade_vertices(lighting.impl().at(receivers->points, lights),
                           shading == VertexShading::averaged);
    return composed(painter, options);
}

}  // namespace gnomon
