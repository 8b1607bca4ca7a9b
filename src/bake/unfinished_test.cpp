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
    const std::vector<LitTimes> times_{{{0, 10}, {20, 65472}}, {}, {{5, 6}}};
};

TEST_F(UnfinishedBake, IsReadAsItWasWritten) {
    const Unfinished unfinished(file_, 7, 5);
    EXPECT_TRUE(unfinished.load().empty());
    unfinished.save(times_);
    EXPECT_EQ(unfinished.load(), times_);
    EXPECT_THROW(Unfinished(file_, 8, 5).load(), Error);  // another bake
    EXPECT_THROW(Unfinished(file_, 7, 2).load(), Error);
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
    const Unfinished unfinished(file_, 7, 5);
    unfinished.save(times_);
    const std::vector<std::uint8_t> whole = read_file(file_, 1 << 10);
    for (std::size_t length = 0; length < whole.size(); ++length) {
        write_file(file_, std::string(whole.begin(), whole.begin() + static_cast<long>(length)));
        EXPECT_NE(error_of(unfinished), "no error") << length;
    }
    for (std::size_t flipped = 0; flipped < whole.size(); ++flipped) {
        std::string other(whole.begin(), whole.end());
        other[flipped] = static_cast<char>(other[flipped] ^ 4);
        write_file(file_, other);
        EXPECT_NE(error_of(unfinished), "no error") << flipped;
    }
}

TEST_F(UnfinishedBake, ErrorsSayWhatIsWrongAndHowToMendIt) {
    const auto expect_words = [&](std::string_view fault, std::string_view mend) {
        const std::string message = error_of(Unfinished(file_, 7, 5));
        EXPECT_NE(message.find(fault), std::string::npos) << message;
        EXPECT_NE(message.find(mend), std::string::npos) << message;
    };
    Unfinished(file_, 7, 5).save(times_);
    std::vector<std::uint8_t> bytes = read_file(file_, 1 << 10);
    bytes.back() ^= 1;
    write_file(file_, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    expect_words("is damaged", "delete it");
    // Longer than any of 5 texels can be.
    Unfinished(file_, 8, 9000).save(std::vector<LitTimes>(9000, times_.front()));
    expect_words("of another scene or of other parameters", "go on with those");
    write_file(file_, "gnomon part 3\n and so on");
    expect_words("another version", "delete it");
    write_file(file_, "my notes");
    expect_words("is no unfinished bake", "move it");
}

TEST_F(UnfinishedBake, IsKnownFromOtherFiles) {
    EXPECT_FALSE(is_unfinished_bake(file_));
    EXPECT_FALSE(is_unfinished_bake(file_.parent_path()));
    Unfinished(file_, 7, 5).save(times_);
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
