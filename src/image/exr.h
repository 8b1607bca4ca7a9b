#pragma once

#include <gnomon/image.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace gnomon::image {

/// The greatest picture that read_exr accepts, in float values (1 GiB), so that a small hostile
/// file cannot claim more.
inline constexpr std::uint64_t kMaxExrValues = std::uint64_t{1} << 28;

/// The OpenEXR file of write_exr as bytes.
std::string encode_exr(const Image& image);

/// As read_exr, from memory; messages begin with `name`.
Image decode_exr(std::span<const std::uint8_t> bytes, std::string_view name);

}  // namespace gnomon::image
