#pragma once

#include <gnomon/image.h>
#include <gnomon/sun_hours.h>

#include "lightmap/texels.h"
#include "trace/receiver.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon {

/// The hours of a light map's texels, to be looked up by points of the surface.
struct SunHoursMap {
    lightmap::Atlas atlas;
    std::vector<Image> pages_h;    ///< -1 where there is no surface
    std::vector<Image> dilated_h;  ///< with the values of charts around them
    /// Index into Atlas::triangles of each side of each triangle, instance by instance.
    std::vector<std::uint32_t> placed;
    std::vector<std::size_t> first_placed;  ///< of each instance

    /// Mean hours of the nearest texel; -1 where the surface has none. `point_ws` lies on the
    /// triangle, and is seen from the side that `normal_ws` points to.
    float hours_at(const Scene& scene, const trace::Receiver& point) const;
};

namespace bake {

/// What `lightmap` calls a texel where there is no surface.
inline constexpr float kNoSurface_h = -1.0f;

SunHoursMap make_map(const Scene& scene, lightmap::Atlas atlas, const lightmap::Texels& texels,
                     std::span<const SunHours> hours);

/// The area in m² that each texel stands for: those of a facet share its area, and charts whose
/// facets have not all got texels spread the rest, so that the sum is the area of the surface.
std::vector<double> texel_areas_m2(const Scene& scene, const lightmap::Atlas& atlas,
                                   const lightmap::Texels& texels);

}  // namespace bake

}  // namespace gnomon
