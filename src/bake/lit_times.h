#pragma once

#include <gnomon/bake.h>

#include "bake/interval_codes.h"
#include "trace/receiver.h"

#include <span>
#include <vector>

namespace gnomon::bake {

/// When each receiver sees the light, found in parts. What is done goes to `options.resume_file`,
/// if that has a name, when the work is stopped or fails, and when all is done; a later call for
/// the same begins with it. Throws Error{input} when the file is of another bake, Error{machine}
/// before the work when the file would not fit on its disk, Error{cancelled}.
std::vector<LitTimes> lit_times(const Scene& scene, const BakePath& path,
                                const BakeOptions& options,
                                std::span<const trace::Receiver> receivers, Progress& progress);

}  // namespace gnomon::bake
