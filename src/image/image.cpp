#include <gnomon/image.h>

#include "base/check.h"

#include <cmath>
#include <new>

namespace gnomon {

namespace {

constexpr int kMaxChannels = 4;

}  // namespace

Image::Image(Extent size, int channels, float fill) : size_(size), channels_(channels) {
    if (size.width < 1 || size.height < 1 || size.width > kMaxSide_px ||
        size.height > kMaxSide_px) {
        fail_input("image size is {}x{} pixels; each side must be 1 to {}", size.width, size.height,
                   kMaxSide_px);
    }
    if (channels < 1 || channels > kMaxChannels) {
        fail_input("image has {} channels; it must have 1 to {}", channels, kMaxChannels);
    }
    const std::size_t values =
        static_cast<std::size_t>(size.width) * size.height * static_cast<std::size_t>(channels);
    try {
        pixels_.assign(values, fill);
    } catch (const std::bad_alloc&) {
        fail_machine("out of memory for an image of {}x{} pixels with {} channels", size.width,
                     size.height, channels);
    }
}

// The constants of both curves are those of IEC 61966-2-1.

float srgb_from_linear(float linear) {
    constexpr float kKnee = 0.0031308f;
    return linear <= kKnee ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

float linear_from_srgb(float srgb) {
    constexpr float kKnee = 0.04045f;
    return srgb <= kKnee ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

}  // namespace gnomon
