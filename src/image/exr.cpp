#include "image/exr.h"

#include <gnomon/error.h>

#include "base/check.h"
#include "base/file.h"

#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfTileDescription.h>
#include <ImfVersion.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <stdexcept>

namespace gnomon {
namespace image {

namespace {

namespace Imf = OPENEXR_IMF_NAMESPACE;

constexpr int kNoThreads = 0;  // of OpenEXR's own pool, which is a global

/// A file in memory. ~OutputFile swallows the errors of its last writes, so writing to a disk
/// through it could lose them; memory has none to lose.
class MemoryWriter : public Imf::OStream {
public:
    MemoryWriter() : Imf::OStream("memory") {}

    void write(const char data[], int count) override {
        const std::size_t length = static_cast<std::size_t>(count);
        bytes.resize(std::max(bytes.size(), position_ + length));
        std::memcpy(bytes.data() + position_, data, length);
        position_ += length;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }

    std::string bytes;

private:
    std::size_t position_ = 0;
};

class MemoryReader : public Imf::IStream {
public:
    explicit MemoryReader(std::span<const std::uint8_t> bytes)
        : Imf::IStream("memory"), bytes_(bytes) {}

    bool read(char out[], int count) override {
        const std::size_t length = static_cast<std::size_t>(count);
        if (count < 0 || position_ > bytes_.size() || length > bytes_.size() - position_) {
            throw std::runtime_error("it is cut short");
        }
        std::memcpy(out, bytes_.data() + position_, length);
        position_ += length;
        return position_ < bytes_.size();
    }
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = position; }

private:
    std::span<const std::uint8_t> bytes_;
    std::size_t position_ = 0;
};

std::span<const char* const> channel_names(int channels) {
    static constexpr std::array<const char*, 1> kGrey = {"Y"};
    static constexpr std::array<const char*, 4> kRgba = {"R", "G", "B", "A"};
    if (channels == 1) return kGrey;
    return std::span(kRgba).first(static_cast<std::size_t>(channels));
}

/// The slices of an interleaved float picture whose pixel (x0, y0) is at `pixels`.
Imf::FrameBuffer slices(float* pixels, Extent size, int channels, int x0, int y0) {
    const std::size_t pixel_bytes = static_cast<std::size_t>(channels) * sizeof(float);
    const std::size_t row_bytes = pixel_bytes * size.width;
    Imf::FrameBuffer result;
    for (const char* name : channel_names(channels)) {
        // OpenEXR addresses base + x * pixel_bytes + y * row_bytes; the origin of the data window
        // may be anywhere, and the base then lies outside the pixels: hence integers.
        const auto base = reinterpret_cast<std::uintptr_t>(pixels++) -
                          static_cast<std::uintptr_t>(x0) * pixel_bytes -
                          static_cast<std::uintptr_t>(y0) * row_bytes;
        result.insert(
            name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(base), pixel_bytes, row_bytes));
    }
    return result;
}

/// 1, 3 or 4, or throws when the file has other channels than Y or R, G, B, (A).
int channels_of(const Imf::ChannelList& list, std::string_view name) {
    std::string found;
    for (auto channel = list.begin(); channel != list.end(); ++channel) {
        if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1) {
            fail_input("{}: its channel {} is subsampled; save it at full resolution", name,
                       channel.name());
        }
        found += found.empty() ? "" : ", ";
        found += channel.name();
    }
    if (found == "Y") return 1;
    if (found == "B, G, R") return 3;  // OpenEXR sorts by name
    if (found == "A, B, G, R") return 4;
    fail_input("{}: has the channels {}; it must have Y, or R, G, B and perhaps A", name, found);
}

/// Reads the header alone: InputFile's constructor allocates what the header claims.
Imf::Header read_header(MemoryReader& stream, std::string_view name) {
    std::array<char, 8> start{};  // magic number and version, little-endian
    stream.read(start.data(), static_cast<int>(start.size()));
    int version = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        version |= static_cast<int>(static_cast<std::uint8_t>(start[4 + i])) << (8 * i);
    }
    if (!Imf::isImfMagic(start.data())) fail_input("{}: is no OpenEXR file", name);
    if (Imf::isMultiPart(version) || Imf::isNonImage(version)) {
        fail_input("{}: is a deep or multi-part OpenEXR file; save one flat picture", name);
    }
    Imf::Header header;
    header.readFrom(stream, version);
    stream.seekg(0);
    return header;
}

/// The most bytes of floats that a byte of the file can become.
std::uint64_t greatest_expansion(Imf::Compression compression) {
    constexpr std::uint64_t kDeflate = 1032;     // zlib's documentation, and more than the others
    constexpr std::uint64_t kFloatFromHalf = 2;  // also covers PXR24, which stores 24 bits of 32
    constexpr std::uint64_t kDwaRuns = 128;  // DWA deflates what it has already run-length coded
    const bool dwa = compression == Imf::DWAA_COMPRESSION || compression == Imf::DWAB_COMPRESSION;
    return kDeflate * kFloatFromHalf * (dwa ? kDwaRuns : 1);
}

/// The least number of chunks that the picture is stored in.
std::int64_t least_chunks(const Imf::Header& header, std::int64_t width, std::int64_t height) {
    constexpr std::int64_t kMostLinesPerChunk = 256;  // DWAB compression
    if (!header.hasTileDescription()) return height / kMostLinesPerChunk;
    const Imf::TileDescription& tile = header.tileDescription();
    return (width / std::max<std::int64_t>(tile.xSize, 1)) *
           (height / std::max<std::int64_t>(tile.ySize, 1));
}

/// Throws when the header claims more than can be read, or than so short a file can hold.
void check_claim(const Imf::Header& header, std::uint64_t file_bytes, int channels,
                 std::string_view name) {
    constexpr std::uint64_t kBytesPerChunk = 8;  // its offset in the table, if nothing else
    const IMATH_NAMESPACE::Box2i& window = header.dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    if (width < 1 || height < 1 || width > Image::kMaxSide_px || height > Image::kMaxSide_px ||
        static_cast<std::uint64_t>(width * height * channels) > kMaxExrValues) {
        fail_input("{}: is {}x{} pixels with {} channels; at most {} values can be read", name,
                   width, height, channels, kMaxExrValues);
    }
    const auto chunks = static_cast<std::uint64_t>(least_chunks(header, width, height));
    const auto bytes = static_cast<std::uint64_t>(width * height * channels) * sizeof(float);
    if (chunks > file_bytes / kBytesPerChunk ||
        bytes > file_bytes * greatest_expansion(header.compression())) {
        fail_input("{}: is cut short: {} bytes cannot hold {}x{} pixels", name, file_bytes, width,
                   height);
    }
}

Image read_pixels(std::span<const std::uint8_t> bytes, std::string_view name) {
    MemoryReader stream(bytes);
    const Imf::Header header = read_header(stream, name);
    const int channels = channels_of(header.channels(), name);
    check_claim(header, bytes.size(), channels, name);
    Imf::InputFile file(stream, kNoThreads);
    const IMATH_NAMESPACE::Box2i& window = header.dataWindow();
    const Extent size{static_cast<unsigned>(window.max.x - window.min.x + 1),
                      static_cast<unsigned>(window.max.y - window.min.y + 1)};
    Image image(size, channels);
    file.setFrameBuffer(slices(image.pixels().data(), size, channels, window.min.x, window.min.y));
    file.readPixels(window.min.y, window.max.y);
    return image;
}

}  // namespace

std::string encode_exr(const Image& image) {
    Imf::Header header(static_cast<int>(image.width()), static_cast<int>(image.height()));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const char* name : channel_names(image.channels())) {
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    }
    MemoryWriter stream;
    {
        Imf::OutputFile file(stream, header, kNoThreads);
        // OpenEXR only reads through these slices.
        float* pixels = const_cast<float*>(image.pixels().data());
        file.setFrameBuffer(slices(pixels, image.size(), image.channels(), 0, 0));
        file.writePixels(static_cast<int>(image.height()));
    }  // its destructor completes the table of scan lines
    return std::move(stream.bytes);
}

Image decode_exr(std::span<const std::uint8_t> bytes, std::string_view name) {
    try {
        return read_pixels(bytes, name);
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        std::string text = error.what();
        std::replace(text.begin(), text.end(), '\n', ' ');  // an Error is one line
        fail_input("{}: is no OpenEXR picture or a damaged one: {}", name, text);
    }
}

}  // namespace image

void write_exr(const std::filesystem::path& path, const Image& image) {
    if (image.empty() || image.channels() == 2) {
        fail_input("{}: an OpenEXR file needs an image of 1, 3 or 4 channels; this one has {}",
                   path.string(), image.channels());
    }
    std::string bytes;
    try {
        bytes = image::encode_exr(image);
    } catch (const std::exception& error) {
        fail_machine("{}: cannot be encoded: {}", path.string(), error.what());
    }
    write_file(path, bytes);
}

Image read_exr(const std::filesystem::path& path) {
    // Uncompressed is the greatest there can be, but for a header and a table of lines.
    constexpr std::uint64_t kMaxFile_bytes = 2 * image::kMaxExrValues * sizeof(float);
    return image::decode_exr(read_file(path, kMaxFile_bytes), path.string());
}

}  // namespace gnomon
