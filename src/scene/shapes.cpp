#include "scene/shapes.h"

#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include <array>
#include <cassert>
#include <cmath>

namespace gnomon::scene {

namespace {

using Index = std::uint32_t;

Index add_vertex(Mesh& mesh, Vec3 position, Vec3 normal) {
    mesh.positions.push_back(position);
    mesh.normals.push_back(normal);
    return static_cast<Index>(mesh.positions.size() - 1);
}

/// A flat convex quadrilateral, counter-clockwise.
void add_quad(Mesh& mesh, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    const Vec3 normal = normalize(glm::cross(b - a, d - a));
    const Index first = add_vertex(mesh, a, normal);
    for (const Vec3 p : {b, c, d})
        add_vertex(mesh, p, normal);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

/// The normals at both ends of each segment of an outline that has its solid on the left.
struct SegmentNormals {
    Vec2 begin, end;
};

std::vector<SegmentNormals> outline_normals(const std::vector<Vec2>& outline, bool closed) {
    const std::size_t count = closed ? outline.size() : outline.size() - 1;
    std::vector<Vec2> flat(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2 along = outline[(i + 1) % outline.size()] - outline[i];
        flat[i] = glm::normalize(Vec2(along.y, -along.x));
    }
    std::vector<SegmentNormals> normals(count);
    for (std::size_t i = 0; i < count; ++i)
        normals[i] = {flat[i], flat[i]};
    for (std::size_t i = closed ? 0 : 1; i < count; ++i) {
        const std::size_t before = (i + count - 1) % count;
        if (glm::dot(flat[before], flat[i]) <= std::cos(kCreaseRad)) continue;
        normals[before].end = normals[i].begin = glm::normalize(flat[before] + flat[i]);
    }
    return normals;
}

/// A ring of vertices of a lathe: the index of its first vertex and its distance from the axis.
struct Ring {
    Index first = 0;
    float radius_m = 0.0f;
};

Ring add_ring(Mesh& mesh, const std::vector<Vec2>& circle, Vec2 at, Vec2 normal) {
    const Ring ring{static_cast<Index>(mesh.positions.size()), at.x};
    for (const Vec2 c : circle) {
        // Clockwise in (x, z) is counter-clockwise seen from above.
        add_vertex(mesh, Vec3(at.x * c.x, at.y, -at.x * c.y),
                   Vec3(normal.x * c.x, normal.y, -normal.x * c.y));
    }
    return ring;
}

void join_rings(Mesh& mesh, Ring low, Ring high, int sides) {
    const auto count = static_cast<Index>(sides);
    for (Index i = 0; i < count; ++i) {
        const Index j = (i + 1) % count;
        if (low.radius_m > 0.0f) {
            mesh.triangles.push_back({low.first + i, low.first + j, high.first + j});
        }
        if (high.radius_m > 0.0f) {
            mesh.triangles.push_back({low.first + i, high.first + j, high.first + i});
        }
    }
}

/// A direction at right angles to each point's tangent, turning as little as it can from point to
/// point (rotation-minimising frames by projection; the paths here turn gently).
std::vector<Vec3> transported_normals(const std::vector<Vec3>& tangents) {
    const Vec3 t0 = tangents.front();
    const Vec3 helper = std::abs(t0.y) < 0.9f ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
    std::vector<Vec3> normals{normalize(glm::cross(helper, t0))};
    for (std::size_t i = 1; i < tangents.size(); ++i) {
        const Vec3 last = normals.back();
        normals.push_back(normalize(last - tangents[i] * glm::dot(last, tangents[i])));
    }
    return normals;
}

std::vector<Vec3> path_tangents(const std::vector<Vec3>& path, bool closed) {
    const std::size_t count = path.size();
    std::vector<Vec3> tangents(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t before = closed ? (i + count - 1) % count : (i == 0 ? 0 : i - 1);
        const std::size_t after = closed ? (i + 1) % count : std::min(i + 1, count - 1);
        tangents[i] = normalize(path[after] - path[before]);
    }
    return tangents;
}

/// How far the transported normal has turned about the tangent once around a closed path.
float closing_twist_rad(const std::vector<Vec3>& tangents, const std::vector<Vec3>& normals) {
    const Vec3 t0 = tangents.front();
    const Vec3 back = normalize(normals.back() - t0 * glm::dot(normals.back(), t0));
    return std::atan2(glm::dot(glm::cross(normals.front(), back), t0),
                      glm::dot(normals.front(), back));
}

void add_tube_cap(Mesh& mesh, Index ring, int sides, Vec3 center, Vec3 normal, bool reverse) {
    const Index middle = add_vertex(mesh, center, normal);
    const auto count = static_cast<Index>(sides);
    for (Index i = 0; i < count; ++i)
        add_vertex(mesh, mesh.positions[ring + i], normal);
    for (Index i = 0; i < count; ++i) {
        const Index a = middle + 1 + i;
        const Index b = middle + 1 + (i + 1) % count;
        mesh.triangles.push_back(reverse ? UVec3(middle, b, a) : UVec3(middle, a, b));
    }
}

}  // namespace

std::vector<Vec2> unit_circle(int count) {
    std::vector<Vec2> circle;
    circle.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        // In double, so that the rounding to float hides the differences of mathematics libraries.
        const double angle_rad = 2.0 * 3.14159265358979323846 * i / count;
        circle.emplace_back(static_cast<float>(std::cos(angle_rad)),
                            static_cast<float>(std::sin(angle_rad)));
    }
    return circle;
}

Mesh box(Vec3 min_m, Vec3 max_m) {
    const auto corner = [&](int x, int y, int z) {
        return Vec3(x ? max_m.x : min_m.x, y ? max_m.y : min_m.y, z ? max_m.z : min_m.z);
    };
    Mesh mesh;
    add_quad(mesh, corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1));
    add_quad(mesh, corner(1, 0, 0), corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0));
    add_quad(mesh, corner(1, 0, 1), corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1));
    add_quad(mesh, corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), corner(0, 1, 0));
    add_quad(mesh, corner(0, 1, 1), corner(1, 1, 1), corner(1, 1, 0), corner(0, 1, 0));
    add_quad(mesh, corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1));
    return mesh;
}

Mesh centered_box(Vec3 center_m, Vec3 size_m) {
    return box(center_m - 0.5f * size_m, center_m + 0.5f * size_m);
}

Mesh rectangular_wall(Vec3 min_m, Vec3 max_m, float thickness_m) {
    const Vec3 inset(thickness_m, 0.0f, thickness_m);
    const Vec3 inner_min = min_m + inset;
    const Vec3 inner_max = max_m - inset;
    // Corners counter-clockwise seen from above.
    const auto corners = [](Vec3 a, Vec3 b, float y) {
        return std::array{Vec3(a.x, y, b.z), Vec3(b.x, y, b.z), Vec3(b.x, y, a.z),
                          Vec3(a.x, y, a.z)};
    };
    const auto outer_low = corners(min_m, max_m, min_m.y);
    const auto outer_high = corners(min_m, max_m, max_m.y);
    const auto inner_low = corners(inner_min, inner_max, min_m.y);
    const auto inner_high = corners(inner_min, inner_max, max_m.y);
    Mesh mesh;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t j = (i + 1) % 4;
        add_quad(mesh, outer_low[i], outer_low[j], outer_high[j], outer_high[i]);
        add_quad(mesh, inner_low[j], inner_low[i], inner_high[i], inner_high[j]);
        add_quad(mesh, outer_high[i], outer_high[j], inner_high[j], inner_high[i]);
        add_quad(mesh, outer_low[j], outer_low[i], inner_low[i], inner_low[j]);
    }
    return mesh;
}

Mesh lathe(const std::vector<Vec2>& profile, int sides) {
    assert(profile.size() >= 3 && profile.front().x == 0.0f && profile.back().x == 0.0f);
    const std::vector<Vec2> circle = unit_circle(sides);
    std::vector<SegmentNormals> normals = outline_normals(profile, false);
    // Beyond the axis the profile goes on as its mirror image: round poles have vertical normals.
    const float cos_half_crease = std::cos(0.5f * kCreaseRad);
    if (normals.front().begin.y < -cos_half_crease) normals.front().begin = Vec2(0.0f, -1.0f);
    if (normals.back().end.y > cos_half_crease) normals.back().end = Vec2(0.0f, 1.0f);

    Mesh mesh;
    Ring high;
    for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
        const bool smooth = i > 0 && normals[i - 1].end == normals[i].begin;
        const Ring low = smooth ? high : add_ring(mesh, circle, profile[i], normals[i].begin);
        high = add_ring(mesh, circle, profile[i + 1], normals[i].end);
        join_rings(mesh, low, high, sides);
    }
    return mesh;
}

Mesh cylinder(float radius_m, float y_min_m, float y_max_m, int sides) {
    return lathe({{0.0f, y_min_m}, {radius_m, y_min_m}, {radius_m, y_max_m}, {0.0f, y_max_m}},
                 sides);
}

Mesh sphere(float radius_m, int sides, int rings) {
    // Half of a circle from (0, -1) to (0, 1).
    const std::vector<Vec2> circle = unit_circle(2 * rings);
    std::vector<Vec2> profile{{0.0f, -radius_m}};
    for (int i = 1; i < rings; ++i) {
        const Vec2 c = circle[static_cast<std::size_t>(i)];
        profile.emplace_back(radius_m * c.y, -radius_m * c.x);
    }
    profile.emplace_back(0.0f, radius_m);
    return lathe(profile, sides);
}

Mesh tube(const std::vector<Vec3>& path, const std::vector<float>& radii_m, int sides,
          bool closed) {
    assert(path.size() >= 2 && radii_m.size() == path.size());
    const std::vector<Vec2> circle = unit_circle(sides);
    const std::vector<Vec3> tangents = path_tangents(path, closed);
    const std::vector<Vec3> normals = transported_normals(tangents);
    const float twist_rad = closed ? closing_twist_rad(tangents, normals) : 0.0f;

    Mesh mesh;
    for (std::size_t i = 0; i < path.size(); ++i) {
        // A closed path takes the twist back a little at each point.
        const float turn_rad = -twist_rad * static_cast<float>(i) / static_cast<float>(path.size());
        const Vec3 side = glm::cross(tangents[i], normals[i]);
        const Vec3 u = std::cos(turn_rad) * normals[i] + std::sin(turn_rad) * side;
        const Vec3 v = glm::cross(tangents[i], u);
        for (const Vec2 c : circle) {
            const Vec3 outward = normalize(c.x * u + c.y * v);
            add_vertex(mesh, path[i] + radii_m[i] * outward, outward);
        }
    }
    const std::size_t spans = closed ? path.size() : path.size() - 1;
    for (std::size_t i = 0; i < spans; ++i) {
        const auto ring = [&](std::size_t k) {
            return Ring{static_cast<Index>(k % path.size()) * static_cast<Index>(sides), 1.0f};
        };
        join_rings(mesh, ring(i), ring(i + 1), sides);
    }
    if (!closed) {
        const auto last = static_cast<Index>((path.size() - 1) * static_cast<std::size_t>(sides));
        add_tube_cap(mesh, 0, sides, path.front(), -tangents.front(), true);
        add_tube_cap(mesh, last, sides, path.back(), tangents.back(), false);
    }
    return mesh;
}

Mesh tube(const std::vector<Vec3>& path, float radius_m, int sides, bool closed) {
    return tube(path, std::vector<float>(path.size(), radius_m), sides, closed);
}

Mesh torus(float major_radius_m, float minor_radius_m, int major_sides, int minor_sides) {
    std::vector<Vec3> path;
    for (const Vec2 c : unit_circle(major_sides))
        path.emplace_back(major_radius_m * c.x, 0.0f, -major_radius_m * c.y);
    return tube(path, minor_radius_m, minor_sides, true);
}

Mesh extrude(const std::vector<Vec2>& outline, float z_min_m, float z_max_m) {
    Mesh mesh;
    const auto count = static_cast<Index>(outline.size());
    for (const Vec2 p : outline)
        add_vertex(mesh, Vec3(p, z_max_m), Vec3(0, 0, 1));
    for (const Vec2 p : outline)
        add_vertex(mesh, Vec3(p, z_min_m), Vec3(0, 0, -1));
    for (const UVec3 t : triangulate(outline)) {
        mesh.triangles.push_back(t);
        mesh.triangles.push_back({count + t.x, count + t.z, count + t.y});
    }
    const std::vector<SegmentNormals> normals = outline_normals(outline, true);
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vec2 a = outline[i];
        const Vec2 b = outline[(i + 1) % outline.size()];
        const Vec3 normal_a(normals[i].begin, 0.0f);
        const Vec3 normal_b(normals[i].end, 0.0f);
        const Index first = add_vertex(mesh, Vec3(a, z_max_m), normal_a);
        add_vertex(mesh, Vec3(a, z_min_m), normal_a);
        add_vertex(mesh, Vec3(b, z_min_m), normal_b);
        add_vertex(mesh, Vec3(b, z_max_m), normal_b);
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    }
    return mesh;
}

Mesh height_field(Vec2 min_m, Vec2 max_m, int cells_x, int cells_z,
                  const std::function<float(float, float)>& height_m) {
    const Vec2 cell =
        (max_m - min_m) / Vec2(static_cast<float>(cells_x), static_cast<float>(cells_z));
    Mesh mesh;
    for (int j = 0; j <= cells_z; ++j) {
        for (int i = 0; i <= cells_x; ++i) {
            const float x = min_m.x + cell.x * static_cast<float>(i);
            const float z = min_m.y + cell.y * static_cast<float>(j);
            // Slopes over one cell, which is what the triangles can show.
            const Vec2 half = 0.5f * cell;
            const float slope_x = (height_m(x + half.x, z) - height_m(x - half.x, z)) / cell.x;
            const float slope_z = (height_m(x, z + half.y) - height_m(x, z - half.y)) / cell.y;
            add_vertex(mesh, Vec3(x, height_m(x, z), z), normalize({-slope_x, 1.0f, -slope_z}));
            mesh.texcoords.emplace_back(x, z);
        }
    }
    const auto stride = static_cast<Index>(cells_x + 1);
    for (Index j = 0; j < static_cast<Index>(cells_z); ++j) {
        for (Index i = 0; i < static_cast<Index>(cells_x); ++i) {
            const Index a = j * stride + i;  // nearest to min_m; b, c, d counter-clockwise
            const Index b = a + stride;
            const Index c = b + 1;
            const Index d = a + 1;
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        }
    }
    return mesh;
}

Mesh ground(Vec2 min_m, Vec2 max_m) {
    return height_field(min_m, max_m, 1, 1, [](float, float) { return 0.0f; });
}

void append(Mesh& mesh, const Mesh& part) {
    const bool first = mesh.positions.empty();
    const auto offset = static_cast<Index>(mesh.positions.size());
    const auto add = [&](auto& stream, const auto& more) {
        if (!first && stream.empty()) return;
        assert(first || more.size() == part.positions.size());
        stream.insert(stream.end(), more.begin(), more.end());
    };
    add(mesh.normals, part.normals);
    add(mesh.texcoords, part.texcoords);
    add(mesh.lightmap_texcoords, part.lightmap_texcoords);
    add(mesh.colors, part.colors);
    mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
    for (const UVec3 t : part.triangles)
        mesh.triangles.push_back(t + offset);
}

Mesh moved(Mesh mesh, const Mat4& to_from_local) {
    const glm::mat3 normal_matrix = glm::transpose(glm::inverse(glm::mat3(to_from_local)));
    for (Vec3& p : mesh.positions)
        p = Vec3(to_from_local * Vec4(p, 1.0f));
    for (Vec3& n : mesh.normals)
        n = normalize(normal_matrix * n);
    return mesh;
}

Mesh moved(Mesh mesh, Vec3 by_m) {
    return moved(std::move(mesh), translation(by_m));
}

Mat4 translation(Vec3 by_m) {
    return glm::translate(Mat4(1.0f), by_m);
}

Mat4 scaling(Vec3 factor) {
    return glm::scale(Mat4(1.0f), factor);
}

Mat4 rotation_x(float angle_rad) {
    return glm::rotate(Mat4(1.0f), angle_rad, Vec3(1, 0, 0));
}

Mat4 rotation_y(float angle_rad) {
    return glm::rotate(Mat4(1.0f), angle_rad, Vec3(0, 1, 0));
}

Mat4 rotation_z(float angle_rad) {
    return glm::rotate(Mat4(1.0f), angle_rad, Vec3(0, 0, 1));
}

}  // namespace gnomon::scene
