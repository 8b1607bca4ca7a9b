#pragma once

#include <gnomon/progress.h>
#include <gnomon/scene.h>

#include "lightmap/coverage.h"

#include <cstdint>
#include <string>
#include <vector>

/// Light maps: where on square pages each piece of a scene's surface has its texels.
namespace gnomon::lightmap {

struct Options {
    double texel_size_m = 0.1;        ///< side of a texel on the surface, [1e-6, 1e6]
    unsigned padding_texels = 2;      ///< clear texels between charts, [0, 64]; 2 or more keep
                                      ///< bilinear look-ups from bleeding
    unsigned max_page_texels = 4096;  ///< largest side of a page, [16, 32768]
    double chart_normal_deg = 10.0;   ///< how far normals turn within a chart, [0, 60]; its texels
                                      ///< are up to 1 / cos of it longer than texel_size_m
    bool keep_texcoords = true;       ///< use a mesh's own coordinates where they serve
    bool back_sides = true;           ///< texels on the backs that light can reach; see Surface
    std::uint64_t memory_limit_bytes = 0;  ///< 0 = the machine's memory
    /// What is to be held besides at the same time: of each texel, and of each place of a page.
    std::uint64_t more_texel_bytes = 0, more_place_bytes = 0;
    std::uint64_t more_bytes = 0;               ///< likewise, however many there are
    std::string texel_option = "texel_size_m";  ///< what errors call the size: as its user does
    /// Where light can come from: sides that face none of it get no texels. Empty: from anywhere.
    std::vector<DVec3> to_light_ws = {};
};

/// What a light map will take, from the charts' sizes alone.
struct Estimate {
    std::uint64_t texels = 0;       ///< touched by the surface
    std::uint64_t pages = 0;        ///< if none is made smaller than it may be
    unsigned page_side_texels = 0;  ///< of the largest
    std::uint64_t bytes = 0;        ///< the most that Atlas and Texels hold while they are made,
                                    ///< and what the options say is held besides
};

/// A triangle on a page.
struct PlacedTriangle {
    std::uint32_t triangle = 0;  ///< of the instance's mesh
    std::uint32_t facet = 0;     ///< index into Atlas::facets
    bool back = false;           ///< the side that is seen from behind
    Corners corners_texels;      ///< of its page; in the order of the mesh's triangle
};

/// Triangles of a chart in one plane with one linear map: where its texels lie in the world.
struct Facet {
    std::uint32_t chart = 0;
    std::uint32_t first_triangle = 0, triangle_count = 0;  ///< of Atlas::triangles
    DVec3 origin_ws{0.0};                                  ///< of the page's corner (0, 0)
    DVec3 u_ws{0.0}, v_ws{0.0};  ///< one texel to the right, one texel down
    DVec3 normal_ws{0.0};        ///< unit vector to the side that gets the light

    DVec3 point_ws(dvec2 page_texels) const {
        return origin_ws + page_texels.x * u_ws + page_texels.y * v_ws;
    }
};

/// What hangs together on a page. Other charts keep their distance from it.
struct Chart {
    std::uint32_t instance = 0;
    std::uint32_t page = 0;
    unsigned x = 0, y = 0;  ///< its least texel
    Extent size;            ///< texels
    int texcoord_set = -1;  ///< the mesh's own set that gave it its shape; -1 = none
    std::uint32_t first_facet = 0, facet_count = 0;        ///< of Atlas::facets
    std::uint32_t first_triangle = 0, triangle_count = 0;  ///< of Atlas::triangles
};

struct Atlas {
    Options options;
    std::vector<unsigned> page_sides_texels;  ///< of each page; multiples of 4, for compression
    std::vector<Chart> charts;
    std::vector<Facet> facets;
    std::vector<PlacedTriangle> triangles;  ///< by chart, by facet
    std::vector<std::string> warnings;      ///< why meshes' own coordinates do not serve
};

/// Throws Error{input} for options out of range and for a scene without area.
Estimate estimate(const Scene& scene, const Options& options = {});

/// Lays every instance's surface out with texels of one size in metres. A mesh's own coordinates,
/// set 1 or else that of its texture, are kept when they are a light map; then texels have the
/// wanted area on the average of each instance. Where an instance has backs to light, they are laid
/// out besides. The same for any number of threads.
/// Throws Error{input} for options out of range, for a scene without area, for a triangle that is
/// larger than a page, and when the estimate exceeds the memory limit; the last two before anything
/// large is allocated, naming a texel size that will do. Error{cancelled} when asked to stop.
Atlas make_atlas(const Scene& scene, const Options& options, Progress& progress);
Atlas make_atlas(const Scene& scene, const Options& options = {});

/// The scene with its places in the light map as TEXCOORD_1. Each instance has meshes of its own,
/// one for each page it is on, named "MESH" or, when the atlas has several pages, "MESH, page N"
/// (from 0). Vertices are split where charts part. A back that has texels becomes triangles of its
/// own, with one-sided materials for both, as a triangle has one place in a map. Triangles without
/// area are left out.
Scene with_lightmap(const Scene& scene, const Atlas& atlas);

/// The page of each mesh of that scene.
std::vector<std::uint32_t> lightmapped_pages(const Scene& scene, const Atlas& atlas);

}  // namespace gnomon::lightmap
