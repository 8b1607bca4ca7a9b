#pragma once

#include <gnomon/math.h>

#include <filesystem>
#include <span>
#include <vector>

namespace gnomon {

/// Float32 pixels, row-major, top row first, channels interleaved.
class Image {
public:
    static constexpr unsigned kMaxSide_px = 65'536;

    Image() = default;

    /// `channels` is 1 to 4. Throws Error{input} when a side is 0 or above kMaxSide_px,
    /// Error{machine} when memory runs out.
    Image(Extent size, int channels, float fill = 0.0f);

    Extent size() const { return size_; }
    unsigned width() const { return size_.width; }
    unsigned height() const { return size_.height; }
    int channels() const { return channels_; }
    bool empty() const { return pixels_.empty(); }

    /// width * height * channels values.
    std::span<float> pixels() { return pixels_; }
    std::span<const float> pixels() const { return pixels_; }

    float& at(unsigned x, unsigned y, int channel = 0) { return pixels_[index(x, y, channel)]; }
    float at(unsigned x, unsigned y, int channel = 0) const {
        return pixels_[index(x, y, channel)];
    }

private:
    std::size_t index(unsigned x, unsigned y, int channel) const {
        return (static_cast<std::size_t>(y) * size_.width + x) *
                   static_cast<std::size_t>(channels_) +
               static_cast<std::size_t>(channel);
    }

    Extent size_;
    int channels_ = 0;
    std::vector<float> pixels_;
};

/// Writes 8-bit PNG: 1 (grey), 3 (RGB) or 4 (RGBA) channels. Values are display values in [0, 1]
/// (already sRGB-encoded) and are clamped, NaN to 0. The file appears whole or not at all.
/// Throws Error{machine} when it cannot be written, Error{input} for an empty or 2-channel image.
void write_png(const std::filesystem::path& path, const Image& image);

/// Writes float32 OpenEXR: channel Y for 1 channel, R, G, B, (A) for 3 or 4. Whole or not at all.
/// Throws Error{machine} when it cannot be written, Error{input} for an empty or 2-channel image.
void write_exr(const std::filesystem::path& path, const Image& image);

/// Reads what write_exr writes, and any other scan-line or tiled EXR with Y or RGB(A) channels.
/// Throws Error{input} when the file is missing, damaged, has other channels or more than 2^28
/// values (1 GiB).
Image read_exr(const std::filesystem::path& path);

/// sRGB transfer function of one value in [0, 1], IEC 61966-2-1, and its inverse.
float srgb_from_linear(float linear);
float linear_from_srgb(float srgb);

}  // namespace gnomon
