#include "visibility/receiver_survey.h"

#include "receiver_survey.comp.spv.h"
#include "visibility/receiver_survey.shared.h"

#include <glm/ext/matrix_double4x4.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace gnomon {

namespace {

constexpr unsigned kBlock_px = shared::kSurveyBlock_px;

/// Along a side of a tile. Boxes of larger tiles are less tight, of smaller ones not much tighter,
/// while the host takes longer over them.
constexpr unsigned kTileBlocks = 4;

/// Of distances and positions that come from depths in floats, relative to the distance, or to the
/// range of a parallel camera.
constexpr double kRounding = 1e-5;

constexpr unsigned kGroupSize = 8;

Extent blocks_of(Extent size) {
    return {(size.width + kBlock_px - 1) / kBlock_px, (size.height + kBlock_px - 1) / kBlock_px};
}

shared::SurveyedBlock both(const shared::SurveyedBlock& a, const shared::SurveyedBlock& b) {
    return {glm::min(a.low_es, b.low_es), glm::max(a.high_es, b.high_es),
            std::max(a.nearest, b.nearest), std::min(a.farthest, b.farthest), a.depths | b.depths};
}

/// All depths from `farthest` to `nearest` that are `step` steps below 1.
struct DepthStep {
    float nearest, farthest;

    DepthStep(const shared::SurveyedBlock& of, unsigned step)
        : nearest(std::min(of.nearest, depth(step))),
          farthest(std::max(of.farthest, step + 1 < shared::kSurveyDepths ? depth(step + 1) : 0)) {}

private:
    static float depth(unsigned step) {
        return std::bit_cast<float>(shared::kBitsOfOne - (step << shared::kSurveyDepthShift));
    }
};

/// Turns pixels into boxes.
class Picture {
public:
    Picture(const Camera& camera, Extent size)
        : camera_(camera), size_(size), eye_ws_(camera.eye_ws()) {
        glm::dmat4 view(camera.view_from_world);
        view[3] = view * glm::dvec4(eye_ws_, 1.0);
        es_from_clip_ = glm::inverse(glm::dmat4(camera.clip_from_view(size)) * view);
    }

    /// Of the receivers in a tile, `at` blocks from the corner, at some of its depths.
    SeenTile tile(const shared::SurveyedBlock& found, const DepthStep& depths, Extent at) const {
        const double far_m = distance_at(camera_, size_, depths.farthest);
        const double near_m = distance_at(camera_, size_, depths.nearest);
        const double rounding_m =
            kRounding * std::max(far_m, static_cast<double>(camera_.ortho_depth_m));
        DVec3 low(std::numeric_limits<double>::infinity());
        DVec3 high = -low;
        for (unsigned i = 0; i < 8; ++i) {
            const DVec3 p_es =
                position_es({at.width + ((i & 1) != 0 ? kTileBlocks : 0),
                             at.height + ((i & 2) != 0 ? kTileBlocks : 0)},
                            static_cast<double>((i & 4) != 0 ? depths.nearest : depths.farthest));
            low = glm::min(low, p_es);
            high = glm::max(high, p_es);
        }
        Box3 bounds;
        bounds.include(Vec3(eye_ws_ + glm::max(low - rounding_m, DVec3(found.low_es))));
        bounds.include(Vec3(eye_ws_ + glm::min(high + rounding_m, DVec3(found.high_es))));
        return {bounds,
                {std::max(near_m - rounding_m, static_cast<double>(camera_.near_m)),
                 far_m + rounding_m}};
    }

private:
    /// Of a corner of a block.
    DVec3 position_es(Extent block, double depth) const {
        const glm::dvec4 p =
            es_from_clip_ * glm::dvec4(2.0 * kBlock_px * block.width / size_.width - 1.0,
                                       2.0 * kBlock_px * block.height / size_.height - 1.0, depth,
                                       1.0);
        return DVec3(p) / p.w;
    }

    const Camera& camera_;
    Extent size_;
    DVec3 eye_ws_;
    glm::dmat4 es_from_clip_{1.0};
};

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
    const Extent blocks = blocks_of(size_);
    const std::uint64_t bytes =
        std::uint64_t{blocks.width} * blocks.height * sizeof(shared::SurveyedBlock);
    if (!blocks_ || blocks_.size_bytes() != bytes) {
        blocks_ = gpu::Buffer(device_, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                              gpu::Placement::readback);
    }
    commands.use(blocks_, gpu::Use::storage_write);
    commands.bind(pipeline_,
                  {gpu::Texture{receivers.depth.view(), &nearest_}, gpu::StorageBuffer{&blocks_}});
    commands.push(pipeline_, shared::SurveyPush{.es_from_clip = receivers.eye_from_clip(),
                                                .size = {size_.width, size_.height},
                                                .blocks = blocks.width});
    commands.dispatch(blocks, kGroupSize);
    commands.use(blocks_, gpu::Use::host_read);
}

// What a tile sees at one depth is boxed by itself: one box around a tree and the hills beyond it
// would hold all that is between.
Seen ReceiverSurvey::seen() {
    const Extent blocks = blocks_of(size_);
    std::vector<shared::SurveyedBlock> found(std::size_t{blocks.width} * blocks.height);
    std::memcpy(found.data(), blocks_.mapped(), blocks_.size_bytes());
    with_receivers_.clear();
    for (std::uint32_t i = 0; i < found.size(); ++i) {
        if (found[i].nearest > 0.0f) {
            with_receivers_.push_back(
                {i % blocks.width | i / blocks.width << 16, found[i].nearest, found[i].farthest});
        }
    }
    const Picture picture(camera_, size_);
    std::vector<SeenTile> tiles;
    for (unsigned y = 0; y < blocks.height; y += kTileBlocks) {
        for (unsigned x = 0; x < blocks.width; x += kTileBlocks) {
            shared::SurveyedBlock tile = found[std::size_t{y} * blocks.width + x];
            for (unsigned j = y; j < std::min(y + kTileBlocks, blocks.height); ++j) {
                for (unsigned i = x; i < std::min(x + kTileBlocks, blocks.width); ++i)
                    tile = both(tile, found[std::size_t{j} * blocks.width + i]);
            }
            std::uint64_t depths = tile.depths.x | std::uint64_t{tile.depths.y} << 32;
            for (; depths != 0; depths &= depths - 1) {
                const DepthStep step(tile, static_cast<unsigned>(std::countr_zero(depths)));
                tiles.push_back(picture.tile(tile, step, {x, y}));
            }
        }
    }
    return seen_in(std::move(tiles));
}

}  // namespace gnomon
