#pragma once

#include <gnomon/context.h>

#include "gpu/vulkan.h"

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace gnomon::gpu {

/// A Vulkan instance, as long as anything made from it lives.
class Instance {
public:
    explicit Instance(bool validation);
    ~Instance();
    Instance(const Instance&) = delete;
    Instance& operator=(const Instance&) = delete;

    VkInstance handle() const { return instance_; }
    std::vector<VkPhysicalDevice> physical_devices() const;
    std::vector<std::string> messages() const;

private:
    static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                                     VkDebugUtilsMessageTypeFlagsEXT,
                                                     const VkDebugUtilsMessengerCallbackDataEXT*,
                                                     void* self);
    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    mutable std::mutex mutex_;
    std::vector<std::string> messages_;
};

/// A physical device and what is known of it.
struct Candidate {
    VkPhysicalDevice handle = VK_NULL_HANDLE;
    DeviceInfo info;
};

/// All devices, best first; `info.index` is the place in this list.
std::vector<Candidate> rank_devices(const Instance& instance);

/// Discrete ones first, then integrated, CPU and others, else in the order given; sets
/// `info.index`.
std::vector<Candidate> rank(std::vector<Candidate> candidates);

/// The first usable one, or the one that `wanted` (index or part of a name) means.
const Candidate& choose_device(const std::vector<Candidate>& candidates, const std::string& wanted);

/// What some devices can do, enabled where it is there.
struct OptionalFeatures {
    bool multi_draw = false;      ///< many indirect draws at once, from any instance on
    bool layered_output = false;  ///< vertex shaders choose the layer that they draw into
};

class PipelineCache;  // pipeline.h

/// A logical device with one queue that can draw, compute and copy. It outlives all that is made
/// with it.
class Device {
public:
    explicit Device(const ContextOptions& options);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    VkDevice handle() const { return device_; }
    VkPhysicalDevice physical() const { return physical_; }
    VkQueue queue() const { return queue_; }
    std::uint32_t queue_family() const { return queue_family_; }
    const DeviceInfo& info() const { return info_; }
    const OptionalFeatures& optional() const { return optional_; }
    const VkPhysicalDeviceLimits& limits() const { return limits_; }
    /// Whether pipelines may have tessellation stages, and clip distances.
    bool tessellates() const { return tessellates_; }
    /// What Pipeline compiles with.
    PipelineCache& pipelines() const { return *pipelines_; }
    std::vector<std::string> validation_messages() const { return instance_.messages(); }

    /// Index of a memory type of `allowed` with all `flags`, or -1.
    int memory_type(std::uint32_t allowed, VkMemoryPropertyFlags flags) const;

private:
    void create(const Candidate& candidate);

    Instance instance_;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    std::uint32_t queue_family_ = 0;
    DeviceInfo info_;
    OptionalFeatures optional_;
    VkPhysicalDeviceLimits limits_{};
    bool tessellates_ = false;
    VkPhysicalDeviceMemoryProperties memory_{};
    std::unique_ptr<PipelineCache> pipelines_;
};

}  // namespace gnomon::gpu
