#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon {

enum class DeviceType { discrete, integrated, cpu, other };

/// "discrete", "integrated", "cpu" or "other".
std::string_view device_type_name(DeviceType type);

struct DeviceInfo {
    int index = 0;  ///< as in ContextOptions::device
    std::string name;
    DeviceType type = DeviceType::other;
    std::string driver;  ///< name and version
    std::string api;     ///< Vulkan version, "1.3.230"
    bool usable = false;
    std::string missing;  ///< why it is not usable, empty when it is
    std::vector<std::pair<std::string, bool>> optional_features;  ///< name, present
};

/// Every Vulkan device of the machine, best first (discrete, integrated, CPU).
/// Throws Error{machine} when there is no Vulkan loader.
std::vector<DeviceInfo> list_devices();

struct ContextOptions {
    std::string device;  ///< index or part of a name as list_devices() gives them; empty = the best
    bool validation = false;  ///< Khronos validation layer with synchronization validation
    int threads = 0;          ///< for work on the CPU; 0 = all cores
};

/// A Vulkan device, the caches that techniques share on it (scenes, receivers), and CPU threads.
/// Not to be used from two threads at a time.
class Context {
public:
    /// Throws Error{machine}: no loader, no usable device (what each one lacks), no validation
    /// layer; Error{input}: no device of that name.
    explicit Context(const ContextOptions& options = {});
    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    const DeviceInfo& device() const;

    /// What the validation layer has said so far, a line a message. Empty unless asked for.
    std::vector<std::string> validation_messages() const;

    class Impl;
    Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace gnomon
