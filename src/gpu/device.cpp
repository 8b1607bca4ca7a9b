#include "gpu/device.h"

#include "base/check.h"
#include "gpu/pipeline.h"

#include <array>

namespace gnomon::gpu {

namespace {

OptionalFeatures optional_features(VkPhysicalDevice device) {
    VkPhysicalDeviceVulkan12Features v12{.sType =
                                             VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                       .pNext = &v12};
    vkGetPhysicalDeviceFeatures2(device, &features);
    return {.multi_draw = features.features.multiDrawIndirect == VK_TRUE &&
                          features.features.drawIndirectFirstInstance == VK_TRUE,
            .layered_output = v12.shaderOutputLayer == VK_TRUE};
}

}  // namespace

Device::Device(const ContextOptions& options)
    : instance_(options.validation), pipelines_(std::make_unique<PipelineCache>()) {
    const std::vector<Candidate> candidates = rank_devices(instance_);
    create(choose_device(candidates, options.device));
}

void Device::create(const Candidate& candidate) {
    physical_ = candidate.handle;
    info_ = candidate.info;
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical_, &properties);
    limits_ = properties.limits;
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);

    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, families.data());
    constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    while ((families[queue_family_].queueFlags & kNeeded) != kNeeded)
        ++queue_family_;

    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                        .queueFamilyIndex = queue_family_,
                                        .queueCount = 1,
                                        .pQueuePriorities = &priority};
    optional_ = optional_features(physical_);
    VkPhysicalDeviceVulkan13Features v13{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
        .synchronization2 = VK_TRUE,
        .dynamicRendering = VK_TRUE,
        .maintenance4 = VK_TRUE};
    VkPhysicalDeviceVulkan12Features v12{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
        .pNext = &v13,
        .scalarBlockLayout = VK_TRUE,
        .shaderOutputLayer = optional_.layered_output ? VK_TRUE : VK_FALSE};
    VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                       .pNext = &v12};
    VkPhysicalDeviceFeatures offered;
    vkGetPhysicalDeviceFeatures(physical_, &offered);
    tessellates_ = offered.tessellationShader == VK_TRUE && offered.shaderClipDistance == VK_TRUE;
    features.features.tessellationShader = tessellates_ ? VK_TRUE : VK_FALSE;
    features.features.shaderClipDistance = tessellates_ ? VK_TRUE : VK_FALSE;
    features.features.depthClamp = VK_TRUE;
    features.features.geometryShader = VK_TRUE;
    features.features.shaderStorageImageWriteWithoutFormat = VK_TRUE;
    features.features.multiDrawIndirect = optional_.multi_draw ? VK_TRUE : VK_FALSE;
    features.features.drawIndirectFirstInstance = features.features.multiDrawIndirect;
    const std::array extensions = {VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME};
    const VkDeviceCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
        .pNext = &features,
        .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queue,
        .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
        .ppEnabledExtensionNames = extensions.data()};
    check(vkCreateDevice(physical_, &info, nullptr, &device_), "creating a Vulkan device");
    vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
}

Device::~Device() {
    if (device_ == VK_NULL_HANDLE) return;
    vkDeviceWaitIdle(device_);
    pipelines_.reset();
    vkDestroyDevice(device_, nullptr);
}

int Device::memory_type(std::uint32_t allowed, VkMemoryPropertyFlags flags) const {
    for (std::uint32_t i = 0; i < memory_.memoryTypeCount; ++i) {
        const bool fits = (memory_.memoryTypes[i].propertyFlags & flags) == flags;
        if (fits && (allowed & (1u << i)) != 0) return static_cast<int>(i);
    }
    return -1;
}

}  // namespace gnomon::gpu
