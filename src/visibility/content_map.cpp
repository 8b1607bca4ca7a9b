#include "visibility/content_map.h"

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
    const glm::dmat4 rows = glm::transpose(fit.clip_from_world);
    const DVec3 along(rows[3]);
    space.reach = static_cast<float>(rows[2].w / (glm::length(along) * fit.far_m));
    if (!fit.is_view) return space;
    // x and y of the map are (right - middle * along) / half over the distance along the axis.
    glm::dvec2 half, middle;
    for (int axis = 0; axis < 2; ++axis) {
        const DVec3 row(rows[axis]);
        const double on_axis = glm::dot(row, along) / glm::dot(along, along);
        half[axis] = 1.0 / std::sqrt(glm::dot(row, row) - on_axis * on_axis);
        middle[axis] = -on_axis * half[axis];
    }
    space.tangents = Vec4(half.x, half.y, middle.x, middle.y);
    return space;
}

ContentMap::ContentMap(const gpu::Device& device, MapContent content, float exponent,
                       float blur_texels)
    : device_(device),
      content_(content),
      exponent_(exponent),
      nearest_(device, {}),
      blur_(device, is_blurred(content) ? blur_texels : 0.0f) {
    using enum gpu::BindingType;
    fill_ = gpu::Pipeline(device,
                          gpu::ComputePipelineInfo{
                              .code = shaders::map_content_comp,
                              .layout = {{texture, storage_image}, sizeof(shared::MapContentPush)},
                              .constants = {static_cast<std::uint32_t>(content)}});
}

void ContentMap::record(gpu::Commands& commands, const gpu::Image& depths,
                        std::span<const LightFit> fits) {
    assert(depths.info().layers == fits.size());
    make_image(depths);
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
    blur_.record(commands, image_);
    reach_m_.clear();
    for (const LightFit& fit : fits)
        reach_m_.push_back(fit.far_m);
}

void ContentMap::make_image(const gpu::Image& depths) {
    if (image_ && image_.size() == depths.size() && image_.info().layers == depths.info().layers)
        return;
    image_ = gpu::Image(device_, {.size = depths.size(),
                                  .format = format_of(content_),
                                  .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                                  .layers = depths.info().layers,
                                  .array = true});
}

}  // namespace gnomon
