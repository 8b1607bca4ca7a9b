#include "base/check.h"
#include "image/codec.h"

#include <csetjmp>
#include <cstdio>
#include <vector>

// In this order: jpeglib.h needs FILE, and jerror.h what jpeglib.h defines.
// clang-format off
#include <jpeglib.h>
#include <jerror.h>
// clang-format on

namespace gnomon::image {

namespace {

// Each 8x8 block of the component of highest resolution takes at least one bit of Huffman code.
constexpr std::uint64_t kMaxPixelsPerByte = std::uint64_t{8} * DCTSIZE2;

// A progressive file passes over the picture once per scan, and a few bytes make a scan. Encoders
// write about ten; this leaves 32 for the greatest picture, thousands for a small one.
constexpr std::uint64_t kMaxScanned_px = 32 * kMaxDecoded_px;

constexpr int kChannelsRgb = 3;

/// libjpeg's error manager, extended by where to jump to and by what went wrong.
struct ErrorManager {
    jpeg_error_mgr base;  // the first member: libjpeg hands back a pointer to it
    std::jmp_buf jump;
    char text[JMSG_LENGTH_MAX];
};

[[noreturn]] void on_error(j_common_ptr codec) {
    auto* manager = reinterpret_cast<ErrorManager*>(codec->err);
    codec->err->format_message(codec, manager->text);
    std::longjmp(manager->jump, 1);
}

/// libjpeg only warns of damaged pixels and goes on with grey ones; here they are errors. Harmless
/// departures, such as stray bytes between segments, are common and are ignored.
void on_message(j_common_ptr codec, int level) {
    constexpr int kWarning = -1;
    if (level != kWarning) return;
    switch (codec->err->msg_code) {
        case JWRN_HIT_MARKER:
        case JWRN_HUFF_BAD_CODE:
        case JWRN_JPEG_EOF:
        case JWRN_MUST_RESYNC:
            on_error(codec);
        default:
            break;
    }
}

void on_progress(j_common_ptr codec) {
    const auto* decoder = reinterpret_cast<const jpeg_decompress_struct*>(codec);
    const std::uint64_t pixels = std::uint64_t{decoder->image_width} * decoder->image_height;
    if (pixels * static_cast<std::uint64_t>(decoder->input_scan_number) > kMaxScanned_px) {
        auto* manager = reinterpret_cast<ErrorManager*>(codec->err);
        std::snprintf(manager->text, sizeof(manager->text), "it has more than %d scans",
                      decoder->input_scan_number - 1);
        std::longjmp(manager->jump, 1);
    }
}

struct Decoder {
    jpeg_decompress_struct codec{};
    jpeg_progress_mgr progress{};
    ErrorManager errors{};

    Decoder() {
        codec.err = jpeg_std_error(&errors.base);
        errors.base.error_exit = on_error;
        errors.base.emit_message = on_message;
    }
    ~Decoder() { jpeg_destroy_decompress(&codec); }
    Decoder(const Decoder&) = delete;
    Decoder& operator=(const Decoder&) = delete;
};

/// longjmp must not leave a frame with a destructor: as guarded() in png.cpp.
template <typename Step>
bool guarded(Decoder& decoder, const Step& step) {
    if (setjmp(decoder.errors.jump) != 0) return false;
    step(decoder.codec);
    return true;
}

/// Reads the rows as RGB into the end of each row of RGBA, then spreads them from the front.
void read_rows(jpeg_decompress_struct& codec, std::uint8_t* rgba, unsigned width) {
    while (codec.output_scanline < codec.output_height) {
        std::uint8_t* row = rgba + std::size_t{codec.output_scanline} * width * kChannelsRgba;
        std::uint8_t* rgb = row + width;
        jpeg_read_scanlines(&codec, &rgb, 1);
        for (unsigned x = 0; x < width; ++x) {
            for (int channel = 0; channel < kChannelsRgb; ++channel)
                *row++ = *rgb++;
            *row++ = 0xff;
        }
    }
    jpeg_finish_decompress(&codec);
}

}  // namespace

Rgba8 decode_jpeg(std::span<const std::uint8_t> bytes, std::string_view name) {
    Decoder decoder;
    const auto require = [&](bool done) {
        if (!done) fail_input("{}: is a damaged JPEG: {}", name, decoder.errors.text);
    };
    require(guarded(decoder, [&](jpeg_decompress_struct& codec) {
        jpeg_create_decompress(&codec);
        codec.progress = &decoder.progress;
        decoder.progress.progress_monitor = on_progress;
        jpeg_mem_src(&codec, bytes.data(), static_cast<unsigned long>(bytes.size()));
        jpeg_read_header(&codec, TRUE);
    }));
    if (decoder.codec.arith_code) {
        fail_input("{}: is a JPEG with arithmetic coding; save it with Huffman coding", name);
    }
    const Extent size{decoder.codec.image_width, decoder.codec.image_height};
    check_decoded_size(size, bytes.size(), kMaxPixelsPerByte, name);
    if (decoder.codec.num_components != 1 && decoder.codec.num_components != kChannelsRgb) {
        fail_input("{}: is a JPEG of {} components (CMYK?); save it as RGB", name,
                   decoder.codec.num_components);
    }
    require(guarded(decoder, [&](jpeg_decompress_struct& codec) {
        codec.out_color_space = JCS_RGB;
        jpeg_start_decompress(&codec);
    }));
    Rgba8 picture = blank_picture(size, name);
    std::uint8_t* rgba = picture.rgba.data();
    require(guarded(decoder,
                    [&](jpeg_decompress_struct& codec) { read_rows(codec, rgba, size.width); }));
    return picture;
}

}  // namespace gnomon::image
