#pragma once

#include <gnomon/math.h>

#include "gpu/device.h"

#include <cstddef>
#include <span>
#include <vector>

namespace gnomon::gpu {

/// What the next command does with a buffer or an image. Commands::use() derives barriers and
/// layouts from it.
enum class Use {
    none,           ///< contents not yet defined
    color_target,   ///< colour attachment
    depth_target,   ///< depth/stencil attachment, tested and written
    depth_test,     ///< depth tested, not written; stencil written
    sampled,        ///< read by a fragment or compute shader through a sampler
    storage_read,   ///< read by a shader as storage or uniform buffer
    storage_write,  ///< written (and read) by a shader as storage
    vertex_read,    ///< read by a vertex shader, as index, vertex or indirect buffer
    copy_source,
    copy_target,
    host_read,
};

/// Device memory of one resource. One allocation each: we hold tens of resources, not thousands.
class Memory {
public:
    Memory() = default;
    Memory(const Device& device, const VkMemoryRequirements& requirements,
           VkMemoryPropertyFlags wanted, VkMemoryPropertyFlags fallback);
    ~Memory();
    Memory(Memory&& other) noexcept;
    Memory& operator=(Memory&& other) noexcept;

    VkDeviceMemory handle() const { return memory_; }
    std::uint64_t size() const { return size_; }

private:
    const Device* device_ = nullptr;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    std::uint64_t size_ = 0;
};

enum class Placement {
    device,    ///< fast for the device, not mapped
    upload,    ///< mapped; the host writes, the device reads
    readback,  ///< mapped; the device writes, the host reads
};

class Buffer {
public:
    Buffer() = default;
    /// At least one element's worth: a size of 0 becomes 16 bytes, so that it can always be bound.
    Buffer(const Device& device, std::uint64_t size_bytes, VkBufferUsageFlags usage,
           Placement placement);
    ~Buffer();
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;

    VkBuffer handle() const { return buffer_; }
    std::uint64_t size_bytes() const { return size_; }
    std::uint64_t memory_bytes() const { return memory_.size(); }
    std::byte* mapped() { return mapped_; }
    explicit operator bool() const { return buffer_ != VK_NULL_HANDLE; }

    Use use = Use::none;  ///< kept by Commands

private:
    const Device* device_ = nullptr;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    Memory memory_;
    std::uint64_t size_ = 0;
    std::byte* mapped_ = nullptr;
};

struct ImageInfo {
    Extent size;
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkImageUsageFlags usage = 0;
    unsigned layers = 1;
    unsigned mip_levels = 1;
    bool array = false;  ///< seen as an array, whatever its number of layers
};

class Image {
public:
    Image() = default;
    Image(const Device& device, const ImageInfo& info);
    ~Image();
    Image(Image&& other) noexcept;
    Image& operator=(Image&& other) noexcept;

    VkImage handle() const { return image_; }
    /// All layers and levels; depth only, for formats that have stencil too.
    VkImageView view() const { return view_; }
    /// One layer of an array, as an attachment.
    VkImageView layer_view(unsigned layer) const { return layer_views_[layer]; }
    /// Depth and stencil, as an attachment.
    VkImageView attachment_view() const { return attachment_view_; }
    /// Stencil only, to be sampled as unsigned integers.
    VkImageView stencil_view() const { return stencil_view_; }
    VkImageAspectFlags aspects() const { return aspects_; }
    const ImageInfo& info() const { return info_; }
    Extent size() const { return info_.size; }
    std::uint64_t memory_bytes() const { return memory_.size(); }
    explicit operator bool() const { return image_ != VK_NULL_HANDLE; }

    Use use = Use::none;  ///< kept by Commands

private:
    VkImageView make_view(VkImageAspectFlags aspects) const;
    VkImageView make_view(VkImageAspectFlags aspects, VkImageViewType type, unsigned first_layer,
                          unsigned layers) const;

    const Device* device_ = nullptr;
    VkImage image_ = VK_NULL_HANDLE;
    VkImageView view_ = VK_NULL_HANDLE;
    VkImageView attachment_view_ = VK_NULL_HANDLE;
    VkImageView stencil_view_ = VK_NULL_HANDLE;
    std::vector<VkImageView> layer_views_;
    VkImageAspectFlags aspects_ = 0;
    Memory memory_;
    ImageInfo info_;
};

struct SamplerInfo {
    VkFilter filter = VK_FILTER_NEAREST;
    VkSamplerAddressMode wrap_u = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    VkSamplerAddressMode wrap_v = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    bool mip_levels = false;  ///< interpolate between them; else level 0 serves all
};

class Sampler {
public:
    Sampler() = default;
    Sampler(const Device& device, const SamplerInfo& info);
    ~Sampler();
    Sampler(Sampler&& other) noexcept;
    Sampler& operator=(Sampler&& other) noexcept;

    VkSampler handle() const { return sampler_; }

private:
    const Device* device_ = nullptr;
    VkSampler sampler_ = VK_NULL_HANDLE;
};

}  // namespace gnomon::gpu
