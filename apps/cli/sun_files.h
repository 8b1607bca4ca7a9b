#pragma once

#include <gnomon/sun_hours.h>

#include "view.h"

#include <filesystem>
#include <string>
#include <vector>

/// What `gnomon sun` leaves in its folder.
namespace gnomon::cli {

/// A line for each point: where it is and faces, in the file's coordinates, and its hours.
std::string sun_hours_csv(const SunHoursResult& result, const FileFrame& frame);

/// Writes all files into `folder`, each whole or not at all; their names begin with `prefix`.
/// Returns the paths. Everything that takes time is done before the first file is written.
std::vector<std::filesystem::path> write_sun_hours(const std::filesystem::path& folder,
                                                   const std::string& prefix, const Scene& scene,
                                                   const SunHoursResult& result,
                                                   const FileFrame& frame, const Camera& camera,
                                                   Extent size, Progress& progress);

}  // namespace gnomon::cli
