#include "gpu/resources.h"

#include "base/check.h"

#include <algorithm>
#include <utility>

namespace gnomon::gpu {

Memory::Memory(const Device& device, const VkMemoryRequirements& requirements,
               VkMemoryPropertyFlags wanted, VkMemoryPropertyFlags fallback)
    : device_(&device), size_(requirements.size) {
    int type = device.memory_type(requirements.memoryTypeBits, wanted);
    if (type < 0) type = device.memory_type(requirements.memoryTypeBits, fallback);
    if (type < 0) fail_machine("the device has no memory of the needed kind");
    const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                    .allocationSize = requirements.size,
                                    .memoryTypeIndex = static_cast<std::uint32_t>(type)};
    check(vkAllocateMemory(device.handle(), &info, nullptr, &memory_),
          fmt::format("allocating {} MiB on the device", (requirements.size >> 20) + 1));
}

Memory::~Memory() {
    if (memory_ != VK_NULL_HANDLE) vkFreeMemory(device_->handle(), memory_, nullptr);
}

Memory::Memory(Memory&& other) noexcept {
    *this = std::move(other);
}

Memory& Memory::operator=(Memory&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(memory_, other.memory_);
    std::swap(size_, other.size_);
    return *this;
}

// Delegating makes the object whole at once, so that its destructor frees what was made before a
// step that fails.
Buffer::Buffer(const Device& device, std::uint64_t size_bytes, VkBufferUsageFlags usage,
               Placement placement)
    : Buffer() {
    device_ = &device;
    size_ = std::max<std::uint64_t>(size_bytes, 16);
    const std::uint64_t most = device.limits().maxStorageBufferRange;
    if ((usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT) != 0 && size_ > most) {
        fail_machine(
            "{} MiB of one kind of data is more than the {} MiB that shaders of this device "
            "can read; use a smaller scene or another device",
            (size_ >> 20) + 1, most >> 20);
    }
    const VkBufferCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size_, .usage = usage};
    check(vkCreateBuffer(device.handle(), &info, nullptr, &buffer_), "creating a buffer");
    VkMemoryRequirements requirements;
    vkGetBufferMemoryRequirements(device.handle(), buffer_, &requirements);
    constexpr VkMemoryPropertyFlags kMapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    if (placement == Placement::upload) wanted = kMapped;
    if (placement == Placement::readback) wanted = kMapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    memory_ = Memory(device, requirements, wanted, placement == Placement::device ? 0 : kMapped);
    check(vkBindBufferMemory(device.handle(), buffer_, memory_.handle(), 0), "binding memory");
    if (placement != Placement::device) {
        void* pointer = nullptr;
        check(vkMapMemory(device.handle(), memory_.handle(), 0, VK_WHOLE_SIZE, 0, &pointer),
              "mapping memory");
        mapped_ = static_cast<std::byte*>(pointer);
    }
}

Buffer::~Buffer() {
    if (buffer_ != VK_NULL_HANDLE) vkDestroyBuffer(device_->handle(), buffer_, nullptr);
}

Buffer::Buffer(Buffer&& other) noexcept {
    *this = std::move(other);
}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(buffer_, other.buffer_);
    std::swap(memory_, other.memory_);
    std::swap(size_, other.size_);
    std::swap(mapped_, other.mapped_);
    std::swap(use, other.use);
    return *this;
}

namespace {

VkImageAspectFlags aspects_of(VkFormat format) {
    switch (format) {
        case VK_FORMAT_D32_SFLOAT_S8_UINT:
            return VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;
        case VK_FORMAT_D32_SFLOAT:
        case VK_FORMAT_D16_UNORM:
            return VK_IMAGE_ASPECT_DEPTH_BIT;
        default:
            return VK_IMAGE_ASPECT_COLOR_BIT;
    }
}

}  // namespace

Image::Image(const Device& device, const ImageInfo& info) : Image() {
    device_ = &device;
    aspects_ = aspects_of(info.format);
    info_ = info;
    const unsigned limit = device.limits().maxImageDimension2D;
    if (info.size.width > limit || info.size.height > limit) {
        fail_input("an image of {}x{} is larger than the device's limit of {} a side",
                   info.size.width, info.size.height, limit);
    }
    const VkImageCreateInfo create{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                   .imageType = VK_IMAGE_TYPE_2D,
                                   .format = info.format,
                                   .extent = {info.size.width, info.size.height, 1},
                                   .mipLevels = info.mip_levels,
                                   .arrayLayers = info.layers,
                                   .samples = VK_SAMPLE_COUNT_1_BIT,
                                   .tiling = VK_IMAGE_TILING_OPTIMAL,
                                   .usage = info.usage,
                                   .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED};
    check(vkCreateImage(device.handle(), &create, nullptr, &image_), "creating an image");
    VkMemoryRequirements requirements;
    vkGetImageMemoryRequirements(device.handle(), image_, &requirements);
    memory_ = Memory(device, requirements, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0);
    check(vkBindImageMemory(device.handle(), image_, memory_.handle(), 0), "binding memory");

    const bool stencil = (aspects_ & VK_IMAGE_ASPECT_STENCIL_BIT) != 0;
    view_ = make_view(stencil ? VkImageAspectFlags{VK_IMAGE_ASPECT_DEPTH_BIT} : aspects_);
    if (stencil) {
        attachment_view_ = make_view(aspects_);
        stencil_view_ = make_view(VK_IMAGE_ASPECT_STENCIL_BIT);
    }
    for (unsigned layer = 0; info.array && layer < info.layers; ++layer)
        layer_views_.push_back(make_view(aspects_, VK_IMAGE_VIEW_TYPE_2D, layer, 1));
}

VkImageView Image::make_view(VkImageAspectFlags aspects) const {
    const bool array = info_.array || info_.layers > 1;
    return make_view(aspects, array ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D, 0,
                     info_.layers);
}

VkImageView Image::make_view(VkImageAspectFlags aspects, VkImageViewType type, unsigned first_layer,
                             unsigned layers) const {
    const VkImageViewCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = image_,
        .viewType = type,
        .format = info_.format,
        .subresourceRange = {aspects, 0, info_.mip_levels, first_layer, layers}};
    VkImageView view = VK_NULL_HANDLE;
    check(vkCreateImageView(device_->handle(), &info, nullptr, &view), "creating an image view");
    return view;
}

Image::~Image() {
    if (device_ == nullptr) return;
    vkDestroyImageView(device_->handle(), view_, nullptr);
    vkDestroyImageView(device_->handle(), attachment_view_, nullptr);
    vkDestroyImageView(device_->handle(), stencil_view_, nullptr);
    for (const VkImageView view : layer_views_)
        vkDestroyImageView(device_->handle(), view, nullptr);
    vkDestroyImage(device_->handle(), image_, nullptr);
}

Image::Image(Image&& other) noexcept {
    *this = std::move(other);
}

Image& Image::operator=(Image&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(image_, other.image_);
    std::swap(view_, other.view_);
    std::swap(attachment_view_, other.attachment_view_);
    std::swap(stencil_view_, other.stencil_view_);
    std::swap(layer_views_, other.layer_views_);
    std::swap(aspects_, other.aspects_);
    std::swap(memory_, other.memory_);
    std::swap(info_, other.info_);
    std::swap(use, other.use);
    return *this;
}

Sampler::Sampler(const Device& device, const SamplerInfo& info) : device_(&device) {
    const VkSamplerCreateInfo create{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                     .magFilter = info.filter,
                                     .minFilter = info.filter,
                                     .mipmapMode = info.mip_levels ? VK_SAMPLER_MIPMAP_MODE_LINEAR
                                                                   : VK_SAMPLER_MIPMAP_MODE_NEAREST,
                                     .addressModeU = info.wrap_u,
                                     .addressModeV = info.wrap_v,
                                     .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                     .maxLod = info.mip_levels ? VK_LOD_CLAMP_NONE : 0.0f,
                                     .borderColor = VK_BORDER_COLOR_FLOAT_TRANSPARENT_BLACK};
    check(vkCreateSampler(device.handle(), &create, nullptr, &sampler_), "creating a sampler");
}

Sampler::~Sampler() {
    if (sampler_ != VK_NULL_HANDLE) vkDestroySampler(device_->handle(), sampler_, nullptr);
}

Sampler::Sampler(Sampler&& other) noexcept {
    *this = std::move(other);
}

Sampler& Sampler::operator=(Sampler&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(sampler_, other.sampler_);
    return *this;
}

}  // namespace gnomon::gpu
