#pragma once

#include <filesystem>
#include <functional>

namespace gnomon::report {

/// Calls fill(temporary_folder), then puts the result at `folder`, so that a report appears whole
/// or not at all: an earlier report there is replaced whole, and stays as it was when `fill`
/// throws. Nothing else is ever removed.
/// Throws Error{input} when `folder` is a file, the current folder, or holds anything but a report;
/// Error{machine} when it cannot be made.
void replace_folder(const std::filesystem::path& folder,
                    const std::function<void(const std::filesystem::path&)>& fill);

}  // namespace gnomon::report
