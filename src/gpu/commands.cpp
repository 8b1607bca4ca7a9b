#include "gpu/commands.h"

#include "base/check.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

namespace gnomon::gpu {

namespace {

struct Access {
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 access;
    VkImageLayout layout;
    bool writes;
};

constexpr VkPipelineStageFlags2 kShaders =
    VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
constexpr VkPipelineStageFlags2 kDepthTests =
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;
constexpr VkAccessFlags2 kDepthReadWrite =
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;

Access access_of(Use use) {
    switch (use) {
        case Use::none:
            return {VK_PIPELINE_STAGE_2_NONE, VK_ACCESS_2_NONE, VK_IMAGE_LAYOUT_UNDEFINED, false};
        case Use::color_target:
            return {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                    VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT,
                    VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, true};
        case Use::depth_target:
        case Use::depth_test:
            return {kDepthTests, kDepthReadWrite, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
                    true};
        case Use::sampled:
            return {kShaders, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                    VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, false};
        case Use::storage_read:
            return {kShaders, VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_UNIFORM_READ_BIT,
                    VK_IMAGE_LAYOUT_GENERAL, false};
        case Use::storage_write:
            return {kShaders,
                    VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                    VK_IMAGE_LAYOUT_GENERAL, true};
        case Use::vertex_read:
            return {VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT |
                        VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | kShaders,
                    VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT |
                        VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT |
                        VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT,
                    VK_IMAGE_LAYOUT_GENERAL, false};
        case Use::copy_source:
            return {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                    VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, false};
        case Use::copy_target:
            return {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                    VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, true};
        case Use::host_read:
            return {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT,
                    VK_IMAGE_LAYOUT_GENERAL, false};
    }
    return {};
}

VkDescriptorImageInfo image_info(const Binding& binding) {
    if (const auto* texture = std::get_if<Texture>(&binding)) {
        return {texture->sampler->handle(), texture->view, texture->layout};
    }
    return {VK_NULL_HANDLE, std::get<StorageImage>(binding).view, VK_IMAGE_LAYOUT_GENERAL};
}

// How long one submission may take before the device counts as hung: far above the slowest frame of
// a software device.
constexpr std::uint64_t kTimeoutNs = 300'000'000'000;

}  // namespace

PassTimer::PassTimer(const Device& device) : device_(device) {
    const VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                     .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                     .queryCount = 2 * kMaxPasses};
    check(vkCreateQueryPool(device.handle(), &info, nullptr, &pool_), "creating timers");
}

PassTimer::~PassTimer() {
    vkDestroyQueryPool(device_.handle(), pool_, nullptr);
}

void PassTimer::reset(VkCommandBuffer commands) {
    names_.clear();
    vkCmdResetQueryPool(commands, pool_, 0, 2 * kMaxPasses);
}

void PassTimer::begin(VkCommandBuffer commands, std::string_view name) {
    assert(names_.size() < kMaxPasses);
    const auto query = static_cast<std::uint32_t>(2 * names_.size());
    names_.emplace_back(name);
    vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, query);
}

void PassTimer::end(VkCommandBuffer commands) {
    const auto query = static_cast<std::uint32_t>(2 * names_.size() - 1);
    vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, query);
}

std::vector<PassTimer::Time> PassTimer::times() const {
    std::vector<Time> times;
    if (names_.empty()) return times;
    std::vector<std::uint64_t> ticks(2 * names_.size());
    check(vkGetQueryPoolResults(
              device_.handle(), pool_, 0, static_cast<std::uint32_t>(ticks.size()),
              ticks.size() * sizeof(std::uint64_t), ticks.data(), sizeof(std::uint64_t),
              VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
          "reading timers");
    const double ms_per_tick = static_cast<double>(device_.limits().timestampPeriod) * 1e-6;
    for (std::size_t i = 0; i < names_.size(); ++i) {
        const std::uint64_t elapsed = ticks[2 * i + 1] - ticks[2 * i];
        times.push_back({names_[i], static_cast<double>(elapsed) * ms_per_tick});
    }
    return times;
}

void Commands::use(Image& image, Use use) {
    const Access before = access_of(image.use);
    const Access after = access_of(use);
    if (image.use == use && !after.writes) return;
    const VkImageMemoryBarrier2 barrier{
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = before.stages,
        .srcAccessMask = before.writes ? before.access : VK_ACCESS_2_NONE,
        .dstStageMask = after.stages,
        .dstAccessMask = after.access,
        .oldLayout = before.layout,
        .newLayout = after.layout,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image.handle(),
        .subresourceRange = {image.aspects(), 0, VK_REMAINING_MIP_LEVELS, 0,
                             VK_REMAINING_ARRAY_LAYERS}};
    const VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                      .imageMemoryBarrierCount = 1,
                                      .pImageMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(handle_, &dependency);
    image.use = use;
}

void Commands::use(Buffer& buffer, Use use) {
    const Access before = access_of(buffer.use);
    const Access after = access_of(use);
    if (buffer.use == use && !after.writes) return;
    if (buffer.use != Use::none) {
        const VkBufferMemoryBarrier2 barrier{
            .sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER_2,
            .srcStageMask = before.stages,
            .srcAccessMask = before.writes ? before.access : VK_ACCESS_2_NONE,
            .dstStageMask = after.stages,
            .dstAccessMask = after.access,
            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .buffer = buffer.handle(),
            .size = VK_WHOLE_SIZE};
        const VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                          .bufferMemoryBarrierCount = 1,
                                          .pBufferMemoryBarriers = &barrier};
        vkCmdPipelineBarrier2(handle_, &dependency);
    }
    buffer.use = use;
}

void Commands::begin_pass(std::string_view name) {
    if (timer_ != nullptr) timer_->begin(handle_, name);
}

void Commands::end_pass() {
    if (timer_ != nullptr) timer_->end(handle_);
}

void Commands::begin_drawing(const Targets& targets) {
    const auto layer_view = [&](const Image& image) {
        return image.layer_view(static_cast<unsigned>(targets.layer));
    };
    std::vector<VkRenderingAttachmentInfo> colors;
    for (const Image* image : targets.colors) {
        const bool one_layer = targets.layer >= 0 && image->info().array;
        colors.push_back({.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                          .imageView = one_layer ? layer_view(*image) : image->view(),
                          .imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                          .loadOp = targets.clear_colors ? VK_ATTACHMENT_LOAD_OP_CLEAR
                                                         : VK_ATTACHMENT_LOAD_OP_LOAD,
                          .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                          .clearValue = {.color = targets.clear_value}});
    }
    VkRenderingAttachmentInfo depth{
        .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
        .imageLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
        .loadOp = targets.clear_depth ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD,
        .storeOp = VK_ATTACHMENT_STORE_OP_STORE};
    VkRenderingAttachmentInfo stencil = depth;
    stencil.loadOp =
        targets.clear_stencil ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD;
    bool has_stencil = false;
    if (targets.depth != nullptr) {
        has_stencil = targets.depth->attachment_view() != VK_NULL_HANDLE;
        depth.imageView = has_stencil ? targets.depth->attachment_view() : targets.depth->view();
        if (targets.layer >= 0) depth.imageView = layer_view(*targets.depth);
        stencil.imageView = depth.imageView;
    }
    const bool all_layers = targets.depth != nullptr && targets.layer < 0;
    const std::uint32_t layers = all_layers ? targets.depth->info().layers : 1;
    const VkRect2D area =
        targets.area.value_or(VkRect2D{{0, 0}, {targets.size.width, targets.size.height}});
    const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                               .renderArea = area,
                               .layerCount = layers,
                               .colorAttachmentCount = static_cast<std::uint32_t>(colors.size()),
                               .pColorAttachments = colors.data(),
                               .pDepthAttachment = targets.depth != nullptr ? &depth : nullptr,
                               .pStencilAttachment = has_stencil ? &stencil : nullptr};
    vkCmdBeginRendering(handle_, &info);
    const VkViewport viewport{
        0.0f, 0.0f, static_cast<float>(targets.size.width), static_cast<float>(targets.size.height),
        0.0f, 1.0f};
    vkCmdSetViewport(handle_, 0, 1, &viewport);
    vkCmdSetScissor(handle_, 0, 1, &area);
    vkCmdSetCullMode(handle_, VK_CULL_MODE_NONE);
    vkCmdSetFrontFace(handle_, VK_FRONT_FACE_COUNTER_CLOCKWISE);
}

void Commands::end_drawing() {
    vkCmdEndRendering(handle_);
}

void Commands::bind(const Pipeline& pipeline, std::initializer_list<Binding> bindings) {
    assert(bindings.size() == pipeline.layout_info().bindings.size());
    vkCmdBindPipeline(handle_, pipeline.bind_point(), pipeline.handle());
    constexpr std::size_t kMaxBindings = 16;
    std::array<VkDescriptorImageInfo, kMaxBindings> images;
    std::array<VkDescriptorBufferInfo, kMaxBindings> buffers;
    std::array<VkWriteDescriptorSet, kMaxBindings> writes;
    std::uint32_t count = 0;
    for (const Binding& binding : bindings) {
        VkWriteDescriptorSet& write = writes[count];
        write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                 .dstBinding = count,
                 .descriptorCount = 1};
        if (const auto* buffer = std::get_if<StorageBuffer>(&binding)) {
            buffers[count] = {buffer->buffer->handle(), 0, VK_WHOLE_SIZE};
            write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
            write.pBufferInfo = &buffers[count];
        } else if (const auto* uniform = std::get_if<UniformBuffer>(&binding)) {
            buffers[count] = {uniform->buffer->handle(), 0, VK_WHOLE_SIZE};
            write.descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
            write.pBufferInfo = &buffers[count];
        } else {
            images[count] = image_info(binding);
            write.descriptorType = std::holds_alternative<Texture>(binding)
                                       ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER
                                       : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
            write.pImageInfo = &images[count];
        }
        ++count;
    }
    if (count > 0) {
        vkCmdPushDescriptorSetKHR(handle_, pipeline.bind_point(), pipeline.layout(), 0, count,
                                  writes.data());
    }
}

void Commands::draw_indexed(const Buffer& draws, std::uint64_t first, std::uint64_t count) {
    constexpr std::uint32_t kStride = sizeof(VkDrawIndexedIndirectCommand);
    const std::uint64_t most = device_->limits().maxDrawIndirectCount;
    for (const std::uint64_t end = first + count; first < end;) {
        const auto now = static_cast<std::uint32_t>(std::min(most, end - first));
        vkCmdDrawIndexedIndirect(handle_, draws.handle(), first * kStride, now, kStride);
        first += now;
    }
}

void Commands::dispatch(Extent size, unsigned group_size) {
    vkCmdDispatch(handle_, (size.width + group_size - 1) / group_size,
                  (size.height + group_size - 1) / group_size, 1);
}

void Commands::clear(Image& image, const VkClearColorValue& value) {
    use(image, Use::copy_target);
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, VK_REMAINING_MIP_LEVELS, 0,
                                      VK_REMAINING_ARRAY_LAYERS};
    vkCmdClearColorImage(handle_, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &value, 1,
                         &all);
}

void Commands::clear_depth(Image& image, unsigned layer) {
    use(image, Use::copy_target);
    const VkClearDepthStencilValue far{};
    const VkImageSubresourceRange range{VK_IMAGE_ASPECT_DEPTH_BIT, 0, 1, layer, 1};
    vkCmdClearDepthStencilImage(handle_, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &far,
                                1, &range);
}

void Commands::copy(const Buffer& source, const Buffer& target, std::uint64_t bytes) {
    const VkBufferCopy region{0, 0, bytes};
    vkCmdCopyBuffer(handle_, source.handle(), target.handle(), 1, &region);
}

void Commands::update(Buffer& target, std::span<const std::byte> bytes, Use next,
                      std::uint64_t first_byte) {
    constexpr std::size_t kMostAtOnce_bytes = 65536;  // of vkCmdUpdateBuffer
    use(target, Use::copy_target);
    for (std::size_t at = 0; at < bytes.size(); at += kMostAtOnce_bytes) {
        const std::size_t count = std::min(kMostAtOnce_bytes, bytes.size() - at);
        vkCmdUpdateBuffer(handle_, target.handle(), first_byte + at, count, &bytes[at]);
    }
    use(target, next);
}

namespace {

VkImageAspectFlags copied_aspect(const Image& image) {
    return (image.aspects() & VK_IMAGE_ASPECT_DEPTH_BIT) != 0 ? VK_IMAGE_ASPECT_DEPTH_BIT
                                                              : VK_IMAGE_ASPECT_COLOR_BIT;
}

VkBufferImageCopy whole_image(const Image& image) {
    return {.imageSubresource = {copied_aspect(image), 0, 0, image.info().layers},
            .imageExtent = {image.size().width, image.size().height, 1}};
}

}  // namespace

void Commands::copy(const Buffer& source, const Image& target) {
    const VkBufferImageCopy region = whole_image(target);
    vkCmdCopyBufferToImage(handle_, source.handle(), target.handle(),
                           VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
}

void Commands::copy(const Image& source, const Buffer& target) {
    const VkBufferImageCopy region = whole_image(source);
    vkCmdCopyImageToBuffer(handle_, source.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                           target.handle(), 1, &region);
}

void Commands::copy(const Image& source, LayerPlace from, const Image& target, LayerPlace to,
                    Extent size) {
    const VkImageCopy region{.srcSubresource = {copied_aspect(source), 0, from.layer, 1},
                             .srcOffset = {from.offset.x, from.offset.y, 0},
                             .dstSubresource = {copied_aspect(target), 0, to.layer, 1},
                             .dstOffset = {to.offset.x, to.offset.y, 0},
                             .extent = {size.width, size.height, 1}};
    vkCmdCopyImage(handle_, source.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target.handle(),
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
}

void Commands::copy(const Image& source, const Image& target, std::span<const LayerArea> areas) {
    std::vector<VkImageCopy> regions;
    for (const auto& [layer, area] : areas) {
        const VkOffset3D place{area.offset.x, area.offset.y, 0};
        regions.push_back({.srcSubresource = {copied_aspect(source), 0, layer, 1},
                           .srcOffset = place,
                           .dstSubresource = {copied_aspect(target), 0, layer, 1},
                           .dstOffset = place,
                           .extent = {area.extent.width, area.extent.height, 1}});
    }
    if (regions.empty()) return;
    vkCmdCopyImage(handle_, source.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target.handle(),
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, static_cast<std::uint32_t>(regions.size()),
                   regions.data());
}

Submission::Submission(const Device& device) : device_(device), timer_(device) {
    const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                       .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                       .queueFamilyIndex = device.queue_family()};
    check(vkCreateCommandPool(device.handle(), &pool, nullptr, &pool_), "creating a command pool");
    const VkCommandBufferAllocateInfo allocate{
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = pool_,
        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
        .commandBufferCount = 1};
    check(vkAllocateCommandBuffers(device.handle(), &allocate, &commands_),
          "creating a command buffer");
    const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    check(vkCreateFence(device.handle(), &fence, nullptr, &fence_), "creating a fence");
}

Submission::~Submission() {
    vkDestroyFence(device_.handle(), fence_, nullptr);
    vkDestroyCommandPool(device_.handle(), pool_, nullptr);
}

Commands Submission::begin() {
    const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    // What was begun and not submitted, because something threw, is left half recorded.
    check(vkResetCommandBuffer(commands_, 0), "recording commands");
    check(vkBeginCommandBuffer(commands_, &info), "recording commands");
    timer_.reset(commands_);
    return Commands(device_, commands_, &timer_);
}

void Submission::submit_and_wait() {
    check(vkEndCommandBuffer(commands_), "recording commands");
    const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                             .commandBuffer = commands_};
    const VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                               .commandBufferInfoCount = 1,
                               .pCommandBufferInfos = &commands};
    check(vkResetFences(device_.handle(), 1, &fence_), "resetting a fence");
    check(vkQueueSubmit2(device_.queue(), 1, &submit, fence_), "submitting work");
    const VkResult waited = vkWaitForFences(device_.handle(), 1, &fence_, VK_TRUE, kTimeoutNs);
    // Nothing may be freed that the device still writes to.
    if (waited != VK_SUCCESS) vkDeviceWaitIdle(device_.handle());
    check(waited, "waiting for the device");
}

void upload(const Device& device, Buffer& target, std::span<const std::byte> bytes) {
    if (bytes.empty()) return;
    Buffer staging(device, bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Placement::upload);
    std::memcpy(staging.mapped(), bytes.data(), bytes.size());
    Submission submission(device);
    Commands commands = submission.begin();
    commands.use(target, Use::copy_target);
    commands.copy(staging, target, bytes.size());
    submission.submit_and_wait();
}

}  // namespace gnomon::gpu
