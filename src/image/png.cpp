#include <gnomon/image.h>

#include "base/check.h"
#include "base/file.h"
#include "image/codec.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <new>
#include <string>

namespace gnomon {
namespace image {

namespace {

/// libpng reports an error by longjmp, which must not leave a frame with a destructor. So every
/// call that can fail is made inside guarded(), by a step whose own frame has none.
template <typename Step>
bool guarded(png_structp png, const Step& step) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    step();
    return true;
}

/// Where libpng leaves its message.
struct Message {
    std::array<char, 128> text{};
};

[[noreturn]] void on_error(png_structp png, png_const_charp text) {
    auto* message = static_cast<Message*>(png_get_error_ptr(png));
    std::strncpy(message->text.data(), text, message->text.size() - 1);
    png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

// Reading.

// A file of w*h pixels holds at least w*h/8 bytes before compression (1 bit a pixel), and deflate
// shrinks to no less than 1/1032 (zlib's documentation, "Maximum Compression Factor").
constexpr std::uint64_t kMaxPixelsPerByte = 8 * 1032;

struct Reader {
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::span<const std::uint8_t> rest;
    Message message;

    explicit Reader(std::span<const std::uint8_t> bytes) : rest(bytes) {
        png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &message, on_error, ignore_warning);
        if (png != nullptr) info = png_create_info_struct(png);
    }
    ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;
};

void read_bytes(png_structp png, png_bytep out, std::size_t count) {
    auto* reader = static_cast<Reader*>(png_get_io_ptr(png));
    if (count > reader->rest.size()) png_error(png, "it is cut short");
    std::memcpy(out, reader->rest.data(), count);
    reader->rest = reader->rest.subspan(count);
}

void read_header(Reader& reader) {
    png_structp png = reader.png;
    png_set_read_fn(png, &reader, read_bytes);
    png_set_user_limits(png, PNG_UINT_31_MAX,
                        PNG_UINT_31_MAX);  // check_decoded_size says it better
    // Profiles, texts and the like, which libpng would hold in memory whatever their length, are
    // skipped: with a count below 0 this means every chunk but those that the pixels need.
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_read_info(png, reader.info);
}

/// Asks for RGBA of 8 bits whatever the file holds.
void request_rgba8(Reader& reader) {
    png_structp png = reader.png;
    png_set_expand(png);  // palette to RGB, grey to 8 bits, tRNS to alpha
    png_set_scale_16(png);
    png_set_gray_to_rgb(png);
    png_set_add_alpha(png, 0xff, PNG_FILLER_AFTER);
    png_set_interlace_handling(png);
    png_read_update_info(png, reader.info);
}

void read_rows(Reader& reader, std::uint8_t* rgba, std::size_t row_bytes) {
    const int passes = png_get_interlace_type(reader.png, reader.info) == PNG_INTERLACE_ADAM7
                           ? PNG_INTERLACE_ADAM7_PASSES
                           : 1;
    const png_uint_32 height = png_get_image_height(reader.png, reader.info);
    for (int pass = 0; pass < passes; ++pass) {
        for (png_uint_32 y = 0; y < height; ++y) {
            png_read_row(reader.png, rgba + y * row_bytes, nullptr);
        }
    }
    png_read_end(reader.png, nullptr);
}

/// Makes a step of reading. Throws Error{input} when the file is damaged.
template <typename Step>
void read(Reader& reader, std::string_view name, const Step& step) {
    if (!guarded(reader.png, step)) {
        fail_input("{}: is a damaged PNG: {}", name, reader.message.text.data());
    }
}

/// Reads the header. Throws when the picture is larger than what is accepted.
Extent begin(Reader& reader, std::string_view name) {
    if (reader.info == nullptr) fail_machine("{}: out of memory for a PNG reader", name);
    const std::size_t file_bytes = reader.rest.size();
    read(reader, name, [&] { read_header(reader); });
    const Extent size{png_get_image_width(reader.png, reader.info),
                      png_get_image_height(reader.png, reader.info)};
    check_decoded_size(size, file_bytes, kMaxPixelsPerByte, name);
    return size;
}

}  // namespace

Rgba8 decode_png(std::span<const std::uint8_t> bytes, std::string_view name) {
    Reader reader(bytes);
    const Extent size = begin(reader, name);
    read(reader, name, [&] { request_rgba8(reader); });

    const std::size_t row_bytes = kChannelsRgba * size.width;
    if (png_get_rowbytes(reader.png, reader.info) != row_bytes) {
        fail_input("{}: is a damaged PNG: its rows are not of {} pixels", name, size.width);
    }
    Rgba8 picture = blank_picture(size, name);
    std::uint8_t* rgba = picture.rgba.data();
    read(reader, name, [&] { read_rows(reader, rgba, row_bytes); });
    return picture;
}

Rgba16 decode_png_numbers(std::span<const std::uint8_t> bytes, std::string_view name) {
    Reader reader(bytes);
    const Extent size = begin(reader, name);
    const int bits = png_get_bit_depth(reader.png, reader.info);
    if (png_get_color_type(reader.png, reader.info) != PNG_COLOR_TYPE_RGBA || bits < 8 ||
        png_get_interlace_type(reader.png, reader.info) != PNG_INTERLACE_NONE) {
        fail_input("{}: is no RGBA PNG of 8 or 16 bits, row by row", name);
    }
    read(reader, name, [&] {
        if (bits == 16 && std::endian::native == std::endian::little) png_set_swap(reader.png);
        png_read_update_info(reader.png, reader.info);
    });
    const std::size_t row_values = kChannelsRgba * size.width;
    const std::size_t row_bytes = row_values * static_cast<std::size_t>(bits / 8);
    std::vector<std::uint8_t> rows(row_bytes * size.height);
    std::uint8_t* first = rows.data();
    read(reader, name, [&] { read_rows(reader, first, row_bytes); });
    Rgba16 picture{size, bits, std::vector<std::uint16_t>(row_values * size.height)};
    if (bits == 16) {
        std::memcpy(picture.rgba.data(), rows.data(), rows.size());
    } else {
        std::ranges::copy(rows, picture.rgba.begin());
    }
    return picture;
}

// Writing.

namespace {

struct Writer {
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::vector<std::uint8_t> bytes;
    Message message;

    Writer() {
        png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &message, on_error, ignore_warning);
        if (png != nullptr) info = png_create_info_struct(png);
    }
    ~Writer() { png_destroy_write_struct(&png, &info); }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;
};

bool append(std::vector<std::uint8_t>& bytes, png_bytep data, std::size_t count) {
    try {
        bytes.insert(bytes.end(), data, data + count);
        return true;
    } catch (const std::bad_alloc&) {
        return false;  // an exception must not pass through libpng's C frames
    }
}

void write_bytes(png_structp png, png_bytep data, std::size_t count) {
    auto* writer = static_cast<Writer*>(png_get_io_ptr(png));
    if (!append(writer->bytes, data, count)) png_error(png, "out of memory");
}

int colour_type(int channels) {
    switch (channels) {
        case 1:
            return PNG_COLOR_TYPE_GRAY;
        case 3:
            return PNG_COLOR_TYPE_RGB;
        default:
            return PNG_COLOR_TYPE_RGBA;
    }
}

}  // namespace

namespace {

/// `rows`: bytes of each row, one after the other.
std::vector<std::uint8_t> encode(Extent size, int channels, int bits, const std::uint8_t* rows) {
    const std::size_t row_bytes =
        static_cast<std::size_t>(channels) * size.width * static_cast<std::size_t>(bits / 8);
    Writer writer;
    if (writer.info == nullptr) fail_machine("out of memory for a PNG writer");
    const bool done = guarded(writer.png, [&] {
        png_set_write_fn(writer.png, &writer, write_bytes, nullptr);
        png_set_user_limits(writer.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
        png_set_IHDR(writer.png, writer.info, size.width, size.height, bits, colour_type(channels),
                     PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
        png_write_info(writer.png, writer.info);
        if (bits == 16 && std::endian::native == std::endian::little) png_set_swap(writer.png);
        for (unsigned y = 0; y < size.height; ++y)
            png_write_row(writer.png, rows + y * row_bytes);
        png_write_end(writer.png, writer.info);
    });
    if (!done) fail_machine("PNG cannot be encoded: {}", writer.message.text.data());
    return std::move(writer.bytes);
}

}  // namespace

std::vector<std::uint8_t> encode_png8(Extent size, int channels,
                                      std::span<const std::uint8_t> pixels) {
    return encode(size, channels, 8, pixels.data());
}

std::vector<std::uint8_t> encode_png16(Extent size, int channels,
                                       std::span<const std::uint16_t> pixels) {
    return encode(size, channels, 16, reinterpret_cast<const std::uint8_t*>(pixels.data()));
}

}  // namespace image

namespace {

/// The nearest of 256 steps; NaN gives 0.
std::uint8_t quantize(float value) {
    constexpr float kSteps = 255.0f;
    const float clamped = value > 0.0f ? std::min(value, 1.0f) : 0.0f;
    return static_cast<std::uint8_t>(std::lround(clamped * kSteps));
}

}  // namespace

void write_png(const std::filesystem::path& path, const Image& image) {
    if (image.empty() || image.channels() == 2) {
        fail_input("{}: a PNG needs an image of 1, 3 or 4 channels; this one has {}", path.string(),
                   image.channels());
    }
    std::vector<std::uint8_t> pixels(image.pixels().size());
    std::transform(image.pixels().begin(), image.pixels().end(), pixels.begin(), quantize);
    const std::vector<std::uint8_t> file =
        image::encode_png8(image.size(), image.channels(), pixels);
    write_file(path, {reinterpret_cast<const char*>(file.data()), file.size()});
}

}  // namespace gnomon
