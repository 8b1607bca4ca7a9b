#pragma once

#include <gnomon/report.h>

namespace gnomon::report {

/// A report as compare_techniques() makes it, of balls above a plane, drawn on the host without any
/// technique: a sun with extent and a point light; a truth, a noisy, a hard, a coarse and a
/// shadowless technique, the coarse one not supporting the point.
ComparisonReport synthetic_report(Extent size);

}  // namespace gnomon::report
