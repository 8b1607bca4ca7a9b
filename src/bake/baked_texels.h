#pragma once

#include <gnomon/bake.h>

#include "lightmap/texels.h"
#include "trace/receiver.h"

#include <span>
#include <unordered_map>
#include <vector>

namespace gnomon::bake {

/// A scene's texels with their intervals, and where they are.
struct BakedTexels {
    lightmap::Atlas atlas;
    std::vector<IntervalPage> pages;
    BakeReport report;
};

/// bake_intervals() without the scene of its result.
BakedTexels baked_texels(const Scene& scene, const BakePath& path, const BakeOptions& options,
                         Progress& progress);

/// How a receiver looks its texels up.
enum class TexelLookup {
    nearest,       ///< the texel it is in
    interpolated,  ///< what the four around it see, bilinearly
};

/// Finds receivers' places on the pages.
class TexelFinder {
public:
    explicit TexelFinder(const BakedTexels& baked);

    /// The facet that a receiver is on, by its triangle and its side; null when it has no texels.
    const lightmap::Facet* facet_of(const trace::Receiver& receiver) const;

    /// How much of the light a receiver on the facet sees.
    double visibility(const lightmap::Facet& facet, const trace::Receiver& receiver,
                      TexelLookup lookup, const LightWindow& window) const;

private:
    const BakedTexels& baked_;
    std::unordered_map<std::uint64_t, std::uint32_t> facets_[2];  // fronts, backs; by triangle
};

}  // namespace gnomon::bake
