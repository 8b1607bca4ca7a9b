#include "image/decode.h"

#include <gnomon/error.h>

#include "image/codec.h"

#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

// clang-format off
#include <jpeglib.h>  // after <cstdio>, for its FILE
// clang-format on

namespace gnomon::image {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::string error_of(std::span<const std::uint8_t> bytes) {
    try {
        decode(bytes, "wood.png");
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_EQ(std::string_view(error.what()).substr(0, 10), "wood.png: ");
        EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
        return error.what();
    }
    return {};
}

// PNG.

/// A PNG of random samples, and the pixels that they mean by the PNG specification.
struct PngCase {
    int colour_type;
    int depth_bits;
    bool interlaced;
    bool transparency;  // a tRNS chunk
};

constexpr Extent kSize = {19, 13};  // no multiple of Adam7's 8, nor of the samples in a byte
constexpr std::size_t kPaletteSize = 5;

unsigned samples_per_pixel(int colour_type) {
    switch (colour_type) {
        case PNG_COLOR_TYPE_RGB:
            return 3;
        case PNG_COLOR_TYPE_GRAY_ALPHA:
            return 2;
        case PNG_COLOR_TYPE_RGBA:
            return 4;
        default:
            return 1;
    }
}

/// Samples of the given depth, most significant first, each row begun on a byte.
Bytes pack(const std::vector<unsigned>& samples, std::size_t row_samples, int depth_bits) {
    Bytes packed;
    for (std::size_t row = 0; row < samples.size(); row += row_samples) {
        int free_bits = 0;
        for (std::size_t i = 0; i < row_samples; ++i) {
            for (int bit = depth_bits - 1; bit >= 0; --bit) {
                if (free_bits == 0) {
                    packed.push_back(0);
                    free_bits = 8;
                }
                --free_bits;
                packed.back() |=
                    static_cast<std::uint8_t>((samples[row + i] >> bit & 1u) << free_bits);
            }
        }
    }
    return packed;
}

png_color palette_colour(std::size_t i) {
    return {static_cast<png_byte>(10 * i), static_cast<png_byte>(200 - i),
            static_cast<png_byte>(i * i)};
}

/// The number of colours in a palette; the last is opaque.
std::size_t colours(int depth_bits) {
    return std::min(kPaletteSize, std::size_t{1} << depth_bits);
}

std::uint8_t palette_alpha(std::size_t i) {
    return static_cast<std::uint8_t>(60 * i);
}

void describe_transparency(png_structp png, png_infop info, const PngCase& test,
                           const std::vector<unsigned>& samples) {
    if (!test.transparency) return;
    png_byte alpha[kPaletteSize];
    for (std::size_t i = 0; i < kPaletteSize; ++i)
        alpha[i] = palette_alpha(i);
    png_color_16 key{};  // the first pixel's colour
    key.gray = static_cast<png_uint_16>(samples[0]);
    key.red = static_cast<png_uint_16>(samples[0]);
    if (test.colour_type == PNG_COLOR_TYPE_RGB) {
        key.green = static_cast<png_uint_16>(samples[1]);
        key.blue = static_cast<png_uint_16>(samples[2]);
    }
    const bool palette = test.colour_type == PNG_COLOR_TYPE_PALETTE;
    // tRNS may be shorter than the palette; the rest is opaque.
    const int count = palette ? static_cast<int>(colours(test.depth_bits)) - 1 : 0;
    png_set_tRNS(png, info, palette ? alpha : nullptr, count, &key);
}

Bytes png_file(const PngCase& test, const std::vector<unsigned>& samples) {
    Bytes file;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    const auto append = [](png_structp writer, png_bytep data, std::size_t count) {
        auto* out = static_cast<Bytes*>(png_get_io_ptr(writer));
        out->insert(out->end(), data, data + count);
    };
    png_set_write_fn(png, &file, append, nullptr);
    png_set_IHDR(png, info, kSize.width, kSize.height, test.depth_bits, test.colour_type,
                 test.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (test.colour_type == PNG_COLOR_TYPE_PALETTE) {
        png_color palette[kPaletteSize];
        const std::size_t count = colours(test.depth_bits);
        for (std::size_t i = 0; i < count; ++i)
            palette[i] = palette_colour(i);
        png_set_PLTE(png, info, palette, static_cast<int>(count));
    }
    describe_transparency(png, info, test, samples);
    png_write_info(png, info);
    const std::size_t row_samples = kSize.width * samples_per_pixel(test.colour_type);
    Bytes packed = pack(samples, row_samples, test.depth_bits);
    const std::size_t row_bytes = packed.size() / kSize.height;
    std::vector<png_bytep> rows;
    for (std::size_t y = 0; y < kSize.height; ++y)
        rows.push_back(packed.data() + y * row_bytes);
    png_write_image(png, rows.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return file;
}

std::vector<unsigned> random_samples(const PngCase& test, std::mt19937& random) {
    const bool palette = test.colour_type == PNG_COLOR_TYPE_PALETTE;
    const std::size_t values =
        palette ? colours(test.depth_bits) : std::size_t{1} << test.depth_bits;
    std::vector<unsigned> samples(kSize.width * kSize.height * samples_per_pixel(test.colour_type));
    for (unsigned& sample : samples)
        sample = static_cast<unsigned>(random() % values);
    return samples;
}

/// A sample of any depth as the nearest of 8 bits.
std::uint8_t to_8_bits(unsigned sample, int depth_bits) {
    const double greatest = (1u << depth_bits) - 1u;
    return static_cast<std::uint8_t>(sample / greatest * 255.0 + 0.5);
}

std::array<std::uint8_t, 4> expected_pixel(const PngCase& test,
                                           const std::vector<unsigned>& samples,
                                           std::size_t pixel) {
    const unsigned count = samples_per_pixel(test.colour_type);
    const unsigned* s = &samples[pixel * count];
    if (test.colour_type == PNG_COLOR_TYPE_PALETTE) {
        const png_color colour = palette_colour(s[0]);
        return {colour.red, colour.green, colour.blue,
                test.transparency && s[0] + 1 < colours(test.depth_bits) ? palette_alpha(s[0])
                                                                         : std::uint8_t{255}};
    }
    const auto value = [&](unsigned i) { return to_8_bits(s[i], test.depth_bits); };
    const bool grey = count < 3;
    const bool keyed = test.transparency && std::equal(s, s + count, samples.begin());
    const bool has_alpha = count % 2 == 0;
    return {value(0), value(grey ? 0 : 1), value(grey ? 0 : 2),
            has_alpha ? value(count - 1) : static_cast<std::uint8_t>(keyed ? 0 : 255)};
}

std::vector<PngCase> png_cases() {
    std::vector<PngCase> cases;
    const auto add = [&](int colour_type, std::initializer_list<int> depths, bool may_have_trns) {
        for (const int depth : depths) {
            for (const bool interlaced : {false, true}) {
                cases.push_back({colour_type, depth, interlaced, false});
                if (may_have_trns) cases.push_back({colour_type, depth, interlaced, true});
            }
        }
    };
    add(PNG_COLOR_TYPE_GRAY, {1, 2, 4, 8, 16}, true);
    add(PNG_COLOR_TYPE_RGB, {8, 16}, true);
    add(PNG_COLOR_TYPE_PALETTE, {1, 2, 4, 8}, true);
    add(PNG_COLOR_TYPE_GRAY_ALPHA, {8, 16}, false);
    add(PNG_COLOR_TYPE_RGBA, {8, 16}, false);
    return cases;
}

TEST(DecodePng, ReadsEveryColourTypeDepthAndInterlacing) {
    std::mt19937 random(1);
    for (const PngCase& test : png_cases()) {
        SCOPED_TRACE(testing::Message()
                     << "colour type " << test.colour_type << ", " << test.depth_bits << " bits"
                     << (test.interlaced ? ", interlaced" : "")
                     << (test.transparency ? ", tRNS" : ""));
        const std::vector<unsigned> samples = random_samples(test, random);
        const Rgba8 picture = decode(png_file(test, samples), "case.png");
        ASSERT_EQ(picture.size, kSize);
        for (std::size_t i = 0; i < samples.size() / samples_per_pixel(test.colour_type); ++i) {
            const std::array<std::uint8_t, 4> expected = expected_pixel(test, samples, i);
            for (std::size_t c = 0; c < 4; ++c) {
                ASSERT_EQ(picture.rgba[4 * i + c], expected[c]) << "pixel " << i << ", " << c;
            }
        }
    }
}

Rgba8 noise(Extent size) {
    Rgba8 picture{size, Bytes(std::size_t{4} * size.width * size.height)};
    std::mt19937 random(2);
    for (std::uint8_t& value : picture.rgba)
        value = static_cast<std::uint8_t>(random());
    return picture;
}

TEST(EncodePng, DecodesToTheSamePixelsAndIsDeterministic) {
    const Rgba8 picture = noise({31, 17});
    const Bytes file = encode_png(picture);
    EXPECT_EQ(file, encode_png(picture));
    const Rgba8 read = decode(file, "again.png");
    EXPECT_EQ(read.size, picture.size);
    EXPECT_EQ(read.rgba, picture.rgba);
}

TEST(DecodePng, RefusesEveryTruncation) {
    const Bytes file = encode_png(noise({9, 5}));
    for (std::size_t length = 0; length < file.size(); ++length) {
        EXPECT_NE(error_of(std::span(file).first(length)), "") << length;
    }
}

TEST(DecodePng, SurvivesEveryChangedByte) {
    const Bytes good = encode_png(noise({9, 5}));
    for (std::size_t i = 0; i < good.size(); ++i) {
        Bytes bad = good;
        bad[i] ^= 0x21;
        EXPECT_NE(error_of(bad), "") << "byte " << i << " is under no checksum";
    }
}

/// Changes the size that a PNG claims, with the checksum made right.
Bytes with_size(Bytes file, Extent size) {
    constexpr std::size_t kHeader = 8 + 4;  // signature, length; then the type "IHDR"
    const auto put = [&](std::size_t at, std::uint32_t value) {
        for (std::size_t i = 0; i < 4; ++i) {
            file[at + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
        }
    };
    put(kHeader + 4, size.width);
    put(kHeader + 8, size.height);
    put(kHeader + 17, static_cast<std::uint32_t>(crc32(0, file.data() + kHeader, 17)));
    return file;
}

TEST(DecodePng, RefusesHugeClaimsBeforeAllocatingThem) {
    const Bytes file = encode_png(noise({9, 5}));
    EXPECT_NE(error_of(with_size(file, {16'385, 1})).find("16385x1"), std::string::npos);
    EXPECT_NE(error_of(with_size(file, {16'384, 16'384})).find("at most"), std::string::npos);
    EXPECT_NE(error_of(with_size(file, {8'192, 8'192})).find("cut short"), std::string::npos);
    EXPECT_NE(error_of(with_size(file, {0xffffffff, 2})), "");
    EXPECT_NE(error_of(with_size(file, {0, 5})), "");
    EXPECT_NE(error_of(with_size(file, {9, 6})), "");
    EXPECT_EQ(error_of(with_size(file, {9, 5})), "");
}

TEST(Decode, RefusesOtherFormats) {
    const std::string gif = "GIF89a and so on";
    const Bytes bytes(gif.begin(), gif.end());
    EXPECT_NE(error_of(bytes).find("neither PNG nor JPEG"), std::string::npos);
    EXPECT_NE(error_of({}).find("empty"), std::string::npos);
}

// JPEG.

struct JpegCase {
    J_COLOR_SPACE space;
    int channels;
    bool progressive;
};

constexpr Extent kJpegSize = {37, 29};

/// Smooth, so that it survives compression: what is tested is the order of rows and channels.
std::uint8_t jpeg_sample(unsigned x, unsigned y, int channel) {
    const unsigned values[] = {6 * x, 8 * y, 255 - 3 * (x + y)};
    return static_cast<std::uint8_t>(values[channel % 3]);
}

template <typename Sample>
Bytes jpeg_file(const JpegCase& test, Extent size, const Sample& sample) {
    jpeg_compress_struct codec{};
    jpeg_error_mgr errors{};
    codec.err = jpeg_std_error(&errors);
    jpeg_create_compress(&codec);
    unsigned char* data = nullptr;
    unsigned long length = 0;
    jpeg_mem_dest(&codec, &data, &length);
    codec.image_width = size.width;
    codec.image_height = size.height;
    codec.input_components = test.channels;
    codec.in_color_space = test.space;
    jpeg_set_defaults(&codec);
    jpeg_set_quality(&codec, 100, TRUE);
    codec.comp_info[0].h_samp_factor = 1;  // chroma at full resolution
    codec.comp_info[0].v_samp_factor = 1;
    if (test.progressive) jpeg_simple_progression(&codec);
    jpeg_start_compress(&codec, TRUE);
    for (unsigned y = 0; y < size.height; ++y) {
        Bytes row;
        for (unsigned x = 0; x < size.width; ++x) {
            for (int c = 0; c < test.channels; ++c)
                row.push_back(sample(x, y, c));
        }
        unsigned char* rows[] = {row.data()};
        jpeg_write_scanlines(&codec, rows, 1);
    }
    jpeg_finish_compress(&codec);
    jpeg_destroy_compress(&codec);
    Bytes file(data, data + length);
    std::free(data);
    return file;
}

Bytes jpeg_file(const JpegCase& test) {
    return jpeg_file(test, kJpegSize, jpeg_sample);
}

const std::array<JpegCase, 4> kJpegCases = {
    {{JCS_RGB, 3, false}, {JCS_RGB, 3, true}, {JCS_GRAYSCALE, 1, false}, {JCS_GRAYSCALE, 1, true}}};

TEST(DecodeJpeg, ReadsGreyAndColour) {
    // At quality 100 a coefficient is rounded by 1/2, eight-bit YCbCr by 1/2 more: with the factor
    // 1.77 of blue, 3 steps of 255.
    constexpr int kTolerance = 3;
    for (const JpegCase& test : kJpegCases) {
        const Rgba8 picture = decode(jpeg_file(test), "case.jpg");
        ASSERT_EQ(picture.size, kJpegSize);
        for (unsigned y = 0; y < kJpegSize.height; ++y) {
            for (unsigned x = 0; x < kJpegSize.width; ++x) {
                const std::uint8_t* pixel = &picture.rgba[4 * (y * kJpegSize.width + x)];
                for (int c = 0; c < 3; ++c) {
                    const int expected = jpeg_sample(x, y, test.channels == 1 ? 0 : c);
                    ASSERT_NEAR(pixel[c], expected, kTolerance) << x << ", " << y << ", " << c;
                }
                ASSERT_EQ(pixel[3], 255);
            }
        }
    }
}

TEST(DecodeJpeg, RefusesEveryTruncation) {
    for (const JpegCase& test : kJpegCases) {
        const Bytes file = jpeg_file(test);
        for (std::size_t length = 0; length < file.size(); ++length) {
            EXPECT_NE(error_of(std::span(file).first(length)), "") << length;
        }
    }
}

TEST(DecodeJpeg, SurvivesEveryChangedByte) {
    for (const JpegCase& test : kJpegCases) {
        const Bytes good = jpeg_file(test);
        for (std::size_t i = 0; i < good.size(); ++i) {
            Bytes bad = good;
            bad[i] ^= 0x5a;
            error_of(bad);  // JPEG has no checksum: it may decode, or throw what error_of expects
        }
    }
}

TEST(DecodeJpeg, RefusesCmyk) {
    EXPECT_NE(error_of(jpeg_file({JCS_CMYK, 4, false})).find("CMYK"), std::string::npos);
}

std::size_t start_of_frame(const Bytes& file) {
    for (std::size_t i = 0; i + 1 < file.size(); ++i) {
        if (file[i] == 0xff && (file[i + 1] == 0xc0 || file[i + 1] == 0xc2)) return i;
    }
    ADD_FAILURE() << "no SOF marker";
    return 0;
}

TEST(DecodeJpeg, RefusesHugeClaimsBeforeAllocatingThem) {
    for (const JpegCase& test : kJpegCases) {
        Bytes file = jpeg_file(test);
        const std::size_t sides = start_of_frame(file) + 5;  // after marker, length and precision
        file[sides] = file[sides + 2] = 0x40;                // 16,384 or a little more
        EXPECT_NE(error_of(file).find("at most"), std::string::npos);
        file[sides] = file[sides + 2] = 0x1f;  // about 8,000
        EXPECT_NE(error_of(file).find("cut short"), std::string::npos);
    }
}

/// The second scan of a progressive file, from its marker to the next: the first of AC
/// coefficients.
std::span<const std::uint8_t> second_scan(const Bytes& file) {
    const auto find = [&](std::size_t from, const auto& is_wanted) {
        while (from + 1 < file.size() && !(file[from] == 0xff && is_wanted(file[from + 1])))
            ++from;
        return from;
    };
    const auto is_scan = [](std::uint8_t marker) { return marker == 0xda; };
    const auto is_marker = [](std::uint8_t marker) { return marker != 0x00; };
    const std::size_t first = find(find(2, is_scan) + 2, is_scan);
    return std::span(file).subspan(first, find(first + 2, is_marker) - first);
}

TEST(DecodeJpeg, RefusesEndlessScans) {
    // In a picture of one grey an AC scan takes a few bytes but a pass over every block, and
    // nothing forbids its repetition. 2048² pixels may have 512 scans.
    constexpr unsigned kSide = 2048;
    const auto grey = [](unsigned, unsigned, int) { return std::uint8_t{90}; };
    const Bytes good = jpeg_file({JCS_GRAYSCALE, 1, true}, {kSide, kSide}, grey);
    EXPECT_EQ(error_of(good), "");
    const std::span<const std::uint8_t> scan = second_scan(good);
    const auto after = good.begin() + (scan.data() + scan.size() - good.data());
    Bytes bomb(good.begin(), after);
    for (int i = 0; i < 600; ++i)
        bomb.insert(bomb.end(), scan.begin(), scan.end());
    bomb.insert(bomb.end(), after, good.end());
    EXPECT_NE(error_of(bomb).find("more than 512 scans"), std::string::npos);
}

}  // namespace
}  // namespace gnomon::image
