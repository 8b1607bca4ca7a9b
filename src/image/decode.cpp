#include "image/decode.h"

#include "base/check.h"
#include "image/codec.h"

#include <algorithm>
#include <new>

namespace gnomon::image {

namespace {

bool begins_with(std::span<const std::uint8_t> bytes, std::span<const std::uint8_t> signature) {
    return bytes.size() >= signature.size() &&
           std::equal(signature.begin(), signature.end(), bytes.begin());
}

}  // namespace

Rgba8 decode(std::span<const std::uint8_t> bytes, std::string_view name) {
    if (begins_with(bytes, kPngSignature)) return decode_png(bytes, name);
    if (begins_with(bytes, kJpegSignature)) return decode_jpeg(bytes, name);
    if (bytes.empty()) fail_input("{}: is empty; it must be a PNG or JPEG picture", name);
    fail_input("{}: is neither PNG nor JPEG; convert it to one of them", name);
}

void check_decoded_size(Extent size, std::uint64_t file_bytes, std::uint64_t max_pixels_per_byte,
                        std::string_view name) {
    const std::uint64_t pixels = std::uint64_t{size.width} * size.height;
    if (pixels == 0) {
        fail_input("{}: is {}x{} pixels; both sides must be above 0", name, size.width,
                   size.height);
    }
    if (size.width > kMaxDecodedSide_px || size.height > kMaxDecodedSide_px ||
        pixels > kMaxDecoded_px) {
        fail_input("{}: is {}x{} pixels; scale it to at most {} a side and {} in all", name,
                   size.width, size.height, kMaxDecodedSide_px, kMaxDecoded_px);
    }
    if (pixels > file_bytes * max_pixels_per_byte) {
        fail_input("{}: is cut short: {} bytes cannot hold {}x{} pixels", name, file_bytes,
                   size.width, size.height);
    }
}

Rgba8 blank_picture(Extent size, std::string_view name) {
    try {
        return {size, std::vector<std::uint8_t>(kChannelsRgba * size.width * size.height)};
    } catch (const std::bad_alloc&) {
        fail_machine("{}: out of memory for {}x{} pixels", name, size.width, size.height);
    }
}

std::vector<std::uint8_t> encode_png(const Rgba8& picture) {
    return encode_png8(picture.size, static_cast<int>(kChannelsRgba), picture.rgba);
}

}  // namespace gnomon::image
