#pragma once

#include <gnomon/math.h>

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace gnomon::image {

/// 8-bit pixels as a file holds them: row-major, top row first, R, G, B, A interleaved, A not
/// premultiplied; 4 * width * height values.
struct Rgba8 {
    Extent size;
    std::vector<std::uint8_t> rgba;
};

/// What decode accepts, so that a small hostile file cannot claim gigabytes.
inline constexpr unsigned kMaxDecodedSide_px = 16'384;
inline constexpr std::uint64_t kMaxDecoded_px = std::uint64_t{64} << 20;

/// Decodes a PNG (every colour type, depth and interlacing; 16 bits are rounded to 8, grey and
/// palette become RGB, tRNS becomes A) or a JPEG (grey or RGB, baseline or progressive), told apart
/// by their first bytes. A is 255 where the file has none. Colour profiles and gamma are ignored.
/// Throws Error{input}, one line beginning with `name`, when the bytes are neither, damaged, cut
/// short, a CMYK JPEG, or a picture with a side above kMaxDecodedSide_px or more pixels than
/// kMaxDecoded_px.
Rgba8 decode(std::span<const std::uint8_t> bytes, std::string_view name);

/// The picture as an RGBA PNG file; the same bytes for the same picture.
std::vector<std::uint8_t> encode_png(const Rgba8& picture);

}  // namespace gnomon::image
