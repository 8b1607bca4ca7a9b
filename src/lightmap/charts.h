#pragma once

#include <gnomon/math.h>

#include "lightmap/coverage.h"
#include "lightmap/surface.h"

#include <cstdint>
#include <vector>

namespace gnomon::lightmap {

/// Neighbouring faces that one parallel projection lays flat.
struct GrownChart {
    std::vector<std::uint32_t> faces;  ///< of the Surface, the largest first
    /// The projection: metres to the right and down as seen from the chart's front, from the
    /// corner of the rectangle of least area around it; size_m.x >= size_m.y.
    DVec3 right_ws{0.0}, down_ws{0.0};
    dvec2 corner_m{0.0};
    dvec2 size_m{0.0};
    double area_m2 = 0.0;  ///< of the surface

    dvec2 flat_m(DVec3 p_ws) const {
        return dvec2(glm::dot(right_ws, p_ws), glm::dot(down_ws, p_ws)) - corner_m;
    }
};

struct ChartLimits {
    double normal_rad = 0.0;  ///< greatest angle between the first face's normal and another's
    double side_m = 0.0;      ///< greatest side of the rectangle, unless one face is larger
    double padding_m = 0.0;   ///< between charts: what it costs to cut one
};

/// Charts that hold each of the `wanted` faces once. The largest face left begins a chart, which
/// grows over shared edges. A chart that leaves most of its rectangle empty, such as the top of a
/// wall around a court, is cut into compact ones where that takes less room. Deterministic.
std::vector<GrownChart> grow_charts(const Surface& surface, std::vector<std::uint32_t> wanted,
                                    const ChartLimits& limits);

/// The chart in texels.
struct FlatChart {
    Extent size;                   ///< texels; the chart is in its middle
    std::vector<Corners> corners;  ///< of each face, in Face's order
};
FlatChart flatten(const Surface& surface, const GrownChart& chart, double texel_size_m);

/// Takes those faces out of a chart that cover a texel's centre which another one covers: sheets
/// that lie on each other, a ramp that winds up over itself. The chart keeps the face that came
/// first. Returns those taken out, empty as a rule.
std::vector<std::uint32_t> remove_overlaps(GrownChart& chart, const FlatChart& flat);

/// Whole texels that hold a length in texels, at least one.
unsigned texels_for(double length_texels);

}  // namespace gnomon::lightmap
