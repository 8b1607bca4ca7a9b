#pragma once

#include "gpu/pipeline.h"

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gnomon::gpu {

/// A resource for one binding of a pipeline.
struct Texture {
    VkImageView view = VK_NULL_HANDLE;
    const Sampler* sampler = nullptr;
    VkImageLayout layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
};
struct StorageImage {
    VkImageView view = VK_NULL_HANDLE;
};
struct StorageBuffer {
    const Buffer* buffer = nullptr;
};
/// At most 64 KiB that all invocations read alike.
struct UniformBuffer {
    const Buffer* buffer = nullptr;
};
using Binding = std::variant<StorageBuffer, UniformBuffer, StorageImage, Texture>;

/// A place in a layer of an image, in texels.
struct LayerPlace {
    unsigned layer = 0;
    VkOffset2D offset{};
};

/// A rectangle of a layer of an image, in texels.
struct LayerArea {
    unsigned layer = 0;
    VkRect2D area{};
};

/// Where drawing goes, and what is there before.
struct Targets {
    std::vector<const Image*> colors;
    const Image* depth = nullptr;
    int layer = -1;  ///< of arrays; -1: all layers, among which vertex shaders choose
    Extent size;
    std::optional<VkRect2D> area;  ///< all that is cleared and drawn into; else all of it
    bool clear_colors = true;
    bool clear_depth = true;     ///< to 0, the far plane of reversed Z
    bool clear_stencil = false;  ///< to 0
    VkClearColorValue clear_value{};
};

/// Names spans of device work and tells how long each took.
class PassTimer {
public:
    explicit PassTimer(const Device& device);
    ~PassTimer();
    PassTimer(const PassTimer&) = delete;
    PassTimer& operator=(const PassTimer&) = delete;

    struct Time {
        std::string name;
        double ms = 0.0;
    };

    void reset(VkCommandBuffer commands);
    void begin(VkCommandBuffer commands, std::string_view name);
    void end(VkCommandBuffer commands);
    /// In order of begin(); to be called when the device has finished.
    std::vector<Time> times() const;

private:
    static constexpr std::uint32_t kMaxPasses = 64;
    const Device& device_;
    VkQueryPool pool_ = VK_NULL_HANDLE;
    std::vector<std::string> names_;
};

/// Records into a command buffer, ours or a host renderer's. Resources are declared with use()
/// before they are read or written; the barriers follow from that.
class Commands {
public:
    Commands(const Device& device, VkCommandBuffer handle, PassTimer* timer = nullptr)
        : device_(&device), handle_(handle), timer_(timer) {}

    VkCommandBuffer handle() const { return handle_; }
    const Device& device() const { return *device_; }

    void use(Image& image, Use use);
    void use(Buffer& buffer, Use use);

    void begin_pass(std::string_view name);
    void end_pass();

    /// The targets must be in use as such. The viewport covers `targets.size`, the scissor what
    /// of it is drawn into; nothing is
    /// culled; counter-clockwise faces are front faces.
    void begin_drawing(const Targets& targets);
    void end_drawing();

    void bind(const Pipeline& pipeline, std::initializer_list<Binding> bindings);
    template <typename T>
    void push(const Pipeline& pipeline, const T& constants) {
        static_assert(sizeof(T) <= 128, "the least that every device has");
        vkCmdPushConstants(handle_, pipeline.layout(), pipeline.stages(), 0, sizeof(T), &constants);
    }

    /// `count` draws of the index buffer bound, whose numbers are VkDrawIndexedIndirectCommands of
    /// the buffer from `first` on. Needs Device::optional().multi_draw.
    void draw_indexed(const Buffer& draws, std::uint64_t first, std::uint64_t count);

    /// Enough groups of group_size x group_size for `size`.
    void dispatch(Extent size, unsigned group_size);

    /// Bytes, a multiple of 4, taken into the command buffer, to a place of the target that is one
    /// as well; then ready for `next`.
    void update(Buffer& target, std::span<const std::byte> bytes, Use next = Use::storage_read,
                std::uint64_t first_byte = 0);
    template <typename T>
    void update(Buffer& target, const T& value) {
        update(target, std::as_bytes(std::span(&value, 1)));
    }

    /// All of a colour image; it is in use as the target of copies afterwards.
    void clear(Image& image, const VkClearColorValue& value);
    /// A layer of a depth image without stencil, to 0, likewise.
    void clear_depth(Image& image, unsigned layer);

    void copy(const Buffer& source, const Buffer& target, std::uint64_t bytes);
    void copy(const Buffer& source, const Image& target);
    void copy(const Image& source, const Buffer& target);
    /// A rectangle from one layer to another; of two images, or not overlapping.
    void copy(const Image& source, LayerPlace from, const Image& target, LayerPlace to,
              Extent size);
    /// Rectangles that do not overlap, to the same places of another image.
    void copy(const Image& source, const Image& target, std::span<const LayerArea> areas);

private:
    const Device* device_;
    VkCommandBuffer handle_;
    PassTimer* timer_;
};

/// One pass of the timer for as long as it lives.
class Pass {
public:
    Pass(Commands& commands, std::string_view name) : commands_(commands) {
        commands_.begin_pass(name);
    }
    ~Pass() { commands_.end_pass(); }
    Pass(const Pass&) = delete;
    Pass& operator=(const Pass&) = delete;

private:
    Commands& commands_;
};

/// A command buffer that is recorded, submitted and waited for, again and again.
class Submission {
public:
    explicit Submission(const Device& device);
    ~Submission();
    Submission(const Submission&) = delete;
    Submission& operator=(const Submission&) = delete;

    Commands begin();
    /// Throws Error{machine} when the device is lost or does not finish in time.
    void submit_and_wait();
    std::vector<PassTimer::Time> times() const { return timer_.times(); }

private:
    const Device& device_;
    PassTimer timer_;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    VkFence fence_ = VK_NULL_HANDLE;
};

/// Fills a device buffer from the host, and waits for it.
void upload(const Device& device, Buffer& target, std::span<const std::byte> bytes);

template <typename T>
Buffer make_buffer(const Device& device, std::span<const T> values, VkBufferUsageFlags usage) {
    Buffer buffer(device, values.size_bytes(), usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                  Placement::device);
    upload(device, buffer, std::as_bytes(values));
    return buffer;
}

}  // namespace gnomon::gpu
