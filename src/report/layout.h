#pragma once

#include <gnomon/report.h>

#include "report/pictures.h"

#include <string>
#include <vector>

namespace gnomon::report {

/// Side of the worst crop, in pixels, and how many each of them becomes.
inline constexpr unsigned kWorstSide_px = 64;
inline constexpr unsigned kWorstScale = 4;
inline constexpr unsigned kWorstGap_px = 8;

/// Where a truth's images lie, relative to the report's folder, with slashes, made only of
/// a-z, 0-9, "_", "-", "." and so safe in a URL.
struct TruthLayout {
    std::string picture, visibility;
};

/// Likewise for a result; all empty when it is not supported, `worst` also when there is no
/// difference.
struct ResultLayout {
    std::size_t light = 0;  ///< index into ComparisonReport::truths
    std::string picture, visibility, difference, worst;
    Window worst_window;
};

struct Layout {
    std::vector<TruthLayout> truths;    ///< one per truth
    std::vector<ResultLayout> results;  ///< one per result
};

/// Names every image of the report and finds its worst crops. Throws Error{input} when the report
/// is not what its documentation says: results for other lights than it has truths for, images of
/// different sizes.
Layout make_layout(const ComparisonReport& report);

}  // namespace gnomon::report
