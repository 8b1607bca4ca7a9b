#pragma once

#include <gnomon/bake.h>

#include "bake/fine_cells.h"
#include "bake/sample_place.h"
#include "bake/texel_edges.h"
#include "lightmap/texels.h"
#include "trace/receiver.h"

#include <span>
#include <unordered_map>
#include <vector>

namespace gnomon::bake {

/// Where on its page a point of the facet's plane is, in texels.
glm::dvec2 page_place(const lightmap::Facet& facet, DVec3 point_ws);

/// A scene's texels with their intervals, and where they are.
struct BakedTexels {
    lightmap::Atlas atlas;
    int path_codes = 0;                ///< the length of the path
    std::vector<SamplePlaces> places;  ///< of each page
    std::vector<IntervalPage> pages;
    FineCells fine;
    BakeReport report;
};

/// What a bake that is looked up here can leave out, or have besides.
struct LookupOptions {
    bool lit_sides_only = false;  ///< what faces no direction of the path has no texels
    int fine_parts = 1;           ///< see FineCells::parts; 1: none are fine
};

/// bake_intervals() without the scene of its result.
BakedTexels baked_texels(const Scene& scene, const BakePath& path, const BakeOptions& options,
                         const LookupOptions& lookup, Progress& progress);

/// How a receiver looks its texels up.
enum class TexelLookup {
    nearest,       ///< the texel it is in
    interpolated,  ///< what the four around it see, bilinearly
    edges,  ///< the same, once their times have been moved to the receiver's: see texel_edges
};

/// A light at a moment of its path.
struct LightOnPath {
    LightWindow window;
    /// Unit vectors: where it goes, and square to that; zero when it stands still.
    DVec3 along_ws{0.0}, across_ws{0.0};
};

/// Finds receivers' places on the pages, and what the texels there see: in double, for what a
/// device computes of them to be compared with.
class TexelFinder {
public:
    explicit TexelFinder(const BakedTexels& baked);

    /// The facet that a receiver is on, by its triangle and its side; null when it has no texels.
    const lightmap::Facet* facet_of(const trace::Receiver& receiver) const;

    /// How much of the light a receiver on the facet sees.
    double visibility(const lightmap::Facet& facet, const trace::Receiver& receiver,
                      TexelLookup lookup, const LightOnPath& light) const;

private:
    /// What a place is between, but for weights and normals.
    struct Corners {
        const IntervalPage* page = nullptr;
        BetweenTexels between;
    };
    Corners corners_of(const lightmap::Facet& facet, glm::dvec2 place) const;
    double by_edges(const lightmap::Facet& facet, glm::dvec2 place, const LightOnPath& light) const;

    const BakedTexels& baked_;
    std::unordered_map<std::uint64_t, std::uint32_t> facets_[2];  // fronts, backs; by triangle
};

}  // namespace gnomon::bake
