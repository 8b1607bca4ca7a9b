#include "image/exr.h"

#include <gnomon/error.h>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <limits>

namespace gnomon {
namespace {

namespace fs = std::filesystem;
namespace Imf = OPENEXR_IMF_NAMESPACE;
using IMATH_NAMESPACE::Box2i;
using IMATH_NAMESPACE::V2i;

fs::path temporary(const char* name) {
    return fs::path(testing::TempDir()) / name;
}

std::span<const std::uint8_t> as_bytes(const std::string& text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

Image pattern(Extent size, int channels) {
    Image image(size, channels);
    for (std::size_t i = 0; i < image.pixels().size(); ++i) {
        image.pixels()[i] = 1.0f / static_cast<float>(i + 1);
    }
    return image;
}

TEST(Exr, ReturnsTheVeryFloats) {
    const fs::path path = temporary("gnomon_exr_test.exr");
    for (const int channels : {1, 3, 4}) {
        Image image = pattern({37, 23}, channels);
        image.pixels()[0] = -std::numeric_limits<float>::infinity();
        image.pixels()[1] = std::numeric_limits<float>::quiet_NaN();
        image.pixels()[2] = std::numeric_limits<float>::denorm_min();
        write_exr(path, image);
        const Image read = read_exr(path);
        ASSERT_EQ(read.size(), image.size());
        ASSERT_EQ(read.channels(), channels);
        EXPECT_EQ(
            std::memcmp(read.pixels().data(), image.pixels().data(), image.pixels().size_bytes()),
            0);
    }
    fs::remove(path);
}

TEST(Exr, ReadsTiledHalvesInAnOffsetDataWindow) {
    const std::string path = temporary("gnomon_exr_tiled.exr").string();
    constexpr int kWidth = 21;
    constexpr int kHeight = 10;
    const V2i origin(-5, 7);
    Imf::Header header(Box2i(V2i(0, 0), V2i(63, 63)),
                       Box2i(origin, origin + V2i(kWidth - 1, kHeight - 1)));
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    header.setTileDescription(Imf::TileDescription(8, 8, Imf::ONE_LEVEL));
    std::vector<half> values(kWidth * kHeight);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<float>(i);
    {
        Imf::TiledOutputFile file(path.c_str(), header);
        Imf::FrameBuffer buffer;
        buffer.insert("Y", Imf::Slice::Make(Imf::HALF, values.data(), header.dataWindow()));
        file.setFrameBuffer(buffer);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    }
    const Image read = read_exr(path);
    ASSERT_EQ(read.size(), (Extent{kWidth, kHeight}));
    for (std::size_t i = 0; i < values.size(); ++i) {
        EXPECT_EQ(read.pixels()[i], static_cast<float>(i));  // a half holds integers to 2048
    }
    fs::remove(path);
}

void write_zeros(const std::string& path, const Imf::Header& header) {
    Imf::OutputFile file(path.c_str(), header);
    Imf::FrameBuffer buffer;  // channels without a slice are written as 0
    file.setFrameBuffer(buffer);
    file.writePixels(header.dataWindow().max.y - header.dataWindow().min.y + 1);
}

TEST(Exr, RefusesOtherChannels) {
    const std::string path = temporary("gnomon_exr_channels.exr").string();
    for (const auto& names : {std::vector{"Z"}, std::vector{"R", "G"}, std::vector{"Y", "A"}}) {
        Imf::Header header(4, 4);
        for (const char* name : names)
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        write_zeros(path, header);
        EXPECT_THROW(read_exr(path), Error);
    }
    Imf::Header subsampled(4, 4);
    subsampled.channels().insert("Y", Imf::Channel(Imf::FLOAT, 2, 2));
    write_zeros(path, subsampled);
    EXPECT_THROW(read_exr(path), Error);
    fs::remove(path);
}

TEST(Exr, RefusesEveryTruncation) {
    const std::string file = image::encode_exr(pattern({16, 40}, 3));
    for (std::size_t length = 0; length < file.size(); ++length) {
        try {
            image::decode_exr(as_bytes(file).first(length), "cut.exr");
            ADD_FAILURE() << "accepted " << length << " of " << file.size() << " bytes";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            EXPECT_EQ(std::string_view(error.what()).substr(0, 8), "cut.exr:");
        }
    }
}

TEST(Exr, SurvivesEveryChangedByte) {
    const std::string good = image::encode_exr(pattern({9, 20}, 1));
    for (std::size_t i = 0; i < good.size(); ++i) {
        for (const char flip : {'\x01', '\x80', '\xff'}) {
            std::string bad = good;
            bad[i] = static_cast<char>(bad[i] ^ flip);
            try {
                const Image read = image::decode_exr(as_bytes(bad), "bad.exr");
                EXPECT_LE(read.pixels().size(), image::kMaxExrValues);
            } catch (const Error& error) {
                EXPECT_EQ(error.kind(), ErrorKind::input);
                EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
            }
        }
    }
}

TEST(Exr, RefusesAHugeClaimBeforeAllocatingIt) {
    std::string file = image::encode_exr(pattern({4, 4}, 1));
    const std::size_t window = file.find("dataWindow") + std::strlen("dataWindow") + 1 +
                               std::strlen("box2i") + 1 + 4;  // name, type, length
    const std::int32_t far = 65'535;
    std::memcpy(file.data() + window + 8, &far, sizeof(far));   // max.x
    std::memcpy(file.data() + window + 12, &far, sizeof(far));  // max.y
    EXPECT_THROW(image::decode_exr(as_bytes(file), "huge.exr"), Error);
}

TEST(Exr, NamesWhatItCannotOpenOrWrite) {
    EXPECT_THROW(read_exr(temporary("gnomon_no_such_file.exr")), Error);
    EXPECT_THROW(read_exr(testing::TempDir()), Error);
    EXPECT_THROW(write_exr(temporary("gnomon_no_such_folder") / "a.exr", pattern({1, 1}, 1)),
                 Error);
    EXPECT_THROW(write_exr(temporary("a.exr"), Image({1, 1}, 2)), Error);
}

}  // namespace
}  // namespace gnomon
