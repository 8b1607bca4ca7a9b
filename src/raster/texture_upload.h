#pragma once

#include <gnomon/scene.h>

#include "gpu/commands.h"

namespace gnomon::raster {

/// A texture with all its mip levels in device memory, ready to be sampled. Waits for the device.
gpu::Image upload_texture(const gpu::Device& device, const gnomon::Texture& texture);

gpu::Sampler texture_sampler(const gpu::Device& device, const gnomon::Texture& texture);

}  // namespace gnomon::raster
