#include "base/check.h"
#include "gpu/device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>

namespace gnomon {

std::string_view device_type_name(DeviceType type) {
    switch (type) {
        case DeviceType::discrete:
            return "discrete";
        case DeviceType::integrated:
            return "integrated";
        case DeviceType::cpu:
            return "cpu";
        case DeviceType::other:
            break;
    }
    return "other";
}

std::vector<DeviceInfo> list_devices() {
    const gpu::Instance instance(false);
    std::vector<DeviceInfo> infos;
    for (gpu::Candidate& candidate : gpu::rank_devices(instance)) {
        infos.push_back(std::move(candidate.info));
    }
    return infos;
}

}  // namespace gnomon

namespace gnomon::gpu {

namespace {

DeviceType device_type(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return DeviceType::discrete;
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return DeviceType::integrated;
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return DeviceType::cpu;
        default:
            return DeviceType::other;
    }
}

bool has_extension(VkPhysicalDevice device, const char* name) {
    std::uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
    return std::any_of(extensions.begin(), extensions.end(), [&](const auto& extension) {
        return std::strcmp(extension.extensionName, name) == 0;
    });
}

bool has_queue(VkPhysicalDevice device) {
    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
    constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    return std::any_of(families.begin(), families.end(), [](const VkQueueFamilyProperties& f) {
        return (f.queueFlags & kNeeded) == kNeeded;
    });
}

bool samples_depth_stencil(VkPhysicalDevice device) {
    VkFormatProperties properties;
    vkGetPhysicalDeviceFormatProperties(device, VK_FORMAT_D32_SFLOAT_S8_UINT, &properties);
    constexpr VkFormatFeatureFlags kNeeded =
        VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT;
    return (properties.optimalTilingFeatures & kNeeded) == kNeeded;
}

/// What every technique may rely on; the first missing part, or empty.
std::string missing_feature(VkPhysicalDevice device, std::uint32_t api) {
    if (api < VK_API_VERSION_1_3) return "Vulkan 1.3";
    VkPhysicalDeviceVulkan13Features v13{.sType =
                                             VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features v12{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &v13};
    VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                       .pNext = &v12};
    vkGetPhysicalDeviceFeatures2(device, &features);
    if (v13.dynamicRendering == VK_FALSE) return "feature dynamicRendering";
    if (v13.synchronization2 == VK_FALSE) return "feature synchronization2";
    if (v13.maintenance4 == VK_FALSE) return "feature maintenance4";
    if (v12.scalarBlockLayout == VK_FALSE) return "feature scalarBlockLayout";
    if (features.features.depthClamp == VK_FALSE) return "feature depthClamp";
    if (features.features.geometryShader == VK_FALSE) {
        return "feature geometryShader (for primitive ids in fragment shaders)";
    }
    if (features.features.shaderStorageImageWriteWithoutFormat == VK_FALSE) {
        return "feature shaderStorageImageWriteWithoutFormat";
    }
    if (!has_extension(device, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME)) {
        return "extension VK_KHR_push_descriptor";
    }
    if (!samples_depth_stencil(device)) return "sampled format D32_SFLOAT_S8_UINT";
    if (!has_queue(device)) return "a queue for graphics and compute";
    return {};
}

DeviceInfo describe(VkPhysicalDevice device) {
    VkPhysicalDeviceDriverProperties driver{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                           .pNext = &driver};
    vkGetPhysicalDeviceProperties2(device, &properties);
    const std::uint32_t api = properties.properties.apiVersion;
    DeviceInfo info;
    info.name = properties.properties.deviceName;
    info.type = device_type(properties.properties.deviceType);
    info.driver = fmt::format("{} {}", driver.driverName, driver.driverInfo);
    info.api = fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(api), VK_API_VERSION_MINOR(api),
                           VK_API_VERSION_PATCH(api));
    info.missing = missing_feature(device, api);
    info.usable = info.missing.empty();

    VkPhysicalDeviceVulkan12Features v12{.sType =
                                             VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceVulkan11Features v11{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES, .pNext = &v12};
    VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                       .pNext = &v11};
    vkGetPhysicalDeviceFeatures2(device, &features);
    info.optional_features = {
        {"ray queries", has_extension(device, VK_KHR_RAY_QUERY_EXTENSION_NAME)},
        {"descriptor indexing", v12.descriptorIndexing == VK_TRUE},
        {"depth bounds test", features.features.depthBounds == VK_TRUE},
        {"sparse images", features.features.sparseBinding == VK_TRUE},
        {"multiview", v11.multiview == VK_TRUE},
        {"layered output from vertex shaders", v12.shaderOutputLayer == VK_TRUE},
        {"tessellation", features.features.tessellationShader == VK_TRUE &&
                             features.features.shaderClipDistance == VK_TRUE},
        {"stencil export", has_extension(device, VK_EXT_SHADER_STENCIL_EXPORT_EXTENSION_NAME)},
    };
    return info;
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

std::string names(const std::vector<Candidate>& candidates) {
    std::string list;
    for (const Candidate& candidate : candidates) {
        list += fmt::format("{}{} \"{}\"", list.empty() ? "" : ", ", candidate.info.index,
                            candidate.info.name);
    }
    return list;
}

const Candidate* find_device(const std::vector<Candidate>& candidates, const std::string& wanted) {
    std::size_t index = 0;
    const char* const end = wanted.data() + wanted.size();
    const auto parsed = std::from_chars(wanted.data(), end, index);
    if (parsed.ec == std::errc() && parsed.ptr == end) {
        return index < candidates.size() ? &candidates[index] : nullptr;
    }
    for (const Candidate& candidate : candidates) {
        if (lower(candidate.info.name).find(lower(wanted)) != std::string::npos) return &candidate;
    }
    return nullptr;
}

}  // namespace

std::vector<Candidate> rank_devices(const Instance& instance) {
    std::vector<Candidate> candidates;
    for (const VkPhysicalDevice device : instance.physical_devices()) {
        candidates.push_back({device, describe(device)});
    }
    return rank(std::move(candidates));
}

std::vector<Candidate> rank(std::vector<Candidate> candidates) {
    std::stable_sort(
        candidates.begin(), candidates.end(),
        [](const Candidate& a, const Candidate& b) { return a.info.type < b.info.type; });
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        candidates[i].info.index = static_cast<int>(i);
    }
    return candidates;
}

const Candidate& choose_device(const std::vector<Candidate>& candidates,
                               const std::string& wanted) {
    if (candidates.empty()) {
        fail_machine("no Vulkan device; install a driver, e.g. the package mesa-vulkan-drivers");
    }
    if (!wanted.empty()) {
        const Candidate* found = find_device(candidates, wanted);
        if (found == nullptr) {
            fail_input("no device \"{}\"; there are: {}", wanted, names(candidates));
        }
        if (!found->info.usable) {
            fail_machine("device \"{}\" lacks {}", found->info.name, found->info.missing);
        }
        return *found;
    }
    std::string lacks;
    for (const Candidate& candidate : candidates) {
        if (candidate.info.usable) return candidate;
        lacks += fmt::format("{}\"{}\" lacks {}", lacks.empty() ? "" : "; ", candidate.info.name,
                             candidate.info.missing);
    }
    fail_machine("no usable Vulkan device: {}", lacks);
}

}  // namespace gnomon::gpu
