#define VOLK_IMPLEMENTATION
#include "base/check.h"
#include "gpu/device.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace gnomon::gpu {

namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

bool has_layer(const char* name) {
    std::uint32_t count = 0;
    vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    vkEnumerateInstanceLayerProperties(&count, layers.data());
    return std::any_of(layers.begin(), layers.end(), [&](const VkLayerProperties& layer) {
        return std::strcmp(layer.layerName, name) == 0;
    });
}

std::string_view result_name(VkResult result) {
    switch (result) {
        case VK_ERROR_OUT_OF_HOST_MEMORY:
            return "out of host memory";
        case VK_ERROR_OUT_OF_DEVICE_MEMORY:
            return "out of device memory; ask for a smaller picture or smaller maps";
        case VK_ERROR_INITIALIZATION_FAILED:
            return "initialization failed";
        case VK_ERROR_DEVICE_LOST:
            return "the device was lost; its driver gave up on it or it was reset";
        case VK_ERROR_LAYER_NOT_PRESENT:
            return "layer not present";
        case VK_ERROR_EXTENSION_NOT_PRESENT:
            return "extension not present";
        case VK_ERROR_FEATURE_NOT_PRESENT:
            return "feature not present";
        case VK_ERROR_INCOMPATIBLE_DRIVER:
            return "no driver for Vulkan 1.3; install one, e.g. mesa-vulkan-drivers";
        case VK_ERROR_TOO_MANY_OBJECTS:
            return "too many objects";
        case VK_ERROR_FORMAT_NOT_SUPPORTED:
            return "format not supported";
        case VK_TIMEOUT:
            return "the device did not finish in time";
        default:
            return "failed";
    }
}

}  // namespace

void check(VkResult result, std::string_view what) {
    if (result == VK_SUCCESS) return;
    fail_machine("{}: {} (VkResult {})", what, result_name(result), static_cast<int>(result));
}

Instance::Instance(bool validation) {
    if (volkInitialize() != VK_SUCCESS) {
        fail_machine(
            "no Vulkan loader found; install it, e.g. the packages libvulkan1 and "
            "mesa-vulkan-drivers");
    }
    if (volkGetInstanceVersion() < VK_API_VERSION_1_3) {
        fail_machine("the Vulkan loader is older than 1.3; install a newer libvulkan1");
    }
    if (validation && !has_layer(kValidationLayer)) {
        fail_machine("no validation layer; install the package vulkan-validationlayers");
    }
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                        .pApplicationName = "gnomon",
                                        .apiVersion = VK_API_VERSION_1_3};
    const std::array enabled = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    const VkValidationFeaturesEXT features{
        .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
        .enabledValidationFeatureCount = static_cast<std::uint32_t>(enabled.size()),
        .pEnabledValidationFeatures = enabled.data()};
    const VkDebugUtilsMessengerCreateInfoEXT messenger{
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .pNext = &features,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
        .pfnUserCallback = &Instance::on_message,
        .pUserData = this};
    const std::array extensions = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
                                   VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
    VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                              .pApplicationInfo = &application};
    if (validation) {
        info.pNext = &messenger;
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = &kValidationLayer;
        info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
        info.ppEnabledExtensionNames = extensions.data();
    }
    check(vkCreateInstance(&info, nullptr, &instance_), "creating a Vulkan instance");
    volkLoadInstance(instance_);
    if (validation) {
        VkDebugUtilsMessengerCreateInfoEXT running = messenger;
        running.pNext = nullptr;
        check(vkCreateDebugUtilsMessengerEXT(instance_, &running, nullptr, &messenger_),
              "listening to the validation layer");
    }
}

Instance::~Instance() {
    if (messenger_ != VK_NULL_HANDLE) {
        vkDestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
    }
    vkDestroyInstance(instance_, nullptr);
}

VKAPI_ATTR VkBool32 VKAPI_CALL
Instance::on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                     const VkDebugUtilsMessengerCallbackDataEXT* data, void* self) {
    auto& instance = *static_cast<Instance*>(self);
    const std::lock_guard lock(instance.mutex_);
    instance.messages_.emplace_back(data->pMessage);
    return VK_FALSE;
}

std::vector<VkPhysicalDevice> Instance::physical_devices() const {
    std::uint32_t count = 0;
    check(vkEnumeratePhysicalDevices(instance_, &count, nullptr), "listing Vulkan devices");
    std::vector<VkPhysicalDevice> devices(count);
    check(vkEnumeratePhysicalDevices(instance_, &count, devices.data()), "listing Vulkan devices");
    return devices;
}

std::vector<std::string> Instance::messages() const {
    const std::lock_guard lock(mutex_);
    return messages_;
}

}  // namespace gnomon::gpu
