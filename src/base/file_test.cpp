#include "base/file.h"

#include "base/check.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace gnomon {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kNoLimit = 1u << 20;

/// An empty folder for each test, removed after it.
class FileTest : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("gnomon_file_test" + std::to_string(::getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path path(const std::string& name) const { return folder_ / name; }

    std::vector<std::string> names() const {
        std::vector<std::string> found;
        for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
            found.push_back(entry.path().filename());
        std::sort(found.begin(), found.end());
        return found;
    }

private:
    fs::path folder_;
};

std::string contents(const fs::path& path) {
    const std::vector<std::uint8_t> bytes = read_file(path, kNoLimit);
    return {bytes.begin(), bytes.end()};
}

/// The Error that `call` throws, whose message must name `path`.
template <typename Call>
ErrorKind thrown_kind(const fs::path& path, const Call& call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
        return error.kind();
    }
    ADD_FAILURE() << "nothing was thrown for " << path;
    return ErrorKind::cancelled;
}

TEST_F(FileTest, ReadsBackWhatItWrote) {
    using namespace std::string_literals;
    for (const std::string& bytes : {""s, "text"s, "\r\n\x1a\xff\0 after a zero"s}) {
        write_file(path("a"), bytes);
        EXPECT_EQ(contents(path("a")), bytes);
    }
}

TEST_F(FileTest, ReadsUpToTheLimitAndNoMore) {
    write_file(path("a"), "12345");
    EXPECT_EQ(read_file(path("a"), 5).size(), 5u);
    EXPECT_EQ(thrown_kind(path("a"), [&] { read_file(path("a"), 4); }), ErrorKind::input);
}

TEST_F(FileTest, RefusesToReadWhatIsNoFile) {
    const auto read = [](const fs::path& p) { return [p] { read_file(p, kNoLimit); }; };
    EXPECT_EQ(thrown_kind(path("missing"), read(path("missing"))), ErrorKind::input);
    EXPECT_EQ(thrown_kind(path(""), read(path(""))), ErrorKind::input);
    EXPECT_EQ(thrown_kind("/dev/zero", read("/dev/zero")), ErrorKind::input);
    fs::create_symlink(path("nowhere"), path("dangling"));
    EXPECT_EQ(thrown_kind(path("dangling"), read(path("dangling"))), ErrorKind::input);
}

TEST_F(FileTest, RefusesAFileWithoutPermission) {
    write_file(path("a"), "secret");
    fs::permissions(path("a"), fs::perms::none);
    if (::access(path("a").c_str(), R_OK) == 0) GTEST_SKIP() << "this user may read everything";
    EXPECT_EQ(thrown_kind(path("a"), [&] { read_file(path("a"), kNoLimit); }), ErrorKind::input);
}

TEST_F(FileTest, KeepsTheOldFileUntilTheNewOneIsWhole) {
    write_file(path("a"), "old");
    write_whole(path("a"), [&](const fs::path& temporary) {
        std::ofstream(temporary) << "new";
        EXPECT_EQ(contents(path("a")), "old");
    });
    EXPECT_EQ(contents(path("a")), "new");
    EXPECT_EQ(names(), std::vector<std::string>{"a"});
}

TEST_F(FileTest, LeavesNothingHalfWritten) {
    write_file(path("a"), "old");
    const auto write_and_fail = [](const fs::path& temporary) {
        std::ofstream(temporary) << "half";
        fail_input("gave up");
    };
    EXPECT_THROW(write_whole(path("a"), write_and_fail), Error);
    EXPECT_THROW(write_whole(path("b"), write_and_fail), Error);
    EXPECT_EQ(contents(path("a")), "old");
    EXPECT_EQ(names(), std::vector<std::string>{"a"});
}

TEST_F(FileTest, TellsWhereItCannotWrite) {
    const fs::path nowhere = path("missing") / "a";
    EXPECT_EQ(thrown_kind(nowhere, [&] { write_file(nowhere, "text"); }), ErrorKind::machine);
    fs::create_directory(path("folder"));
    write_file(path("folder") / "inside", "");
    EXPECT_EQ(thrown_kind(path("folder"), [&] { write_file(path("folder"), "text"); }),
              ErrorKind::machine);
    EXPECT_EQ(names(), std::vector<std::string>{"folder"});
}

}  // namespace
}  // namespace gnomon
