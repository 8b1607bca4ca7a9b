#pragma once

#include <gnomon/scene.h>

#include <functional>
#include <vector>

/// Meshes of simple shapes, in metres. Unless said otherwise a shape is a closed 2-manifold once
/// equal positions are welded (they are equal to the bit), counter-clockwise seen from outside,
/// without triangles of no area; it has normals and no texture coordinates.
namespace gnomon::scene {

Mesh box(Vec3 min_m, Vec3 max_m);

/// A box in its middle, `size_m` wide, high and deep.
Mesh centered_box(Vec3 center_m, Vec3 size_m);

/// A hollow rectangle seen from above, such as the wall around a court: the outer sides at the
/// corners `min_m` and `max_m`, the walls `thickness_m` thick.
Mesh rectangular_wall(Vec3 min_m, Vec3 max_m, float thickness_m);

/// The surface that `profile` (distance from the axis, height) sweeps about the Y axis. The profile
/// runs from the bottom to the top with the solid on its left, begins and ends on the axis
/// (distance 0) and is away from it in between. Normals are smooth where it turns by less than
/// kCreaseRad.
Mesh lathe(const std::vector<Vec2>& profile, int sides);

Mesh cylinder(float radius_m, float y_min_m, float y_max_m, int sides);

/// About the origin. `rings` runs from pole to pole.
Mesh sphere(float radius_m, int sides, int rings);

/// A round tube along `path`; `radii_m` has one value per point. Turns should be gentle: the
/// cross-sections are at right angles to the path. The ends are flat; a `closed` path has none, and
/// does not repeat its first point.
Mesh tube(const std::vector<Vec3>& path, const std::vector<float>& radii_m, int sides,
          bool closed = false);
Mesh tube(const std::vector<Vec3>& path, float radius_m, int sides, bool closed = false);

/// In the XZ plane, about the Y axis.
Mesh torus(float major_radius_m, float minor_radius_m, int major_sides, int minor_sides);

/// The prism over a simple polygon (x, y), counter-clockwise, which may be concave, from `z_min_m`
/// to `z_max_m`. Normals are smooth where the outline turns by less than kCreaseRad.
Mesh extrude(const std::vector<Vec2>& outline, float z_min_m, float z_max_m);

/// The triangles of a simple polygon, counter-clockwise, which may be concave: indices into
/// `outline`, outline.size() - 2 of them, none without area.
std::vector<UVec3> triangulate(const std::vector<Vec2>& outline);

/// An open sheet y = height(x, z) over a rectangle (x, z) of `cells_x` by `cells_z` cells, seen
/// from above, with normals from the function's slope and texture coordinates (x, z) in metres.
Mesh height_field(Vec2 min_m, Vec2 max_m, int cells_x, int cells_z,
                  const std::function<float(float, float)>& height_m);

/// An open rectangle y = 0, seen from above, of two triangles, like a height field.
Mesh ground(Vec2 min_m, Vec2 max_m);

/// Adds a copy of `part`. The streams of `mesh`, if it is not empty, decide which are kept; those
/// that `part` lacks must not be among them.
void append(Mesh& mesh, const Mesh& part);

/// The mesh in another place; `to_from_local` is affine and does not mirror.
Mesh moved(Mesh mesh, const Mat4& to_from_local);
Mesh moved(Mesh mesh, Vec3 by_m);

Mat4 translation(Vec3 by_m);
Mat4 scaling(Vec3 factor);
/// Counter-clockwise seen from the end of the axis towards the origin.
Mat4 rotation_x(float angle_rad);
Mat4 rotation_y(float angle_rad);
Mat4 rotation_z(float angle_rad);

/// `count` points of the unit circle (cos, sin), the first at (1, 0), counter-clockwise.
std::vector<Vec2> unit_circle(int count);

/// Sharper turns of an outline are edges; gentler ones are round.
inline constexpr float kCreaseRad = radians(40.0f);

}  // namespace gnomon::scene
