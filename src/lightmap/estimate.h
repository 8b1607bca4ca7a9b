#pragma once

#include "lightmap/atlas.h"

namespace gnomon::lightmap {

/// The estimate, once it is sure that it can be had: throws Error{input} as make_atlas does.
Estimate require_fit(const Scene& scene, const Options& options, Progress& progress);

}  // namespace gnomon::lightmap
