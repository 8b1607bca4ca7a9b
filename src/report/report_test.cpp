#include <gnomon/error.h>
#include <gnomon/report.h>

#include "base/file.h"
#include "report/synthetic_report.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <limits>
#include <regex>
#include <set>
#include <sstream>

namespace gnomon::report {
namespace {

namespace fs = std::filesystem;
constexpr Extent kSize{160, 90};

std::string text_of(const fs::path& path) {
    const std::vector<std::uint8_t> bytes = read_file(path, 1 << 24);
    return {bytes.begin(), bytes.end()};
}

void write_text(const fs::path& path, std::string_view text) {
    std::ofstream(path) << text;
}

bool contains(std::string_view text, std::string_view part) {
    return text.find(part) != text.npos;
}

/// synthetic_report(kSize), made once.
const ComparisonReport& shared_report() {
    static const ComparisonReport report = synthetic_report(kSize);
    return report;
}

/// An empty folder of its own for each test, gone afterwards.
class WriteReport : public ::testing::Test {
protected:
    void SetUp() override {
        fs::remove_all(root_);
        fs::create_directories(root_);
    }
    void TearDown() override { fs::remove_all(root_); }

    void write(const ComparisonReport& report) {
        Progress progress;
        write_report(folder_, report, progress);
    }

    /// The kind of the Error that writing ends with.
    ErrorKind error_of(const ComparisonReport& report) {
        try {
            write(report);
        } catch (const Error& error) {
            message_ = error.what();
            return error.kind();
        }
        ADD_FAILURE() << "no Error";
        return ErrorKind::cancelled;
    }

    std::set<std::string> names_in(const fs::path& folder) const {
        std::set<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder)) {
            names.insert(entry.path().filename().string());
        }
        return names;
    }

    const fs::path root_ =
        fs::temp_directory_path() / ("gnomon_report_test" + std::to_string(::getpid()));
    const fs::path folder_ = root_ / "report";
    const ComparisonReport& report_ = shared_report();
    std::string message_;
};

TEST_F(WriteReport, ResultsHaveTheDocumentedShape) {
    write(report_);
    const auto json = nlohmann::json::parse(text_of(folder_ / "results.json"));
    EXPECT_EQ(json.at("gnomon"), report_.version);
    EXPECT_EQ(json.at("device").at("type"), "cpu");
    EXPECT_EQ(json.at("scene").at("file"), report_.scene);
    EXPECT_EQ(json.at("scene").at("triangles"), report_.triangles);
    EXPECT_EQ(json.at("scene").at("lights"), 2);
    EXPECT_EQ(json.at("size"), nlohmann::json({kSize.width, kSize.height}));
    EXPECT_EQ(json.at("reference").at("samples"), 256);
    ASSERT_EQ(json.at("results").size(), report_.results.size());
    for (std::size_t i = 0; i < report_.results.size(); ++i) {
        const TechniqueResult& expected = report_.results[i];
        const nlohmann::json& result = json.at("results")[i];
        EXPECT_EQ(result.at("technique"), expected.technique);
        EXPECT_EQ(result.at("light"), expected.light);
        EXPECT_EQ(result.at("supported"), expected.supported);
        EXPECT_EQ(result.at("note"), expected.note);
        if (!expected.supported) {
            EXPECT_TRUE(result.at("error").is_null()) << "0 would be a perfect score";
            EXPECT_TRUE(result.at("time_ms").is_null());
            continue;
        }
        EXPECT_EQ(result.at("error").at("rmse"), expected.error.rmse);
        EXPECT_EQ(result.at("error").at("artefact_lit"), expected.error.artefact_lit);
        EXPECT_EQ(result.at("error").at("flip"), expected.flip);
        EXPECT_EQ(result.at("time_ms").at("total").at("median"), expected.total_ms.median);
        EXPECT_EQ(result.at("time_ms").at("passes").size(), expected.passes.size());
        EXPECT_EQ(result.at("memory_bytes"), expected.memory_bytes);
    }
}

TEST_F(WriteReport, ParametersKeepTheirTypes) {
    write(report_);
    const auto json = nlohmann::json::parse(text_of(folder_ / "results.json"));
    const nlohmann::json& parameters = json.at("results")[4].at("parameters");
    EXPECT_TRUE(parameters.at("map_size").is_number_integer());
    EXPECT_TRUE(parameters.at("slope_bias").is_number_float());
    EXPECT_TRUE(parameters.at("stabilize").is_boolean());
    EXPECT_EQ(parameters.at("filter"), "box_4x4");
}

TEST_F(WriteReport, EveryFileThatThePageNamesIsThereAndNothingIsFetched) {
    write(report_);
    const std::string html = text_of(folder_ / "index.html");
    const std::regex link("(?:src|href)=\"([^\"#]+)\"");
    std::set<std::string> linked;
    for (std::sregex_iterator at(html.begin(), html.end(), link), end; at != end; ++at) {
        const std::string target = (*at)[1];
        if (target.rfind("data:", 0) == 0) continue;
        EXPECT_FALSE(contains(target, ":")) << target << " is outside the folder";
        EXPECT_TRUE(fs::is_regular_file(folder_ / target)) << target;
        linked.insert(target);
    }
    std::size_t images = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "images")) {
        if (!entry.is_regular_file()) continue;
        ++images;
        EXPECT_TRUE(linked.count(fs::relative(entry.path(), folder_).generic_string()))
            << entry.path() << " is shown nowhere";
    }
    // Two truths of two images each, seven supported results of four.
    EXPECT_EQ(images, 2u * 2u + 7u * 4u);
    EXPECT_FALSE(contains(html, "{{")) << "a tag is left";
}

TEST_F(WriteReport, EscapesHostileNames) {
    const std::string hostile = "</script><script>alert('1')</script>\"><img src=x onerror=a&b>";
    ComparisonReport report = report_;
    report.scene = "dir/" + hostile;
    report.device.name = hostile;
    report.warnings = {hostile, "bad UTF-8: \xff\xfe"};
    for (TruthResult& truth : report.truths)
        truth.light = "../../" + hostile;
    for (TechniqueResult& result : report.results) {
        result.title = hostile;
        result.note = hostile;
        result.light = "../../" + hostile;
        result.parameters[hostile] = hostile;
        for (PassTime& pass : result.passes)
            pass.name = hostile;
    }
    write(report);
    const std::string html = text_of(folder_ / "index.html");
    EXPECT_FALSE(contains(html, "<script>alert"));
    EXPECT_FALSE(contains(html, "<img src=x"));
    EXPECT_TRUE(contains(html, "&lt;script&gt;alert(&#39;1&#39;)"));
    EXPECT_EQ(names_in(root_), std::set<std::string>{"report"}) << "a name left the folder";
    EXPECT_TRUE(nlohmann::json::accept(text_of(folder_ / "results.json")));
}

TEST_F(WriteReport, LightsAndTechniquesOfOneNameDoNotShareImages) {
    ComparisonReport report = report_;
    for (TruthResult& truth : report.truths)
        truth.light = "sun";
    for (TechniqueResult& result : report.results)
        result.technique = "truth";
    write(report);
    const auto json = nlohmann::json::parse(text_of(folder_ / "results.json"));
    std::set<std::string> pictures;
    for (const auto& truth : json.at("truths"))
        pictures.insert(truth.at("images").at("picture"));
    for (const auto& result : json.at("results")) {
        if (result.at("supported")) pictures.insert(result.at("images").at("picture"));
    }
    EXPECT_EQ(pictures.size(), 2u + 7u);
}

TEST_F(WriteReport, SaysSoWhenThereIsNoDifference) {
    ComparisonReport report = report_;
    for (std::size_t i = 0; i < report.results.size(); ++i) {
        report.results[i].visibility = report.truths[i % 2].visibility;
    }
    write(report);
    EXPECT_TRUE(contains(text_of(folder_ / "index.html"), "There is no difference to the truth."));
    EXPECT_FALSE(fs::exists(folder_ / "images/sun/ray_traced-worst.png"));
}

TEST_F(WriteReport, ReplacesAnEarlierReportWhole) {
    write(report_);
    write_text(folder_ / "images" / "stale.png", "of the earlier report");
    ComparisonReport later = report_;
    later.scene = "later.glb";
    write(later);
    EXPECT_FALSE(fs::exists(folder_ / "images" / "stale.png"));
    EXPECT_TRUE(contains(text_of(folder_ / "results.json"), "later.glb"));
    EXPECT_EQ(names_in(root_), std::set<std::string>{"report"});
}

TEST_F(WriteReport, TakesAnEmptyFolderATrailingSlashAndMissingParents) {
    fs::create_directory(folder_);
    write(report_);
    EXPECT_TRUE(fs::exists(folder_ / "index.html"));
    Progress progress;
    write_report(root_ / "deep" / "er/", report_, progress);
    EXPECT_TRUE(fs::exists(root_ / "deep" / "er" / "index.html"));
}

TEST_F(WriteReport, RefusesAFolderWithOtherThings) {
    fs::create_directory(folder_);
    write_text(folder_ / "thesis.tex", "years of work");
    EXPECT_THROW(check_report_folder(folder_), Error);
    EXPECT_EQ(error_of(report_), ErrorKind::input);
    EXPECT_TRUE(contains(message_, "thesis.tex")) << message_;
    EXPECT_EQ(names_in(folder_), std::set<std::string>{"thesis.tex"});
    EXPECT_EQ(names_in(root_), std::set<std::string>{"report"});
}

TEST_F(WriteReport, RefusesAReportThatGotOtherThings) {
    write(report_);
    write_text(folder_ / "notes.txt", "of its reader");
    EXPECT_EQ(error_of(report_), ErrorKind::input);
    EXPECT_TRUE(fs::exists(folder_ / "notes.txt"));
}

TEST_F(WriteReport, RefusesAnotherProgramsResultsAndAFile) {
    fs::create_directory(folder_);
    write_text(folder_ / "results.json", "{\"results\": []}");
    EXPECT_EQ(error_of(report_), ErrorKind::input);
    fs::remove_all(folder_);
    write_text(folder_, "a file");
    EXPECT_EQ(error_of(report_), ErrorKind::input);
    EXPECT_EQ(text_of(folder_), "a file");
}

TEST_F(WriteReport, LeavesTheEarlierReportWhenTheDiskIsFull) {
    write(report_);
    const std::string before = text_of(folder_ / "results.json");
    rlimit limit{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
    const rlimit small{1024, limit.rlim_max};  // bytes a file: no image fits
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    const ErrorKind kind = error_of(report_);
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(kind, ErrorKind::machine);
    EXPECT_EQ(text_of(folder_ / "results.json"), before);
    EXPECT_EQ(names_in(root_), std::set<std::string>{"report"});
}

TEST_F(WriteReport, LeavesNothingWhenCancelled) {
    struct Cancelling : Progress {
        bool cancelled() const override { return true; }
    } progress;
    EXPECT_THROW(write_report(folder_, report_, progress), Error);
    EXPECT_TRUE(names_in(root_).empty());
}

TEST_F(WriteReport, RefusesImagesOfAnotherSize) {
    ComparisonReport report = report_;
    report.results[0].visibility = Image({3, 3}, 1);
    EXPECT_EQ(error_of(report), ErrorKind::input);
    EXPECT_TRUE(names_in(root_).empty());
}

std::vector<std::string> lines_of(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
}

TEST(Table, HasALinePerResultAndAlignedColumns) {
    const ComparisonReport& report = shared_report();
    const std::vector<std::string> lines = lines_of(table(report));
    ASSERT_EQ(lines.size(), report.results.size() + 1);
    for (std::size_t i = 0; i < report.results.size(); ++i) {
        const TechniqueResult& result = report.results[i];
        EXPECT_EQ(lines[i + 1].rfind(result.technique, 0), 0u);
        if (result.supported) {
            EXPECT_EQ(lines[i + 1].size(), lines[0].size()) << lines[i + 1];
        } else {
            EXPECT_TRUE(contains(lines[i + 1], "not supported: " + result.note));
        }
    }
}

TEST(Table, SaysWhatATechniqueCouldNotDo) {
    ComparisonReport report;
    TechniqueResult& result = report.results.emplace_back();
    result.technique = "one";
    result.note = "Shadows are hard. 3 gaps closed.";
    EXPECT_FALSE(contains(table(report), "gaps"));
    result.warning = "3 gaps\nclosed.";
    result.error.rmse = 0.125;
    EXPECT_TRUE(contains(lines_of(table(report)).at(1), "0.125"));
    EXPECT_TRUE(contains(lines_of(table(report)).at(1), "warning: 3 gaps"));
    EXPECT_EQ(lines_of(table(report)).size(), 2u);
}

TEST(Table, GivesPercentAndAddsBothKindsOfArtefact) {
    ComparisonReport report;
    TechniqueResult& result = report.results.emplace_back();
    result.technique = "one";
    result.light = "sun";
    result.error.rmse = 0.125;
    result.error.false_lit = 0.03;
    result.error.artefact_lit = 0.01;
    result.error.artefact_shadow = 0.005;
    result.total_ms.median = 4.5;
    result.memory_bytes = std::uint64_t{16} << 20;
    std::istringstream cells(lines_of(table(report)).at(1));
    std::vector<std::string> words{std::istream_iterator<std::string>(cells), {}};
    EXPECT_EQ(words, (std::vector<std::string>{"one", "sun", "0.1250", "3.000", "0.000", "0.000",
                                               "1.500", "0.0000", "4.50", "16.0", "MiB"}));
}

TEST(Table, KeepsATerminalFromObeyingNames) {
    ComparisonReport report;
    TechniqueResult& result = report.results.emplace_back();
    result.technique = "one";
    result.light =
        "s\x1b[2J\n\xc2\x9b"
        "2Jün";
    const std::vector<std::string> lines = lines_of(table(report));
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_TRUE(contains(lines[1], "s?[2J??2Jün "));
    // "ü" is two bytes but one column.
    EXPECT_EQ(lines[1].size(), lines[0].size() + 1);
}

}  // namespace
}  // namespace gnomon::report
