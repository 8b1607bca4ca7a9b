#pragma once

#include <gnomon/sun_hours.h>

#include "staged_files.h"
#include "view.h"

#include <filesystem>
#include <string>
#include <vector>

/// What `gnomon sun` leaves in its folder.
namespace gnomon::cli {

/// A line for each point: where it is and faces, in the file's coordinates, and its hours. Throws
/// Error{machine}.
void write_sun_hours_csv(const std::filesystem::path& path, const SunHoursResult& result,
                         const FileFrame& frame);

/// Adds files, whose names begin with `prefix`.
void add_sun_hours(StagedFiles& files, const std::string& prefix, const Scene& scene,
                   const SunHoursResult& result, const FileFrame& frame, const Camera& camera,
                   Extent size, Progress& progress);

/// Removes the pages that an earlier run with other texels has left; `written`: those of this one.
void remove_other_pages(const std::filesystem::path& folder, const std::string& prefix,
                        const std::vector<std::filesystem::path>& written);

}  // namespace gnomon::cli
