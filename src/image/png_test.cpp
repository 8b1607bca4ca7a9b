#include <gnomon/error.h>
#include <gnomon/image.h>

#include "base/file.h"
#include "image/decode.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <limits>

namespace gnomon {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxTestFile_bytes = 1 << 20;

/// An empty folder that goes with the test.
class Folder {
public:
    Folder() : path_(fs::path(testing::TempDir()) / "gnomon_png_test") {
        fs::remove_all(path_);
        fs::create_directories(path_);
    }
    ~Folder() { fs::remove_all(path_); }
    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

/// Writing beyond a limit fails, as on a full disk.
class FullDisk {
public:
    explicit FullDisk(rlim_t max_bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &old_limit_);
        const rlimit limit{max_bytes, old_limit_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FullDisk() {
        setrlimit(RLIMIT_FSIZE, &old_limit_);
        std::signal(SIGXFSZ, old_handler_);
    }

private:
    rlimit old_limit_{};
    void (*old_handler_)(int);
};

ErrorKind kind_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.kind();
    }
    ADD_FAILURE() << "nothing was thrown";
    return ErrorKind::cancelled;
}

TEST(WritePng, RoundsAndClampsToEightBits) {
    const Folder folder;
    Image image({6, 1}, 1);
    const float values[] = {-1.0f,           0.0f, 100.4f / 255.0f,
                            100.6f / 255.0f, 2.0f, std::numeric_limits<float>::quiet_NaN()};
    std::copy(std::begin(values), std::end(values), image.pixels().begin());
    write_png(folder.path() / "grey.png", image);
    const image::Rgba8 read =
        image::decode(read_file(folder.path() / "grey.png", kMaxTestFile_bytes), "grey.png");
    ASSERT_EQ(read.size, image.size());
    const std::uint8_t expected[] = {0, 0, 100, 101, 255, 0};
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(read.rgba[4 * i], expected[i]);
        EXPECT_EQ(read.rgba[4 * i + 2], expected[i]);
        EXPECT_EQ(read.rgba[4 * i + 3], 255);
    }
}

TEST(WritePng, KeepsColourAndAlpha) {
    const Folder folder;
    for (const int channels : {3, 4}) {
        Image image({5, 7}, channels);
        for (std::size_t i = 0; i < image.pixels().size(); ++i) {
            image.pixels()[i] = static_cast<float>(i) / 255.0f;
        }
        write_png(folder.path() / "colour.png", image);
        const image::Rgba8 read =
            image::decode(read_file(folder.path() / "colour.png", kMaxTestFile_bytes), "x");
        ASSERT_EQ(read.size, image.size());
        for (std::size_t i = 0; i < 35; ++i) {
            for (std::size_t c = 0; c < 4; ++c) {
                const std::size_t step = static_cast<std::size_t>(channels);
                EXPECT_EQ(read.rgba[4 * i + c], c < step ? i * step + c : 255);
            }
        }
    }
}

TEST(WritePng, ThrowsMachineErrorAndLeavesNothingWhenItCannotWrite) {
    const Folder folder;
    Image noise({64, 64}, 3);
    for (std::size_t i = 0; i < noise.pixels().size(); ++i) {
        noise.pixels()[i] = static_cast<float>(i * i % 251) / 251.0f;
    }
    const fs::path missing = folder.path() / "missing" / "a.png";
    EXPECT_EQ(kind_of([&] { write_png(missing, noise); }), ErrorKind::machine);
    {
        const FullDisk full(100);  // bytes: less than the header and the first row
        EXPECT_EQ(kind_of([&] { write_png(folder.path() / "a.png", noise); }), ErrorKind::machine);
    }
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(WritePng, KeepsTheOldFileWhenItCannotWrite) {
    const Folder folder;
    const fs::path path = folder.path() / "a.png";
    write_png(path, Image({1, 1}, 1));
    const std::vector<std::uint8_t> before = read_file(path, kMaxTestFile_bytes);
    {
        const FullDisk full(10);
        EXPECT_THROW(write_png(path, Image({2, 2}, 1)), Error);
    }
    EXPECT_EQ(read_file(path, kMaxTestFile_bytes), before);
}

TEST(WritePng, RefusesImagesThatNoPngHolds) {
    const Folder folder;
    EXPECT_EQ(kind_of([&] {
                  write_png(folder.path() / "a.png", Image({1, 1}, 2));
              }),
              ErrorKind::input);
    EXPECT_EQ(kind_of([&] { write_png(folder.path() / "a.png", Image()); }), ErrorKind::input);
}

}  // namespace
}  // namespace gnomon
