#pragma once

// Vulkan through volk: the loader is opened at run time, so that the library links on machines that
// have none.
#ifndef VK_NO_PROTOTYPES
#define VK_NO_PROTOTYPES
#endif
#include <volk.h>

#include <string_view>

namespace gnomon::gpu {

/// Throws Error{machine} that names the call, the result and what to do about it.
void check(VkResult result, std::string_view what);

}  // namespace gnomon::gpu
