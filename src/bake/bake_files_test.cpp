#include <gnomon/bake.h>
#include <gnomon/error.h>

#include "base/file.h"
#include "lightmap/atlas.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace gnomon {
namespace {

namespace fs = std::filesystem;

constexpr Place kMunich{48.137, 11.575, 520.0};

BakePath day(std::chrono::year_month_day date, int steps) {
    SunPathOptions options;
    options.steps = steps;
    return bake_path(sun_path(kMunich, date, std::chrono::minutes(60), options), "48.137,11.575",
                     "a day");
}

BakePath summer(int steps) {
    using namespace std::chrono;
    return day(2026y / June / 21, steps);
}

/// Asks to stop once it has been told of as much.
class StopsAt final : public Progress {
public:
    explicit StopsAt(double fraction) : fraction_(fraction) {}
    void report(std::string_view task, double fraction) override {
        if (task != "baking the sun") return;
        const std::lock_guard lock(mutex_);
        if (told) told(fraction);
        if (fraction >= fraction_) stopped_ = true;
    }
    bool cancelled() const override { return stopped_; }

    std::function<void(double)> told;  ///< is called with each fraction

private:
    std::mutex mutex_;
    double fraction_;
    std::atomic<bool> stopped_{false};
};

class BakeFiles : public testing::Test {
protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::temp_directory_path() /
                  (std::string("gnomon_bake_") + test->name() + std::to_string(::getpid()));
        fs::remove_all(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    static IntervalBake cube(BakeBits bits) {
        Progress silent;
        return bake_intervals(make_builtin_scene("cube"), summer(100),
                              {.texel_size_m = 0.1, .bits = bits, .resume_file = {}}, silent);
    }

    fs::path folder_;
};

void expect_equal(const IntervalBake& a, const IntervalBake& b) {
    EXPECT_EQ(a.mesh_pages, b.mesh_pages);
    EXPECT_EQ(a.path.to_light_ws, b.path.to_light_ws);
    EXPECT_EQ(a.path.summary, b.path.summary);
    EXPECT_EQ(a.path.utc_offset, b.path.utc_offset);
    EXPECT_EQ(a.report.intervals, b.report.intervals);
    ASSERT_EQ(a.pages.size(), b.pages.size());
    for (std::size_t p = 0; p < a.pages.size(); ++p) {
        EXPECT_EQ(a.pages[p].rises, b.pages[p].rises);
        EXPECT_EQ(a.pages[p].falls, b.pages[p].falls);
    }
}

TEST_F(BakeFiles, AreReadAsTheyWereWritten) {
    for (const BakeBits bits : {BakeBits::eight, BakeBits::sixteen}) {
        const IntervalBake bake = cube(bits);
        EXPECT_GT(bake.report.lit_texels, bake.report.texels / 4);
        write_bake(folder_, bake);
        const IntervalBake read = read_bake(folder_);
        EXPECT_EQ(read.bits, bits);
        expect_equal(bake, read);
        EXPECT_EQ(read.scene.triangle_count(), bake.scene.triangle_count());
    }
}

TEST_F(BakeFiles, HaveTheSameBytesEachTime) {
    write_bake(folder_, cube(BakeBits::eight));
    const auto first = read_file(folder_ / "page0-rise0.png", 1 << 24);
    const auto json = read_file(folder_ / "bake.json", 1 << 24);
    write_bake(folder_, cube(BakeBits::eight));
    EXPECT_EQ(read_file(folder_ / "page0-rise0.png", 1 << 24), first);
    EXPECT_EQ(read_file(folder_ / "bake.json", 1 << 24), json);
}

TEST_F(BakeFiles, DamagedOnesAreErrors) {
    write_bake(folder_, cube(BakeBits::eight));
    write_file(folder_ / "page0-fall0.png", "no picture");
    EXPECT_THROW(read_bake(folder_), Error);
    fs::remove(folder_ / "page0-fall0.png");
    EXPECT_THROW(read_bake(folder_), Error);
    write_bake(folder_, cube(BakeBits::eight));
    const auto bytes = read_file(folder_ / "bake.json", 1 << 24);
    std::string json(bytes.begin(), bytes.end());
    json.replace(json.find("\"pairs\": "), 10, "\"pairs\": -");
    write_file(folder_ / "bake.json", json);
    EXPECT_THROW(read_bake(folder_), Error);
    write_file(folder_ / "bake.json", "{\"gnomon_bake\": 99}");
    EXPECT_THROW(read_bake(folder_), Error);
    write_file(folder_ / "bake.json", "{\"gnomon_bake\": 1");
    EXPECT_THROW(read_bake(folder_), Error);
    EXPECT_THROW(read_bake(folder_ / "nowhere"), Error);
}

/// What read_bake() says of a bake whose bake.json has another value at `pointer`.
std::string error_with(const fs::path& folder, const std::string& pointer,
                       const nlohmann::json& value) {
    const auto bytes = read_file(folder / "bake.json", 1 << 24);
    nlohmann::json json = nlohmann::json::parse(bytes);
    json[nlohmann::json::json_pointer(pointer)] = value;
    write_file(folder / "bake.json", json.dump());
    std::string message = "no error";
    try {
        read_bake(folder);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        message = error.what();
    }
    write_file(folder / "bake.json", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    return message;
}

TEST_F(BakeFiles, WrongMembersAreNamedWithTheirValuesAndWhatIsAllowed) {
    write_bake(folder_, cube(BakeBits::eight));
    const nlohmann::json none = nlohmann::json::array();
    const nlohmann::json up = {0.0, 1.0, 0.0};
    const nlohmann::json short_path(60, up), long_path(256, up);
    struct Case {
        std::string member;
        nlohmann::json value;
        std::string words;
    };
    const std::vector<Case> cases{
        {"/gnomon_bake", 2, "gnomon_bake is 2; it must be 1"},
        {"/bits", 9, "bits is 9; it must be 8 or 16"},
        {"/bits", "8", "bits is \"8\"; it must be a whole number"},
        {"/codes_per_step", 64, "codes_per_step is 64; it must be 1"},
        {"/path", 3, "path is 3; it must be an object"},
        {"/path/to_light_ws", none, "path.to_light_ws has 0 entries; it must have 1 to 255"},
        {"/path/to_light_ws", long_path, "path.to_light_ws has 256 entries; it must have 1 to 255"},
        {"/path/to_light_ws", short_path, "0 to 60 is allowed"},
        {"/path/to_light_ws/7", {0, 0, 0}, "path.to_light_ws[7] is [0,0,0]; it must be of length"},
        {"/path/to_light_ws/7", {0, 1}, "path.to_light_ws[7] has 2 entries; it must have 3"},
        {"/path/pole_ws", {0, "a", 0}, "path.pole_ws[1] is \"a\"; it must be a number"},
        {"/path/begin_s", 1e6, "it must be more than path.begin_s, 1000000"},
        {"/path/begin_s", nullptr, "path.begin_s is null; it must be a number"},
        {"/path/angular_diameter_rad", -1, "path.angular_diameter_rad is -1; it must be 0 to 3.14"},
        {"/path/place", 3, "path.place is 3; it must be a text"},
        {"/path/utc_offset", "CET", "path.utc_offset: \"CET\" is no UTC offset"},
        {"/pages", none, "pages has 0 entries"},
        {"/pages/0/pairs", 17, "pages[0].pairs is 17; it must be 1 to 16"},
        {"/pages/0/pairs", 1.5, "pages[0].pairs is 1.5; it must be a whole number"},
        {"/pages/0/side_texels", -4, "pages[0].side_texels is -4; it must be 1 to 16384"},
        {"/pages/0/side_texels", 8, "bake.json says 8x8"},
        {"/mesh_pages/0", 1, "mesh_pages[0] is 1; it must be 0 to 0"},
        {"/mesh_pages", {0, 0, 0, 0, 0}, "mesh_pages has 5 entries; it must have 2"},
        {"/report/texels", -1, "report.texels is -1; it must be 0 to"},
        {"/report/closed_share", 2, "report.closed_share is 2; it must be 0 to 1"},
    };
    for (const Case& c : cases) {
        const std::string message = error_with(folder_, c.member, c.value);
        EXPECT_NE(message.find(c.words), std::string::npos) << c.member << ": " << message;
        EXPECT_TRUE(message.starts_with(folder_.string())) << message;
    }
    EXPECT_NO_THROW(read_bake(folder_));
}

TEST_F(BakeFiles, TexturesOfOtherBitsAreErrors) {
    write_bake(folder_, cube(BakeBits::sixteen));
    const auto other = read_file(folder_ / "page0-rise0.png", 1 << 24);
    write_bake(folder_, cube(BakeBits::eight));
    write_file(folder_ / "page0-rise0.png",
               {reinterpret_cast<const char*>(other.data()), other.size()});
    const std::string message = error_with(folder_, "/bits", 8);
    EXPECT_NE(message.find("page0-rise0.png: has numbers of 16 bits"), std::string::npos)
        << message;
}

TEST_F(BakeFiles, TextThatIsNoJsonIsToldByItsPlace) {
    write_bake(folder_, cube(BakeBits::eight));
    write_file(folder_ / "bake.json", "{\n \"bits\": \xff\xfe 8}");
    try {
        read_bake(folder_);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.what(),
                  (folder_ / "bake.json").string() + ": is damaged or no JSON: line 2, column 10");
    }
}

TEST_F(BakeFiles, ReplaceNothingButABake) {
    fs::create_directories(folder_);
    write_file(folder_ / "letter.txt", "dear");
    EXPECT_THROW(check_bake_folder(folder_), Error);
    EXPECT_THROW(write_bake(folder_, cube(BakeBits::eight)), Error);
    EXPECT_TRUE(fs::exists(folder_ / "letter.txt"));
}

TEST_F(BakeFiles, AnInterruptedBakeGoesOn) {
    const Scene scene = make_builtin_scene("courtyard");
    fs::create_directories(folder_);
    const BakeOptions options{
        .texel_size_m = 0.15, .bits = BakeBits::sixteen, .resume_file = folder_ / "part"};
    StopsAt stops(0.6);  // of several parts
    EXPECT_THROW(bake_intervals(scene, summer(64), options, stops), Error);
    ASSERT_TRUE(fs::exists(options.resume_file));
    EXPECT_THROW(bake_intervals(scene, summer(65), options, stops), Error);  // of another bake
    BakeOptions other = options;
    other.bits = BakeBits::eight;
    EXPECT_THROW(bake_intervals(scene, summer(64), other, stops), Error);
    Progress silent;
    const IntervalBake resumed = bake_intervals(scene, summer(64), options, silent);
    expect_equal(resumed, bake_intervals(scene, summer(64), options, silent));
    other = options;
    other.resume_file.clear();
    expect_equal(resumed, bake_intervals(scene, summer(64), other, silent));
}

// However few texels there are, and however they are found, no more than a block of each thread is
// lost.
TEST_F(BakeFiles, AnInterruptedBakeOfFewTexelsGoesOn) {
    const Scene scene = make_builtin_scene("courtyard");
    fs::create_directories(folder_);
    Progress silent;
    for (const BakeMethod method : {BakeMethod::interval_traversal, BakeMethod::rays}) {
        for (const BakeBits bits : {BakeBits::eight, BakeBits::sixteen}) {
            BakeOptions options{.texel_size_m = 0.5,
                                .bits = bits,
                                .method = method,
                                .resume_file = folder_ / "part"};
            StopsAt early(0.2);
            EXPECT_THROW(bake_intervals(scene, summer(64), options, early), Error);
            ASSERT_TRUE(fs::exists(options.resume_file));
            // What was done is not done again: the work begins where it was.
            StopsAt at_once(0.1);
            double least = 1.0;
            at_once.told = [&](double fraction) { least = std::min(least, fraction); };
            EXPECT_THROW(bake_intervals(scene, summer(64), options, at_once), Error);
            EXPECT_GE(least, 0.2);
            const IntervalBake resumed = bake_intervals(scene, summer(64), options, silent);
            fs::remove(options.resume_file);
            options.resume_file.clear();
            expect_equal(resumed, bake_intervals(scene, summer(64), options, silent));
        }
    }
}

TEST_F(BakeFiles, ABakeThatNeedsMoreMemoryThanThereIsIsRefusedBeforeItStarts) {
    const Scene scene = make_builtin_scene("courtyard");
    BakeOptions options{.texel_size_m = 0.1, .resume_file = {}};
    // Twice what the light map alone takes, which is a third of what the bake does.
    options.memory_limit_bytes =
        2 * lightmap::estimate(scene, {.texel_size_m = options.texel_size_m}).bytes;
    StopsAt work(0.0);
    try {
        bake_intervals(scene, summer(64), options, work);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
        EXPECT_NE(std::string(error.what()).find("memory_limit_bytes allows"), std::string::npos)
            << error.what();
    }
    EXPECT_FALSE(work.cancelled());
}

TEST_F(BakeFiles, PolarNightIsNoBake) {
    using namespace std::chrono;
    const BakePath night = bake_path(
        sun_path({78.2, 15.6, 0.0}, 2026y / December / 21, minutes(60)), "78.2,15.6", "2026-12-21");
    EXPECT_EQ(night.steps(), 0);
    EXPECT_FALSE(night.summary.empty());
    Progress silent;
    EXPECT_THROW(bake_intervals(make_builtin_scene("cube"), night, {}, silent), Error);
}

TEST_F(BakeFiles, TimesAreThoseOfTheDay) {
    const BakePath path = summer(101);
    const IntervalBake bake = cube(BakeBits::eight);
    const IntervalPage& page = bake.pages.front();
    const LightWindow noon{.at_step = 50.0, .width_steps = 1.0};
    const LightWindow night{.at_step = 300.0, .width_steps = 1.0};
    double lit = 0.0;
    double beyond = 0.0;
    for (unsigned y = 0; y < page.side_texels; ++y) {
        for (unsigned x = 0; x < page.side_texels; ++x) {
            lit += interval_visibility(page, x, y, noon);
            beyond += interval_visibility(page, x, y, night);
        }
    }
    EXPECT_GT(lit, 0.0);
    EXPECT_EQ(beyond, 0.0);
    EXPECT_NEAR(path.begin_s, 4.3 * 3600.0, 3600.0);
    EXPECT_NEAR(path.end_s, 20.2 * 3600.0, 3600.0);
}

}  // namespace
}  // namespace gnomon
