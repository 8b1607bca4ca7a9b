#include "bake/kept_blocks.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

namespace gnomon::bake {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

class BlocksOfABake : public testing::Test {
protected:
    void SetUp() override { fs::remove(file_); }
    void TearDown() override { fs::remove(file_); }

    const fs::path file_ =
        fs::temp_directory_path() / ("gnomon_kept_blocks" + std::to_string(::getpid()));
    const std::vector<LitTimes> times_ = std::vector<LitTimes>(3 * kBlockTexels, {{1, 2}});
    const Unfinished unfinished_{file_, 7, times_.size()};
};

TEST_F(BlocksOfABake, AreOnTheDiskOnceItIsTime) {
    KeptBlocks at_once(unfinished_, times_, {0, 0, 0}, 0s);
    at_once.add(2);
    EXPECT_EQ(unfinished_.load().done, (std::vector<std::uint8_t>{0, 0, 1}));
}

TEST_F(BlocksOfABake, AreOnTheDiskAtTheEnd) {
    KeptBlocks later(unfinished_, times_, {0, 1, 0});
    later.add(2);
    EXPECT_FALSE(fs::exists(file_));
    later.save();
    EXPECT_EQ(unfinished_.load().done, (std::vector<std::uint8_t>{0, 1, 1}));
}

TEST_F(BlocksOfABake, OfADiskThatFailsAreNoError) {
    const Unfinished nowhere(file_ / "no folder" / "file", 7, 0);
    KeptBlocks blocks(nowhere, times_, {0, 0, 0}, 0s);
    EXPECT_NO_THROW(blocks.add(1));
    EXPECT_NO_THROW(blocks.save());
}

}  // namespace
}  // namespace gnomon::bake
