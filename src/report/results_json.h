#pragma once

#include "report/layout.h"

#include <filesystem>
#include <string>

namespace gnomon::report {

/// results.json. What does not apply to an unsupported result (error, times, images) is null.
std::string results_json(const ComparisonReport& report, const Layout& layout);

/// Whether `path` is a file that results_json() made, of any version.
bool is_results_json(const std::filesystem::path& path);

}  // namespace gnomon::report
