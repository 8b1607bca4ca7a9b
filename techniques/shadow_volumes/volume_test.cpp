#include "volume.h"

#include "scene/shapes.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/ext/vector_double4.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>

namespace gnomon::shadow_volumes {
namespace {

class Random {
public:
    float uniform(float low, float high) {
        return std::uniform_real_distribution<float>(low, high)(engine_);
    }
    std::uint32_t below(std::size_t end) {
        return std::uniform_int_distribution<std::uint32_t>(
            0, static_cast<std::uint32_t>(end - 1))(engine_);
    }
    Vec3 point(float reach) {
        return {uniform(-reach, reach), uniform(-reach, reach), uniform(-reach, reach)};
    }

private:
    std::mt19937 engine_{11};
};

struct Caster {
    std::string name;
    Mesh mesh;
    Mat4 world_from_local{1.0f};
};

/// A mesh of triangles in all directions over few vertices: edges of any number of triangles.
Mesh tangle(Random& random) {
    Mesh mesh;
    for (int i = 0; i < 9; ++i)
        mesh.positions.push_back(random.point(1.0f));
    while (mesh.triangles.size() < 20) {
        const UVec3 t(random.below(9), random.below(9), random.below(9));
        if (t.x != t.y && t.y != t.z && t.z != t.x) mesh.triangles.push_back(t);
    }
    return mesh;
}

/// A sphere, some of whose triangles are missing or the wrong way round.
Mesh damaged(Random& random, bool missing) {
    Mesh mesh = scene::sphere(1.0f, 10, 6);
    for (int i = 0; i < 5; ++i) {
        const std::uint32_t chosen = random.below(mesh.triangles.size());
        if (missing) {
            mesh.triangles.erase(mesh.triangles.begin() + chosen);
        } else {
            std::swap(mesh.triangles[chosen].x, mesh.triangles[chosen].y);
        }
    }
    return mesh;
}

/// A closed shell with a hollow, of two pieces: the inner one is the wall of the hollow.
Mesh shell() {
    Mesh mesh = scene::box(Vec3(-1), Vec3(1));
    Mesh hollow = scene::box(Vec3(-0.6f), Vec3(0.6f));
    for (UVec3& t : hollow.triangles)
        std::swap(t.y, t.z);
    scene::append(mesh, hollow);
    return mesh;
}

/// Two solids that share an edge; the smaller may be inside out.
Mesh touching(bool inside_out) {
    Mesh mesh = scene::box(Vec3(-1, -1, -1), Vec3(0, 1, 0));
    Mesh other = scene::box(Vec3(0, -1, 0), Vec3(0.8f, 1, 0.8f));
    if (inside_out) {
        for (UVec3& t : other.triangles)
            std::swap(t.y, t.z);
    }
    scene::append(mesh, other);
    return mesh;
}

/// Turned, scaled unevenly and in every other place mirrored.
Mat4 random_place(Random& random, bool mirrored) {
    const float size = std::pow(10.0f, random.uniform(-1.0f, 1.0f));
    Mat4 place = glm::translate(Mat4(1.0f), random.point(3.0f * size));
    place = glm::rotate(place, random.uniform(0, 6), normalize(random.point(1.0f) + 1e-3f));
    return glm::scale(place, size * Vec3(mirrored ? -1.0f : 1.0f, random.uniform(0.3f, 2.0f),
                                         random.uniform(0.3f, 2.0f)));
}

Mesh sheet() {
    return scene::height_field(Vec2(-1), Vec2(1), 4, 4,
                               [](float x, float z) { return x * x - 0.5f * z; });
}

/// Each triangle twice, once the other way round, as leaves are often made.
Mesh two_faced_sheet() {
    Mesh mesh = sheet();
    Mesh back = sheet();
    for (UVec3& t : back.triangles)
        std::swap(t.y, t.z);
    scene::append(mesh, back);
    return mesh;
}

std::vector<Caster> casters(Random& random) {
    std::vector<Caster> all = {
        {"box", scene::box(Vec3(-1), Vec3(1))},
        {"torus", scene::torus(1.0f, 0.4f, 12, 7)},
        {"concave prism",
         scene::extrude({{-1, -1}, {1, -1}, {1, 1}, {0, -0.5f}, {-1, 1}}, -0.5f, 0.5f)},
        {"shell", shell()},
        {"touching boxes", touching(false)},
        {"touching boxes, one inside out", touching(true)},
        {"sheet", sheet()},
        {"two-faced sheet", two_faced_sheet()},
        {"sphere with holes", damaged(random, true)},
        {"sphere with flipped triangles", damaged(random, false)},
        {"tangle", tangle(random)},
        {"other tangle", tangle(random)}};
    Caster inside_out = all[1];
    inside_out.name = "torus inside out";
    for (UVec3& t : inside_out.mesh.triangles)
        std::swap(t.y, t.z);
    all.push_back(inside_out);
    for (std::size_t i = 0; i < all.size(); ++i)
        all[i].world_from_local = random_place(random, random.below(2) == 0);
    return all;
}

DVec3 to_world(const Caster& caster, Vec3 p) {
    return DVec3(glm::dmat4(caster.world_from_local) * glm::dvec4(DVec3(p), 1.0));
}

/// Suns, and points outside and inside of the caster's bounds.
std::vector<HomogeneousLight> lights(const Caster& caster, Random& random) {
    std::vector<HomogeneousLight> all;
    for (int i = 0; i < 4; ++i)
        all.emplace_back(normalize(random.point(1.0f) + 1e-3f), 0.0f);
    for (const float reach : {0.3f, 0.9f, 3.0f, 10.0f}) {
        for (int i = 0; i < 3; ++i)
            all.emplace_back(Vec3(to_world(caster, random.point(reach))), 1.0f);
    }
    return all;
}

Volume volume_of(const Caster& caster, HomogeneousLight light_ws, VolumeSource source = {}) {
    return build_volume(caster.mesh, find_adjacency(caster.mesh), caster.world_from_local, light_ws,
                        source);
}

/// All caps, counter-clockwise seen from the light.
std::vector<shared::VolumeTriangle> caps_of(const Volume& volume) {
    std::vector<shared::VolumeTriangle> caps = volume.caps;
    for (const shared::VolumeTriangle& cap : volume.clockwise_caps)
        caps.push_back({cap.slot, cap.a, cap.c, cap.b});
    return caps;
}

DVec3 to_light(HomogeneousLight light_ws, DVec3 from) {
    return DVec3(light_ws) - from * static_cast<double>(light_ws.w);
}

template <typename Check>
void for_each_case(const Check& check) {
    Random random;
    for (int round = 0; round < 5; ++round) {
        for (const Caster& caster : casters(random)) {
            for (const HomogeneousLight light : lights(caster, random)) {
                SCOPED_TRACE(caster.name + (light.w == 0.0f ? ", sun" : ", point") + ", round " +
                             std::to_string(round));
                check(caster, light, volume_of(caster, light), random);
            }
        }
    }
}

/// Edges of oriented faces, each minus its reverse. `first` and `second` tell vertices apart.
using Vertex = std::pair<std::uint32_t, bool>;  // index, whether at the far end of the volume
class Boundary {
public:
    void add(const std::vector<Vertex>& face) {
        for (std::size_t i = 0; i < face.size(); ++i) {
            const Vertex a = face[i], b = face[(i + 1) % face.size()];
            if (a == b) continue;
            net_[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    }
    bool is_closed() const {
        return std::all_of(net_.begin(), net_.end(), [](const auto& e) { return e.second == 0; });
    }

private:
    std::map<std::pair<Vertex, Vertex>, int> net_;
};

TEST(BuildVolume, ClosesItsSurface) {
    for_each_case([](const Caster&, HomogeneousLight light, const Volume& volume, Random&) {
        // As the vertex shader places them. Away from the sun all meet in one point.
        const bool one_point = light.w == 0.0f;
        const auto far = [&](std::uint32_t v) { return Vertex(one_point ? 0 : v, true); };
        const auto near = [](std::uint32_t v) { return Vertex(v, false); };
        Boundary boundary;
        for (const shared::VolumeTriangle& cap : caps_of(volume)) {
            boundary.add({near(cap.a), near(cap.b), near(cap.c)});
            if (!one_point) boundary.add({far(cap.c), far(cap.b), far(cap.a)});
        }
        for (const shared::VolumeSide& side : volume.sides)
            boundary.add({near(side.b), near(side.a), far(side.a), far(side.b)});
        EXPECT_TRUE(boundary.is_closed());
    });
}

TEST(BuildVolume, HasSidesInClosedLoops) {
    for_each_case([](const Caster&, HomogeneousLight, const Volume& volume, Random&) {
        std::map<std::uint32_t, int> balance;
        for (const shared::VolumeSide& side : volume.sides) {
            ++balance[side.a];
            --balance[side.b];
        }
        for (const auto& [vertex, net] : balance)
            EXPECT_EQ(net, 0) << "at vertex " << vertex;
    });
}

TEST(BuildVolume, HasCapsThatFaceTheLight) {
    for_each_case([](const Caster& caster, HomogeneousLight light, const Volume& volume, Random&) {
        for (const shared::VolumeTriangle& cap : caps_of(volume)) {
            const DVec3 a = to_world(caster, caster.mesh.positions[cap.a]);
            const DVec3 b = to_world(caster, caster.mesh.positions[cap.b]);
            const DVec3 c = to_world(caster, caster.mesh.positions[cap.c]);
            EXPECT_GT(glm::dot(glm::cross(b - a, c - a), to_light(light, a)), 0.0);
        }
    });
}

/// Does the triangle lie between the point and the light?
bool is_between(const std::array<DVec3, 3>& triangle, DVec3 point, HomogeneousLight light_ws) {
    const DVec3 direction = to_light(light_ws, point);
    const glm::dmat3 system(triangle[1] - triangle[0], triangle[2] - triangle[0], -direction);
    const DVec3 at = glm::inverse(system) * (point - triangle[0]);
    return at.x > 0.0 && at.y > 0.0 && at.x + at.y < 1.0 && at.z > 0.0 &&
           (light_ws.w == 0.0f || at.z < 1.0);
}

TEST(BuildVolume, EnclosesWhatTheCasterHidesAndNothingElse) {
    std::size_t hidden_points = 0, lit_points = 0;
    for_each_case(
        [&](const Caster& caster, HomogeneousLight light, const Volume& volume, Random& random) {
            const auto corners = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
                const std::vector<Vec3>& p = caster.mesh.positions;
                return std::array{to_world(caster, p[a]), to_world(caster, p[b]),
                                  to_world(caster, p[c])};
            };
            for (int i = 0; i < 30; ++i) {
                const DVec3 point = to_world(caster, random.point(i % 3 == 0 ? 0.8f : 2.5f));
                bool hidden = false;
                for (const UVec3 t : caster.mesh.triangles)
                    hidden |= is_between(corners(t.x, t.y, t.z), point, light);
                // The volume of a cap is what lies behind it; sides are where that ends.
                int enclosed = 0;
                for (const shared::VolumeTriangle& cap : caps_of(volume))
                    enclosed += is_between(corners(cap.a, cap.b, cap.c), point, light) ? 1 : 0;
                EXPECT_EQ(enclosed > 0, hidden);
                ++(hidden ? hidden_points : lit_points);
            }
        });
    EXPECT_GT(hidden_points, 3000u);
    EXPECT_GT(lit_points, 3000u);
}

/// The corners of a cap, from the least on, so that turns of it are equal.
std::set<std::array<std::uint32_t, 3>> corner_sets(const Volume& volume) {
    std::set<std::array<std::uint32_t, 3>> sets;
    for (const shared::VolumeTriangle& cap : caps_of(volume)) {
        std::array<std::uint32_t, 3> corners{cap.a, cap.b, cap.c};
        std::sort(corners.begin(), corners.end());
        sets.insert(corners);
    }
    return sets;
}

TEST(BuildVolume, OfASolidHasTheTrianglesThatTheLightSees) {
    Random random;
    const Caster torus{"torus", scene::torus(1.0f, 0.4f, 12, 7), random_place(random, true)};
    const Adjacency adjacency = find_adjacency(torus.mesh);
    for (int i = 0; i < 10; ++i) {
        const HomogeneousLight light(normalize(random.point(1.0f)), 0.0f);
        std::set<std::array<std::uint32_t, 3>> seen;
        for (const UVec3 t : adjacency.triangles) {
            const DVec3 a = to_world(torus, torus.mesh.positions[t.x]);
            const DVec3 b = to_world(torus, torus.mesh.positions[t.y]);
            const DVec3 c = to_world(torus, torus.mesh.positions[t.z]);
            // The place mirrors it: outside is the other side.
            if (glm::dot(glm::cross(b - a, c - a), to_light(light, a)) >= 0.0) continue;
            std::array<std::uint32_t, 3> corners{t.x, t.y, t.z};
            std::sort(corners.begin(), corners.end());
            seen.insert(corners);
        }
        EXPECT_EQ(corner_sets(volume_of(torus, light)), seen);
    }
}

TEST(BuildVolume, OfABoxHasItsSilhouette) {
    const Caster box{"box", scene::box(Vec3(-1), Vec3(1))};
    // Off all axes: three faces, and a hexagon around them.
    Volume volume = volume_of(box, {normalize(Vec3(1, 2, 3)), 0.0f});
    EXPECT_EQ(caps_of(volume).size(), 6u);
    EXPECT_EQ(volume.sides.size(), 6u);
    // Over one face: that face and its four edges.
    volume = volume_of(box, {0.1f, 5.0f, 0.2f, 1.0f});
    EXPECT_EQ(caps_of(volume).size(), 2u);
    EXPECT_EQ(volume.sides.size(), 4u);
    // Inside: everything beyond the walls, in one volume without sides.
    volume = volume_of(box, {0.1f, 0.5f, 0.2f, 1.0f});
    EXPECT_EQ(caps_of(volume).size(), 12u);
    EXPECT_EQ(volume.sides.size(), 0u);
}

TEST(BuildVolume, OfASheetEndsAtItsRim) {
    const Caster sheet{"sheet", scene::ground(Vec2(-1), Vec2(1))};
    for (const float y : {1.0f, -1.0f}) {  // from either side
        const Volume volume = volume_of(sheet, {normalize(Vec3(0.3f, y, 0.2f)), 0.0f});
        EXPECT_EQ(caps_of(volume).size(), 2u);
        EXPECT_EQ(volume.sides.size(), 4u);
    }
}

TEST(BuildVolume, CountsAnEdgeOncePerVolumeThatEndsThere) {
    // Three sheets like the pages of a book, all lit from the same side.
    Mesh book;
    book.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 0.3f, 0}, {1, 0.6f, 0}};
    book.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}};
    const Volume volume = volume_of({"book", book}, {normalize(Vec3(0, 1, 0.1f)), 0.0f});
    EXPECT_EQ(caps_of(volume).size(), 3u);
    EXPECT_EQ(volume.sides.size(), 9u);
}

TEST(BuildVolume, KeepsTheCornersOfATriangleInTheirOrder) {
    for_each_case([](const Caster& caster, HomogeneousLight, const Volume& volume, Random&) {
        std::set<std::array<std::uint32_t, 3>> in_mesh;
        for (const UVec3 t : find_adjacency(caster.mesh).triangles)
            in_mesh.insert({t.x, t.y, t.z});
        for (const auto* caps : {&volume.caps, &volume.clockwise_caps}) {
            for (const shared::VolumeTriangle& cap : *caps)
                EXPECT_EQ(in_mesh.count({cap.a, cap.b, cap.c}), 1u);
        }
    });
}

TEST(BuildVolume, LeavesOutWhatTheLightSeesEdgeOn) {
    const Caster sheet{"sheet", scene::ground(Vec2(-1), Vec2(1))};
    for (const HomogeneousLight light :
         {HomogeneousLight(1, 0, 0, 0), HomogeneousLight(5, 0, 1, 1)}) {
        const Volume volume = volume_of(sheet, light);
        EXPECT_TRUE(caps_of(volume).empty());
        EXPECT_TRUE(volume.sides.empty());
    }
}

TEST(BuildVolume, NamesItsVerticesAndItsInstance) {
    const Caster box{"box", scene::box(Vec3(-1), Vec3(1))};
    const HomogeneousLight light(normalize(Vec3(1, 2, 3)), 0.0f);
    const Volume here = volume_of(box, light);
    const Volume there = volume_of(box, light, {.slot = 7, .first_vertex = 1000});
    const std::vector<shared::VolumeTriangle> caps = caps_of(here), moved = caps_of(there);
    ASSERT_EQ(caps.size(), moved.size());
    ASSERT_EQ(here.sides.size(), there.sides.size());
    for (std::size_t i = 0; i < caps.size(); ++i) {
        EXPECT_EQ(moved[i].slot, 7u);
        EXPECT_EQ(moved[i].a, caps[i].a + 1000);
        EXPECT_EQ(moved[i].b, caps[i].b + 1000);
        EXPECT_EQ(moved[i].c, caps[i].c + 1000);
    }
    for (std::size_t i = 0; i < here.sides.size(); ++i) {
        EXPECT_EQ(there.sides[i].slot, 7u);
        EXPECT_EQ(there.sides[i].a, here.sides[i].a + 1000);
        EXPECT_EQ(there.sides[i].b, here.sides[i].b + 1000);
    }
}

TEST(BuildVolume, OfWhatHasNoTrianglesIsEmpty) {
    const Volume volume = volume_of({"nothing", Mesh()}, {0, 1, 0, 0});
    EXPECT_TRUE(caps_of(volume).empty());
    EXPECT_TRUE(volume.sides.empty());
}

TEST(BuildVolume, OfACasterMadeFlatStillCloses) {
    Caster flat{"flat", scene::box(Vec3(-1), Vec3(1)), glm::scale(Mat4(1.0f), {1, 0, 1})};
    const Volume volume = volume_of(flat, {normalize(Vec3(0.1f, 1, 0.2f)), 0.0f});
    std::map<std::uint32_t, int> balance;
    for (const shared::VolumeSide& side : volume.sides) {
        ++balance[side.a];
        --balance[side.b];
    }
    for (const auto& [vertex, net] : balance)
        EXPECT_EQ(net, 0) << "at vertex " << vertex;
    EXPECT_GE(caps_of(volume).size(), 2u);
}

}  // namespace
}  // namespace gnomon::shadow_volumes
