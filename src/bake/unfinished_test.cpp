#include "bake/unfinished.h"

#include <gnomon/error.h>

#include "base/file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

namespace gnomon::bake {
namespace {

namespace fs = std::filesystem;

class UnfinishedBake : public testing::Test {
protected:
    void TearDown() override { fs::remove(file_); }

    fs::path file_ =
        fs::temp_directory_path() / ("gnomon_unfinished_" + std::to_string(::getpid()));
    /// Of two blocks and some texels of a third; the middle one is not done.
    static constexpr std::size_t kTexels = 2 * kBlockTexels + 5;
    const std::vector<std::uint8_t> done_{1, 0, 1};
    const std::vector<LitTimes> times_ = [] {
        std::vector<LitTimes> times(kTexels);
        for (std::size_t i = 0; i < kTexels; ++i) {
            if (i % 3 != 1) times[i] = {{0, static_cast<std::uint16_t>(i + 1)}, {2000, 65472}};
        }
        return times;
    }();

    Unfinished of(std::uint64_t fingerprint, std::size_t texels = kTexels) const {
        return Unfinished(file_, fingerprint, texels);
    }
};

TEST_F(UnfinishedBake, IsReadAsItWasWritten) {
    EXPECT_EQ(of(7).load().done, std::vector<std::uint8_t>(3, 0));
    of(7).save(times_, std::vector<std::uint8_t>(3, 0));
    EXPECT_FALSE(fs::exists(file_));  // nothing is done
    of(7).save(times_, done_);
    const FoundTimes found = of(7).load();
    EXPECT_EQ(found.done, done_);
    ASSERT_EQ(found.times.size(), kTexels);
    for (std::size_t i = 0; i < kTexels; ++i)
        EXPECT_EQ(found.times[i], done_[i / kBlockTexels] != 0 ? times_[i] : LitTimes()) << i;
    EXPECT_THROW(of(8).load(), Error);  // another bake
    EXPECT_THROW(of(7, kTexels - 1).load(), Error);
}

std::string error_of(const Unfinished& unfinished) {
    try {
        unfinished.load();
        return "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
}

TEST_F(UnfinishedBake, DamagedOnesAreErrors) {
    constexpr std::size_t kStride = 7;  // as many of its bytes as take no time
    const Unfinished unfinished = of(7);
    unfinished.save(times_, done_);
    const std::vector<std::uint8_t> whole = read_file(file_, 1 << 16);
    for (std::size_t length = 0; length < whole.size(); length += kStride) {
        write_file(file_, std::string(whole.begin(), whole.begin() + static_cast<long>(length)));
        EXPECT_NE(error_of(unfinished), "no error") << length;
    }
    for (std::size_t flipped = 0; flipped < whole.size(); flipped += kStride) {
        std::string other(whole.begin(), whole.end());
        other[flipped] = static_cast<char>(other[flipped] ^ 4);
        write_file(file_, other);
        EXPECT_NE(error_of(unfinished), "no error") << flipped;
    }
}

TEST_F(UnfinishedBake, ErrorsSayWhatIsWrongAndHowToMendIt) {
    const auto expect_words = [&](std::string_view fault, std::string_view mend) {
        const std::string message = error_of(of(7));
        EXPECT_NE(message.find(fault), std::string::npos) << message;
        EXPECT_NE(message.find(mend), std::string::npos) << message;
    };
    of(7).save(times_, done_);
    std::vector<std::uint8_t> bytes = read_file(file_, 1 << 16);
    bytes.back() ^= 1;
    write_file(file_, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    expect_words("is damaged", "delete it");
    // Longer than any of so few texels can be.
    constexpr std::size_t kMore = 1000 * kBlockTexels;
    of(8, kMore).save(std::vector<LitTimes>(kMore, times_.front()),
                      std::vector<std::uint8_t>(block_count(kMore), 1));
    expect_words("of another scene or of other parameters", "go on with those");
    write_file(file_, "gnomon part 5\n and so on");
    expect_words("another version", "delete it");
    write_file(file_, "my notes");
    expect_words("is no unfinished bake", "move it");
}

TEST_F(UnfinishedBake, IsKnownFromOtherFiles) {
    EXPECT_FALSE(is_unfinished_bake(file_));
    EXPECT_FALSE(is_unfinished_bake(file_.parent_path()));
    of(7).save(times_, done_);
    EXPECT_TRUE(is_unfinished_bake(file_));
    for (const char* other : {"", "gnomon", "my notes on gnomon part 3"}) {
        write_file(file_, other);
        EXPECT_FALSE(is_unfinished_bake(file_)) << other;
    }
}

TEST_F(UnfinishedBake, ADiskWithoutRoomIsToldBeforeTheWork) {
    try {
        const Unfinished unfinished(file_, 7, std::size_t{1} << 56);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::machine);
    }
    EXPECT_NO_THROW(Unfinished({}, 7, std::size_t{1} << 56));
}

}  // namespace
}  // namespace gnomon::bake
