#include "visibility/map_bounds.h"

#include "map_bounds.comp.spv.h"
#include "map_bounds_widen.comp.spv.h"

#include <algorithm>
#include <array>

namespace gnomon {

namespace {

constexpr unsigned kGroupSize = 8;

// PCSS is a disc in the world: along the axis of a map's shorter texels it is so much longer.
constexpr float kStretch = 3.0f;

// Of tiles around each, by width: bounds of more take long to make and prove little, so what
// reaches farther is filtered.
constexpr std::array<unsigned, 3> kRings{1, 2, 5};

float reach_of(unsigned width) {
    return static_cast<float>(kRings[width] * shared::kBoundsTile);
}

// A filter of varying reach may use the narrower bounds, one of fixed reach uses the first only.
unsigned widths_of(const ReadingOptions& reading) {
    const float stretch = reading.filter == MapFilter::pcss ? kStretch : 1.0f;
    const float most = stretch * filter_radius_texels(reading) + 0.5f;
    unsigned widths = 1;
    while (widths < kRings.size() && most > reach_of(widths - 1))
        ++widths;
    return widths;
}

/// What a receiver is spared on average, in texels whose bounds take as long to make, by
/// bench/tile_skip; between two and four fifths of all are. Filters that are no loop of taps are so
/// short that software drivers, which walk through both sides of a branch, gain nothing.
double spared_texels(const ReadingOptions& reading) {
    constexpr double kOfSquareTap = 1.25;
    constexpr double kOfDiscTap = 1.75;  // which is turned
    constexpr double kOfFootprintTap = 1.0;
    constexpr double kOfPcssTap = 3.0;  // and of its search
    switch (reading.filter) {
        case MapFilter::taps_16:
            return kOfSquareTap * 16;
        case MapFilter::disc:
            return kOfDiscTap * reading.filter_taps;
        case MapFilter::footprint:
            return kOfFootprintTap * reading.filter_taps;
        case MapFilter::pcss:
            return kOfPcssTap * reading.filter_taps;
        default:
            return 0.0;
    }
}

}  // namespace

MapBounds::MapBounds(const gpu::Device& device, const ReadingOptions& reading)
    : device_(device), reading_(reading), widths_(widths_of(reading)), nearest_(device, {}) {}

void MapBounds::make_pipelines() {
    using enum gpu::BindingType;
    const gpu::PipelineLayoutInfo layout{{texture, storage_image}, sizeof(shared::MapBoundsPush)};
    fill_ = gpu::Pipeline(
        device_, gpu::ComputePipelineInfo{.code = shaders::map_bounds_comp, .layout = layout});
    widen_ = gpu::Pipeline(device_, gpu::ComputePipelineInfo{.code = shaders::map_bounds_widen_comp,
                                                             .layout = layout});
}

Vec3 MapBounds::reach_texels() const {
    constexpr float kEndless = 1e9f;
    return {widths_ > 1 ? reach_of(0) : kEndless, widths_ > 2 ? reach_of(1) : kEndless,
            reach_of(widths_ - 1)};
}

bool MapBounds::pay(SkipUniform skip, Extent size, const gpu::Image& depths,
                    std::span<const LightFit> fits) const {
    // Read once, without a filter; or by some receivers and not by others.
    if (skip == SkipUniform::never || is_blurred(reading_.content) ||
        reading_.content == MapContent::object_id) {
        return false;
    }
    // Distances from a light within the world have no plane.
    if (reading_.content != MapContent::depth &&
        std::ranges::any_of(fits, [](const LightFit& fit) { return fit.far_m > 0.0; })) {
        return false;
    }
    if (skip == SkipUniform::always) return true;
    const double texels =
        static_cast<double>(depths.size().width) * depths.size().height * depths.info().layers;
    const double pixels = static_cast<double>(size.width) * size.height;
    return pixels * spared_texels(reading_) >= texels;
}

void MapBounds::record(gpu::Commands& commands, const gpu::Image& depths) {
    if (!outdated_) return;
    outdated_ = false;
    if (fill_.handle() == VK_NULL_HANDLE) make_pipelines();
    make_images(depths);
    const unsigned layers = depths.info().layers;
    const auto dispatch = [&](const gpu::Pipeline& pipeline, unsigned layer, unsigned width) {
        commands.push(pipeline, shared::MapBoundsPush{.layer = layer,
                                                      .size = depths.size().width,
                                                      .rings = kRings[width],
                                                      .bounds_layer = width * layers + layer});
        commands.dispatch(image_.size(), kGroupSize);
    };
    commands.use(tiles_, gpu::Use::storage_write);
    commands.bind(fill_,
                  {gpu::Texture{depths.view(), &nearest_}, gpu::StorageImage{tiles_.view()}});
    for (unsigned layer = 0; layer < layers; ++layer)
        dispatch(fill_, layer, 0);
    commands.use(tiles_, gpu::Use::sampled);
    commands.use(image_, gpu::Use::storage_write);
    commands.bind(widen_,
                  {gpu::Texture{tiles_.view(), &nearest_}, gpu::StorageImage{image_.view()}});
    for (unsigned i = 0; i < widths_ * layers; ++i)
        dispatch(widen_, i % layers, i / layers);
    commands.use(image_, gpu::Use::sampled);
}

void MapBounds::make_images(const gpu::Image& depths) {
    const unsigned side = (depths.size().width + shared::kBoundsTile - 1) / shared::kBoundsTile;
    const Extent size{side, side};
    if (tiles_ && tiles_.size() == size && tiles_.info().layers == depths.info().layers) {
        return;
    }
    gpu::ImageInfo info{.size = size,
                        .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                        .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                        .layers = depths.info().layers,
                        .array = true};
    tiles_ = gpu::Image(device_, info);
    info.layers *= widths_;
    image_ = gpu::Image(device_, info);
}

}  // namespace gnomon
