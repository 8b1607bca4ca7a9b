#include "visibility/receiver_survey.h"

#include "receiver_survey.comp.spv.h"
#include "visibility/receiver_survey.shared.h"

#include <cstring>
#include <utility>
#include <vector>

namespace gnomon {

namespace {

/// Of distances that come from depths in floats.
constexpr double kRounding = 1e-5;

Extent tiles_of(Extent size) {
    constexpr unsigned kTile = shared::kSurveyTile_px;
    return {(size.width + kTile - 1) / kTile, (size.height + kTile - 1) / kTile};
}

}  // namespace

ReceiverSurvey::ReceiverSurvey(const gpu::Device& device) : device_(device), nearest_(device, {}) {
    using enum gpu::BindingType;
    pipeline_ = gpu::Pipeline(
        device, gpu::ComputePipelineInfo{
                    .code = shaders::receiver_survey_comp,
                    .layout = {{texture, storage_buffer}, sizeof(shared::SurveyPush)}});
}

void ReceiverSurvey::record(gpu::Commands& commands, const raster::Receivers& receivers) {
    camera_ = receivers.camera;
    size_ = receivers.size;
    const Extent tiles = tiles_of(size_);
    const std::uint64_t bytes =
        std::uint64_t{tiles.width} * tiles.height * sizeof(shared::SurveyedTile);
    if (!tiles_ || tiles_.size_bytes() != bytes) {
        tiles_ = gpu::Buffer(device_, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                             gpu::Placement::readback);
    }
    commands.use(tiles_, gpu::Use::storage_write);
    commands.bind(pipeline_,
                  {gpu::Texture{receivers.depth.view(), &nearest_}, gpu::StorageBuffer{&tiles_}});
    commands.push(pipeline_, shared::SurveyPush{.es_from_clip = receivers.eye_from_clip(),
                                                .size = {size_.width, size_.height}});
    commands.dispatch(tiles, 1);
    commands.use(tiles_, gpu::Use::host_read);
}

Seen ReceiverSurvey::seen() {
    std::vector<shared::SurveyedTile> found(tiles_.size_bytes() / sizeof(shared::SurveyedTile));
    std::memcpy(found.data(), tiles_.mapped(), tiles_.size_bytes());
    const Vec3 eye_ws = camera_.eye_ws();
    std::vector<SeenTile> tiles;
    for (const shared::SurveyedTile& tile : found) {
        if (!(tile.nearest > 0.0f)) continue;
        Box3 bounds;
        bounds.include(eye_ws + Vec3(tile.low_es));
        bounds.include(eye_ws + Vec3(tile.high_es));
        tiles.push_back({bounds,
                         {(1.0 - kRounding) * distance_at(camera_, size_, tile.nearest),
                          (1.0 + kRounding) * distance_at(camera_, size_, tile.farthest)}});
    }
    return seen_in(std::move(tiles));
}

}  // namespace gnomon
