#include "adjacency.h"

#include "scene/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace gnomon::shadow_volumes {
namespace {

Mesh mesh_of(std::vector<Vec3> positions, std::vector<UVec3> triangles) {
    Mesh mesh;
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}

void turn_inside_out(Mesh& mesh) {
    for (UVec3& t : mesh.triangles)
        std::swap(t.y, t.z);
}

Mesh together(Mesh a, const Mesh& b) {
    scene::append(a, b);
    return a;
}

std::size_t edge_count(const Adjacency& adjacency) {
    return adjacency.edges.size() - 1;
}

/// How many edges have how many uses.
std::map<std::uint32_t, std::size_t> use_counts(const Adjacency& adjacency) {
    std::map<std::uint32_t, std::size_t> counts;
    for (std::size_t e = 0; e < edge_count(adjacency); ++e)
        ++counts[adjacency.edges[e + 1].first_use - adjacency.edges[e].first_use];
    return counts;
}

std::size_t count(const std::vector<bool>& flags) {
    return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), true));
}

using Counts = std::map<std::uint32_t, std::size_t>;

/// What holds for every mesh: edges are in order and apart, and their uses are just the three sides
/// of each triangle, each in its direction.
void expect_consistent(const Adjacency& adjacency) {
    ASSERT_FALSE(adjacency.edges.empty());
    EXPECT_EQ(adjacency.edges.back().first_use, adjacency.uses.size());
    EXPECT_EQ(adjacency.uses.size(), 3 * adjacency.triangles.size());
    EXPECT_EQ(adjacency.closed.size(), adjacency.triangles.size());
    EXPECT_EQ(adjacency.inside_out.size(), adjacency.triangles.size());
    std::vector<int> sides_found(adjacency.triangles.size(), 0);
    for (std::size_t e = 0; e < edge_count(adjacency); ++e) {
        const Edge& edge = adjacency.edges[e];
        EXPECT_LT(edge.v0, edge.v1);
        if (e > 0) {
            const Edge& last = adjacency.edges[e - 1];
            EXPECT_LT(std::pair(last.v0, last.v1), std::pair(edge.v0, edge.v1));
        }
        for (std::uint32_t u = edge.first_use; u < adjacency.edges[e + 1].first_use; ++u) {
            const EdgeUse use = adjacency.uses[u];
            const UVec3 t = adjacency.triangles[use.triangle];
            const std::uint32_t from = use.forward != 0 ? edge.v0 : edge.v1;
            const std::uint32_t to = use.forward != 0 ? edge.v1 : edge.v0;
            bool runs_along = false;
            for (int corner = 0; corner < 3; ++corner)
                runs_along |= t[corner] == from && t[(corner + 1) % 3] == to;
            EXPECT_TRUE(runs_along);
            ++sides_found[use.triangle];
        }
    }
    for (const int sides : sides_found)
        EXPECT_EQ(sides, 3);
}

TEST(Adjacency, OfABoxIsThatOfASolid) {
    const Adjacency box = find_adjacency(scene::box(Vec3(-1), Vec3(1)));  // of 24 vertices
    expect_consistent(box);
    EXPECT_EQ(box.triangles.size(), 12u);
    EXPECT_EQ(use_counts(box), (Counts{{2, 18}}));
    EXPECT_EQ(count(box.closed), 12u);
    EXPECT_EQ(count(box.inside_out), 0u);
}

TEST(Adjacency, OfSolidsHasTheirEulerCharacteristic) {
    const std::vector<std::pair<Mesh, int>> solids = {{scene::sphere(1, 12, 7), 2},
                                                      {scene::torus(2, 0.5f, 9, 6), 0},
                                                      {scene::cylinder(1, 0, 2, 11), 2}};
    for (const auto& [mesh, characteristic] : solids) {
        const Adjacency adjacency = find_adjacency(mesh);
        expect_consistent(adjacency);
        std::vector<std::uint32_t> vertices;
        for (const UVec3 t : adjacency.triangles)
            vertices.insert(vertices.end(), {t.x, t.y, t.z});
        std::sort(vertices.begin(), vertices.end());
        vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
        EXPECT_EQ(static_cast<int>(vertices.size()) - static_cast<int>(edge_count(adjacency)) +
                      static_cast<int>(adjacency.triangles.size()),
                  characteristic);
        EXPECT_EQ(count(adjacency.closed), adjacency.triangles.size());
        EXPECT_EQ(count(adjacency.inside_out), 0u);
    }
}

TEST(Adjacency, TellsASolidThatIsInsideOut) {
    for (const Vec3 place : {Vec3(0), Vec3(1e4f, -2e4f, 3e4f)}) {
        Mesh mesh = scene::box(place - 1.0f, place + 1.0f);
        EXPECT_EQ(count(find_adjacency(mesh).inside_out), 0u);
        turn_inside_out(mesh);
        const Adjacency box = find_adjacency(mesh);
        EXPECT_EQ(count(box.closed), 12u);
        EXPECT_EQ(count(box.inside_out), 12u);
    }
}

TEST(Adjacency, OfASheetIsOpen) {
    const Adjacency sheet = find_adjacency(scene::ground(Vec2(-1), Vec2(1)));
    expect_consistent(sheet);
    EXPECT_EQ(use_counts(sheet), (Counts{{1, 4}, {2, 1}}));
    EXPECT_EQ(count(sheet.closed), 0u);
}

TEST(Adjacency, CountsThreeTrianglesAtAnEdge) {
    const Adjacency fan =
        find_adjacency(mesh_of({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 1}, {-1, 0, -1}},
                               {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}}));
    expect_consistent(fan);
    EXPECT_EQ(use_counts(fan), (Counts{{1, 6}, {3, 1}}));
    EXPECT_EQ(count(fan.closed), 0u);
}

TEST(Adjacency, TakesVerticesAtOnePlaceForOne) {
    // Two triangles of a square that share no vertex; one writes its zeros as -0.
    const Adjacency square = find_adjacency(
        mesh_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-0.0f, 0, -0.0f}, {1, 1, -0.0f}, {0, 1, 0}},
                {{0, 1, 2}, {3, 4, 5}}));
    expect_consistent(square);
    EXPECT_EQ(use_counts(square), (Counts{{1, 4}, {2, 1}}));
}

TEST(Adjacency, LeavesOutTrianglesOfLessThanThreePlaces) {
    Mesh mesh = scene::box(Vec3(-1), Vec3(1));
    const auto count_before = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(mesh.positions[3]);
    mesh.triangles.push_back({5, 5, 7});
    mesh.triangles.push_back({count_before, 3, 7});
    mesh.triangles.push_back({9, 9, 9});
    const Adjacency box = find_adjacency(mesh);
    expect_consistent(box);
    EXPECT_EQ(box.triangles.size(), 12u);
    EXPECT_EQ(count(box.closed), 12u);
}

TEST(Adjacency, OfOneFlippedTriangleOpensItsPieceOnly) {
    Mesh flipped = scene::box(Vec3(-1), Vec3(1));
    std::swap(flipped.triangles[4].x, flipped.triangles[4].y);
    const Mesh mesh = together(std::move(flipped), scene::box(Vec3(3), Vec3(4)));
    const Adjacency adjacency = find_adjacency(mesh);
    expect_consistent(adjacency);
    for (std::size_t t = 0; t < 24; ++t)
        EXPECT_EQ(adjacency.closed[t], t >= 12);
}

TEST(Adjacency, JudgesEachPieceByItself) {
    Mesh inside_out = scene::box(Vec3(5), Vec3(6));
    turn_inside_out(inside_out);
    // The larger solid is the right way round, the smaller is not, the sheet is none.
    Mesh mesh = together(scene::box(Vec3(-2), Vec3(2)), inside_out);
    mesh = together(std::move(mesh), scene::ground(Vec2(-9), Vec2(-7)));
    const Adjacency adjacency = find_adjacency(mesh);
    for (std::size_t t = 0; t < 26; ++t) {
        EXPECT_EQ(adjacency.closed[t], t < 24) << t;
        if (t >= 24) continue;  // a sheet has no inside
        EXPECT_EQ(adjacency.inside_out[t], t >= 12) << t;
    }
}

TEST(Adjacency, JudgesSolidsThatTouchAtAnEdgeByThemselves) {
    Mesh inside_out = scene::box(Vec3(0, -1, 0), Vec3(0.5f, 1, 0.5f));
    turn_inside_out(inside_out);
    const Adjacency adjacency =
        find_adjacency(together(scene::box(Vec3(-1, -1, -1), Vec3(0, 1, 0)), inside_out));
    expect_consistent(adjacency);
    EXPECT_EQ(use_counts(adjacency), (Counts{{2, 34}, {4, 1}}));
    for (std::size_t t = 0; t < 24; ++t) {
        EXPECT_TRUE(adjacency.closed[t]) << t;
        EXPECT_EQ(adjacency.inside_out[t], t >= 12) << t;
    }
}

TEST(Adjacency, OfASheetWithTwoFacesEnclosesNothing) {
    Mesh mesh = mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}});
    const Adjacency sheet = find_adjacency(mesh);
    expect_consistent(sheet);
    EXPECT_EQ(count(sheet.closed), 0u);
}

TEST(Adjacency, OfTheSameTriangleTwiceIsOpen) {
    const Adjacency twice =
        find_adjacency(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {1, 2, 0}}));
    expect_consistent(twice);
    EXPECT_EQ(use_counts(twice), (Counts{{2, 3}}));
    EXPECT_EQ(count(twice.closed), 0u);
}

TEST(Adjacency, OfNothingIsEmpty) {
    const Adjacency nothing = find_adjacency(Mesh());
    EXPECT_TRUE(nothing.triangles.empty());
    EXPECT_EQ(edge_count(nothing), 0u);
}

}  // namespace
}  // namespace gnomon::shadow_volumes
