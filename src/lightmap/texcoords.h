#pragma once

#include "lightmap/atlas.h"
#include "lightmap/surface.h"

#include <string>
#include <vector>

namespace gnomon::lightmap {

/// What keeps a mesh's coordinates from being a light map: numbers of triangles.
struct TexcoordFaults {
    unsigned outside = 0;      ///< of [0, 1]
    unsigned no_area = 0;      ///< on the map, though they have some in the world
    unsigned flipped = 0;      ///< laid the other way round than most of their island's area
    unsigned overlapping = 0;  ///< the centre of a texel lies in another triangle as well
    unsigned crowded = 0;      ///< nearer to another island than the padding
    unsigned side_texels = 0;  ///< of the map, when that is more than a page

    bool none() const {
        return outside + no_area + flipped + overlapping + crowded + side_texels == 0;
    }
};

/// Coordinates of a mesh's set: 1 those of its light map, 0 those of its texture.
const std::vector<Vec2>& texcoord_set(const Mesh& mesh, int set);

/// A set spread over so many texels that these faces have the wanted texels on the average, cropped
/// to what it uses.
struct SetLayout {
    Extent size;
    std::vector<Corners> corners;        ///< of each face, in Face's order
    std::vector<std::uint32_t> islands;  ///< equal numbers: joined by corners with one place on the
                                         ///< map and one in the world
};
SetLayout lay_out(const Mesh& mesh, int set, const std::vector<Face>& faces, double texel_size_m);

/// What is wrong with the set as a light map of these faces, which are fronts.
TexcoordFaults check_texcoords(const Mesh& mesh, int set, const std::vector<Face>& faces,
                               const Options& options);

/// The set of each mesh that is a light map for all of its instances, -1 for none. A line in
/// `warnings` for each mesh whose first set is none, with the numbers of the first instance that
/// fails.
std::vector<int> choose_texcoords(const Scene& scene, const Options& options, Progress& progress,
                                  std::vector<std::string>& warnings);

}  // namespace gnomon::lightmap
