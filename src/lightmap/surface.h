#pragma once

#include <gnomon/scene.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::lightmap {

/// One side of a triangle of an instance.
struct Face {
    std::uint32_t triangle = 0;           ///< of the mesh
    bool back = false;                    ///< seen from the triangle's back
    std::array<DVec3, 3> corners_ws;      ///< counter-clockwise seen from this side
    std::array<std::uint8_t, 3> from;     ///< which corner of the mesh's triangle each of them is
    std::array<std::uint32_t, 3> places;  ///< equal numbers: corners at equal positions
    DVec3 normal_ws{0.0};                 ///< unit vector to this side
    double area_m2 = 0.0;
};

/// What of an instance light can fall on. Triangles without area are left out: those that are no
/// higher than what rounding their corners to float can have made.
///
/// A side gets light when it can be seen and something lit can face it:
///   - the front of every triangle;
///   - the back where the material is double-sided, unless the triangle is part of a closed solid
///     (each edge runs as often forth as back) that faces outwards and has no holes by alpha: its
///     inside is dark.
/// Solids are looked for within one mesh: one that is made of several materials counts as open, and
/// gets texels inside that it did not need.
class Surface {
public:
    /// With `to_light_ws`, only the sides that face one of these directions.
    Surface(const Scene& scene, std::uint32_t instance, bool with_backs,
            std::span<const DVec3> to_light_ws = {});

    const std::vector<Face>& faces() const { return faces_; }

    /// The faces that run along the edge from corner `edge` of `face` the other way: its
    /// neighbours on the same sheet, the other sides of sheets that end there among them.
    std::span<const std::uint32_t> across(std::uint32_t face, int edge) const;

    double area_m2() const;

private:
    struct Edge {
        std::uint32_t from, to;
        auto operator<=>(const Edge&) const = default;
    };
    void add_faces(const Mesh& mesh, const Mat4& world_from_local);
    void add_backs(bool opaque);
    void index_edges();

    std::vector<Face> faces_;
    std::vector<Edge> edges_;                ///< sorted
    std::vector<std::uint32_t> edge_faces_;  ///< the face of each
};

/// Triangles that hang together by corners, each named by one of them. `corners` has three numbers
/// a triangle; equal numbers join.
std::vector<std::uint32_t> components(std::span<const std::array<std::uint32_t, 3>> corners);

}  // namespace gnomon::lightmap
