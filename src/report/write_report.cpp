#include <gnomon/report.h>

#include "base/check.h"
#include "base/file.h"
#include "base/folder.h"
#include "base/parallel.h"
#include "report/layout.h"
#include "report/page.h"
#include "report/results_json.h"

#include <functional>
#include <system_error>

namespace gnomon {

namespace {

using namespace report;
namespace fs = std::filesystem;

/// An image file still to be made, so that all of them can be made side by side.
struct ImageJob {
    std::string path;
    std::function<void(const fs::path&)> write;
};

void add_result_jobs(const TechniqueResult& result, const TruthResult& truth,
                     const ResultLayout& files, std::vector<ImageJob>& jobs) {
    if (!result.supported) return;
    jobs.push_back(
        {files.picture, [&](const fs::path& path) { write_png(path, result.picture_srgb); }});
    jobs.push_back(
        {files.visibility, [&](const fs::path& path) { write_png(path, result.visibility); }});
    const auto difference = [&] {
        return difference_image(result.visibility, truth.visibility, truth.mask.facing);
    };
    jobs.push_back(
        {files.difference, [difference](const fs::path& path) { write_png(path, difference()); }});
    if (files.worst.empty()) return;
    jobs.push_back({files.worst, [difference, &result, &truth, &files](const fs::path& path) {
                        write_png(path,
                                  worst_strip(result.visibility, truth.visibility, difference(),
                                              files.worst_window, kWorstScale, kWorstGap_px));
                    }});
}

std::vector<ImageJob> image_jobs(const ComparisonReport& report, const Layout& layout) {
    std::vector<ImageJob> jobs;
    for (std::size_t i = 0; i < report.truths.size(); ++i) {
        const TruthResult& truth = report.truths[i];
        jobs.push_back({layout.truths[i].picture,
                        [&](const fs::path& path) { write_png(path, truth.picture_srgb); }});
        jobs.push_back({layout.truths[i].visibility,
                        [&](const fs::path& path) { write_png(path, truth.visibility); }});
    }
    for (std::size_t i = 0; i < report.results.size(); ++i) {
        const ResultLayout& files = layout.results[i];
        add_result_jobs(report.results[i], report.truths[files.light], files, jobs);
    }
    return jobs;
}

void fill_folder(const fs::path& folder, const ComparisonReport& report, Progress& progress) {
    const Layout layout = make_layout(report);
    const std::vector<ImageJob> jobs = image_jobs(report, layout);
    for (const ImageJob& job : jobs) {
        const fs::path parent = (folder / job.path).parent_path();
        std::error_code error;
        fs::create_directories(parent, error);
        if (error) fail_machine("{}: cannot be made: {}", parent.string(), error.message());
    }
    parallel_for(
        jobs.size(), 1,
        [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i)
                jobs[i].write(folder / jobs[i].path);
        },
        "writing the report", &progress);
    write_file(folder / "index.html", page(report, layout));
    write_file(folder / "results.json", results_json(report, layout));
    throw_if_cancelled(progress, "writing the report");
}

FolderKind report_kind() {
    return {
        .noun = "report",
        .mark = "results.json",
        .has_entry = [](std::string_view name) { return name == "images" || name == "index.html"; },
        .is_mark = &report::is_results_json};
}

}  // namespace

void check_report_folder(const fs::path& folder) {
    check_replaceable(folder, report_kind());
}

void write_report(const fs::path& folder, const ComparisonReport& report, Progress& progress) {
    replace_folder(folder, report_kind(),
                   [&](const fs::path& fresh) { fill_folder(fresh, report, progress); });
}

}  // namespace gnomon
