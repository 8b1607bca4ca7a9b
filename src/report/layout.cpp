#include "report/layout.h"

#include "base/check.h"

#include <algorithm>
#include <set>

namespace gnomon::report {

namespace {

/// `name` in lower case with all but letters, digits, "_" and "-" as "_", unlike any of `taken`.
std::string file_name(std::string_view name, std::set<std::string>& taken) {
    constexpr std::size_t kLongest = 64;  // file systems allow 255 bytes, people read fewer
    std::string safe;
    for (const char c : name.substr(0, kLongest)) {
        const bool upper = c >= 'A' && c <= 'Z';
        const bool kept = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
        safe += upper ? static_cast<char>(c - 'A' + 'a') : kept ? c : '_';
    }
    if (safe.empty()) safe = "unnamed";
    std::string unique = safe;
    for (int i = 2; !taken.insert(unique).second; ++i)
        unique = safe + "-" + std::to_string(i);
    return unique;
}

void check_image(const Image& image, Extent size, int channels, const std::string& what) {
    if (image.size() != size || image.channels() != channels) {
        fail_input("report: {} has {}x{} pixels of {} channels, should have {}x{} of {}", what,
                   image.width(), image.height(), image.channels(), size.width, size.height,
                   channels);
    }
}

void check(const ComparisonReport& report) {
    const std::size_t lights = report.truths.size();
    if (lights == 0 || report.results.size() % lights != 0) {
        fail_input("report: {} results on {} lights, should be one per technique and light",
                   report.results.size(), lights);
    }
    const Extent size = report.options.size;
    for (const TruthResult& truth : report.truths) {
        check_image(truth.visibility, size, 1, "the truth's visibility");
        check_image(truth.picture_srgb, size, 3, "the truth's picture");
        check_image(truth.mask.facing, size, 1, "the truth's mask");
    }
    for (const TechniqueResult& result : report.results) {
        if (!result.supported) continue;
        check_image(result.visibility, size, 1, result.technique + "'s visibility");
        check_image(result.picture_srgb, size, 3, result.technique + "'s picture");
    }
}

}  // namespace

Layout make_layout(const ComparisonReport& report) {
    check(report);
    Layout layout;
    std::vector<std::string> folders;
    std::vector<std::set<std::string>> taken;  // names in each light's folder
    std::set<std::string> taken_folders;
    for (const TruthResult& truth : report.truths) {
        const std::string folder = "images/" + file_name(truth.light, taken_folders) + "/";
        folders.push_back(folder);
        taken.push_back({"truth"});
        layout.truths.push_back({folder + "truth-picture.png", folder + "truth-visibility.png"});
    }
    for (std::size_t i = 0; i < report.results.size(); ++i) {
        const TechniqueResult& result = report.results[i];
        ResultLayout& files = layout.results.emplace_back();
        files.light = i % report.truths.size();
        if (!result.supported) continue;
        const TruthResult& truth = report.truths[files.light];
        const std::string stem =
            folders[files.light] + file_name(result.technique, taken[files.light]);
        files.picture = stem + "-picture.png";
        files.visibility = stem + "-visibility.png";
        files.difference = stem + "-difference.png";
        files.worst_window =
            worst_window(result.visibility, truth.visibility, truth.mask.facing, kWorstSide_px);
        if (files.worst_window.error_sum > 0.0) files.worst = stem + "-worst.png";
    }
    return layout;
}

}  // namespace gnomon::report
