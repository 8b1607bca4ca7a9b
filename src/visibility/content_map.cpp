#include "visibility/content_map.h"

#include "map_blur.comp.spv.h"
#include "map_content.comp.spv.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <cassert>
#include <cmath>

namespace gnomon {

namespace {

constexpr unsigned kGroupSize = 8;

VkFormat format_of(MapContent content) {
    switch (content) {
        case MapContent::packed:
        case MapContent::packed_two:
            return VK_FORMAT_R8G8B8A8_UNORM;
        case MapContent::variance:
            return VK_FORMAT_R32G32_SFLOAT;
        case MapContent::exponential_variance:
        case MapContent::moments:
            return VK_FORMAT_R32G32B32A32_SFLOAT;
        default:
            return VK_FORMAT_R32_SFLOAT;
    }
}

}  // namespace

shared::MapSpace map_space(const LightFit& fit) {
    shared::MapSpace space{};
    if (!(fit.far_m > 0.0)) return space;
    // x and y of the map are (right - middle * along) / half over the distance along the axis.
    const glm::dmat4 rows = glm::transpose(fit.clip_from_world);
    const DVec3 along(rows[3]);
    glm::dvec2 half, middle;
    for (int axis = 0; axis < 2; ++axis) {
        const DVec3 row(rows[axis]);
        const double on_axis = glm::dot(row, along) / glm::dot(along, along);
        half[axis] = 1.0 / std::sqrt(glm::dot(row, row) - on_axis * on_axis);
        middle[axis] = -on_axis * half[axis];
    }
    space.tangents = Vec4(half.x, half.y, middle.x, middle.y);
    space.reach = static_cast<float>(rows[2].w / fit.far_m);
    return space;
}

ContentMap::ContentMap(const gpu::Device& device, MapContent content, float exponent,
                       float blur_texels)
    : device_(device),
      content_(content),
      exponent_(exponent),
      blur_texels_(is_blurred(content) ? blur_texels : 0.0f),
      nearest_(device, {}) {
    using enum gpu::BindingType;
    fill_ = gpu::Pipeline(device,
                          gpu::ComputePipelineInfo{
                              .code = shaders::map_content_comp,
                              .layout = {{texture, storage_image}, sizeof(shared::MapContentPush)},
                              .constants = {static_cast<std::uint32_t>(content)}});
    blur_ = gpu::Pipeline(device,
                          gpu::ComputePipelineInfo{
                              .code = shaders::map_blur_comp,
                              .layout = {{texture, storage_image}, sizeof(shared::MapBlurPush)}});
}

void ContentMap::record(gpu::Commands& commands, const gpu::Image& depths,
                        std::span<const LightFit> fits) {
    assert(depths.info().layers == fits.size());
    make_images(depths);
    commands.use(image_, gpu::Use::storage_write);
    commands.bind(fill_,
                  {gpu::Texture{depths.view(), &nearest_}, gpu::StorageImage{image_.view()}});
    for (std::uint32_t layer = 0; layer < fits.size(); ++layer) {
        commands.push(fill_, shared::MapContentPush{.space = map_space(fits[layer]),
                                                    .exponent = exponent_,
                                                    .layer = layer,
                                                    .size = image_.size().width});
        commands.dispatch(image_.size(), kGroupSize);
    }
    if (blur_texels_ > 0.0f) {
        blur(commands, image_, between_, {1, 0});
        blur(commands, between_, image_, {0, 1});
    }
    commands.use(image_, gpu::Use::sampled);
}

void ContentMap::make_images(const gpu::Image& depths) {
    if (image_ && image_.size() == depths.size() && image_.info().layers == depths.info().layers)
        return;
    const gpu::ImageInfo info{.size = depths.size(),
                              .format = format_of(content_),
                              .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                              .layers = depths.info().layers,
                              .array = true};
    image_ = gpu::Image(device_, info);
    if (blur_texels_ > 0.0f) between_ = gpu::Image(device_, info);
}

void ContentMap::blur(gpu::Commands& commands, gpu::Image& source, gpu::Image& target,
                      glm::uvec2 step) {
    commands.use(source, gpu::Use::sampled);
    commands.use(target, gpu::Use::storage_write);
    commands.bind(blur_,
                  {gpu::Texture{source.view(), &nearest_}, gpu::StorageImage{target.view()}});
    for (std::uint32_t layer = 0; layer < source.info().layers; ++layer) {
        commands.push(blur_, shared::MapBlurPush{.step = step,
                                                 .layer = layer,
                                                 .size = source.size().width,
                                                 .radius_texels = blur_texels_});
        commands.dispatch(source.size(), kGroupSize);
    }
}

}  // namespace gnomon
