#include "visibility/map_blur.h"

#include "map_blur.comp.spv.h"
#include "visibility/map_lookup.shared.h"

namespace gnomon {

namespace {

constexpr unsigned kGroupSize = 8;

bool alike(const gpu::Image& a, const gpu::Image& b) {
    return a.size() == b.size() && a.info().layers == b.info().layers &&
           a.info().format == b.info().format;
}

}  // namespace

MapBlur::MapBlur(const gpu::Device& device, float radius_texels)
    : device_(device), radius_texels_(radius_texels), nearest_(device, {}) {
    using enum gpu::BindingType;
    pipeline_ = gpu::Pipeline(
        device, gpu::ComputePipelineInfo{
                    .code = shaders::map_blur_comp,
                    .layout = {{texture, storage_image}, sizeof(shared::MapBlurPush)}});
}

void MapBlur::record(gpu::Commands& commands, gpu::Image& image) {
    if (radius_texels_ > 0.0f) {
        if (!between_ || !alike(between_, image)) between_ = gpu::Image(device_, image.info());
        blur(commands, image, between_, {1, 0});
        blur(commands, between_, image, {0, 1});
    }
    commands.use(image, gpu::Use::sampled);
}

void MapBlur::blur(gpu::Commands& commands, gpu::Image& source, gpu::Image& target,
                   glm::uvec2 step) {
    commands.use(source, gpu::Use::sampled);
    commands.use(target, gpu::Use::storage_write);
    commands.bind(pipeline_,
                  {gpu::Texture{source.view(), &nearest_}, gpu::StorageImage{target.view()}});
    for (std::uint32_t layer = 0; layer < source.info().layers; ++layer) {
        commands.push(pipeline_, shared::MapBlurPush{.step = step,
                                                     .layer = layer,
                                                     .size = source.size().width,
                                                     .radius_texels = radius_texels_});
        commands.dispatch(source.size(), kGroupSize);
    }
}

}  // namespace gnomon
