#include "owner_choice.h"

#include "blurred_projection.shared.h"
#include "choose_owners.comp.spv.h"
#include "count_seen.comp.spv.h"

#include <vector>

namespace gnomon::blurred_projection {

namespace {

constexpr unsigned kGroupSize = 8;

}  // namespace

OwnerChoice::OwnerChoice(const gpu::Device& device, unsigned channels)
    : device_(device),
      channels_(channels),
      owners_(device, sizeof(shared::Owners), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
              gpu::Placement::device) {
    using enum gpu::BindingType;
    count_ = gpu::Pipeline(
        device, gpu::ComputePipelineInfo{
                    .code = shaders::count_seen_comp,
                    .layout = {{storage_image, storage_buffer}, sizeof(shared::CountPush)},
                    .constants = {}});
    choose_ = gpu::Pipeline(
        device, gpu::ComputePipelineInfo{
                    .code = shaders::choose_owners_comp,
                    .layout = {{storage_buffer, storage_buffer}, sizeof(shared::ChoosePush)},
                    .constants = {}});
}

void OwnerChoice::prepare(std::size_t instances) {
    instances_ = static_cast<unsigned>(instances);
    counts_ = gpu::make_buffer<std::uint32_t>(device_, std::vector<std::uint32_t>(instances, 0),
                                              VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
}

void OwnerChoice::record(gpu::Commands& commands, const raster::Receivers& receivers) {
    const Extent counted{(receivers.size.width + shared::kCountEvery - 1) / shared::kCountEvery,
                         (receivers.size.height + shared::kCountEvery - 1) / shared::kCountEvery};
    commands.use(counts_, gpu::Use::storage_write);
    commands.bind(count_, {gpu::StorageImage{receivers.ids.view()}, gpu::StorageBuffer{&counts_}});
    commands.push(count_, shared::CountPush{{receivers.size.width, receivers.size.height}});
    commands.dispatch(counted, kGroupSize);

    commands.use(counts_, gpu::Use::storage_write);
    commands.use(owners_, gpu::Use::storage_write);
    commands.bind(choose_, {gpu::StorageBuffer{&counts_}, gpu::StorageBuffer{&owners_}});
    commands.push(choose_, shared::ChoosePush{instances_, channels_});
    commands.dispatch({1, 1}, 1);
    commands.use(owners_, gpu::Use::vertex_read);
}

}  // namespace gnomon::blurred_projection
