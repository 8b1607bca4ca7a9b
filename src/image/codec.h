#pragma once

#include "image/decode.h"

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

/// The formats behind decode.h. Each lives in one .cpp that alone includes its library.
namespace gnomon::image {

inline constexpr std::size_t kChannelsRgba = 4;

inline constexpr std::array<std::uint8_t, 8> kPngSignature = {0x89, 'P',  'N',  'G',
                                                              '\r', '\n', 0x1a, '\n'};
inline constexpr std::array<std::uint8_t, 3> kJpegSignature = {0xff, 0xd8, 0xff};

/// As decode(), for bytes that begin with the signature.
Rgba8 decode_png(std::span<const std::uint8_t> bytes, std::string_view name);
Rgba8 decode_jpeg(std::span<const std::uint8_t> bytes, std::string_view name);

/// Throws Error{input} when a picture of this size is beyond what decode() accepts, or could not
/// come from a file of `file_bytes` at its format's greatest compression. To be called before
/// anything of that size is allocated.
void check_decoded_size(Extent size, std::uint64_t file_bytes, std::uint64_t max_pixels_per_byte,
                        std::string_view name);

/// A picture of zeros. Throws Error{machine} when memory runs out.
Rgba8 blank_picture(Extent size, std::string_view name);

/// A PNG file of 8-bit grey (1 channel), RGB (3) or RGBA (4) pixels, row-major.
/// Throws Error{machine} when memory runs out.
std::vector<std::uint8_t> encode_png8(Extent size, int channels,
                                      std::span<const std::uint8_t> pixels);
/// The same of 16-bit pixels.
std::vector<std::uint8_t> encode_png16(Extent size, int channels,
                                       std::span<const std::uint16_t> pixels);

/// RGBA pixels as they are stored, for numbers that are no colours.
struct Rgba16 {
    Extent size;
    int bits = 16;  ///< of a value in the file
    std::vector<std::uint16_t> rgba;
};

/// An RGBA PNG of 8 or 16 bits, values as they are in the file. Throws Error{input} for others and
/// for damaged ones, with `name` in front.
Rgba16 decode_png_numbers(std::span<const std::uint8_t> bytes, std::string_view name);

}  // namespace gnomon::image
