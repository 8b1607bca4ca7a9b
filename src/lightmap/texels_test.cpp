#include "lightmap/texels.h"

#include "lightmap/scenes_test.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace gnomon::lightmap {
namespace {

std::array<DVec3, 3> corners_ws(const Scene& scene, const Atlas& atlas, const Texel& texel) {
    const PlacedTriangle& placed = atlas.triangles[texel.triangle];
    const Chart& chart = atlas.charts[atlas.facets[texel.facet].chart];
    const Instance& instance = scene.instances()[chart.instance];
    const Mesh& mesh = scene.meshes()[instance.mesh];
    std::array<DVec3, 3> corners;
    for (int i = 0; i < 3; ++i) {
        const DVec3 p(mesh.positions[mesh.triangles[placed.triangle][i]]);
        corners[static_cast<std::size_t>(i)] =
            DVec3(glm::dmat4(instance.world_from_local) * glm::dvec4(p, 1.0));
    }
    return corners;
}

/// How far a point is from its triangle's plane or outside its edges, in metres; 0 on it.
double distance_off(const std::array<DVec3, 3>& c, DVec3 p) {
    const DVec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
    const double area2 = glm::length(normal);
    double off = std::abs(glm::dot(normal, p - c[0])) / area2;
    for (std::size_t i = 0; i < 3; ++i) {
        const DVec3 edge = c[(i + 1) % 3] - c[i];
        const DVec3 inwards = glm::cross(normal, edge) / (area2 * glm::length(edge));
        off = std::max(off, -glm::dot(inwards, p - c[i]));
    }
    return off;
}

/// What must be true of the texels of any scene.
void expect_sound(const Scene& scene, const Options& options) {
    SCOPED_TRACE(scene.source());
    const Atlas atlas = make_atlas(scene, options);
    const Texels found = make_texels(scene, atlas);
    ASSERT_FALSE(found.texels.empty());

    std::vector<std::vector<std::uint32_t>> pages;
    for (const unsigned side : atlas.page_sides_texels)
        pages.emplace_back(std::size_t{side} * side, 0u);
    for (const Texel& texel : found.texels) {
        const Facet& facet = atlas.facets[texel.facet];
        const Chart& chart = atlas.charts[facet.chart];
        // Corners come from float: their own rounding in double is far below 1e-9 m.
        ASSERT_LT(distance_off(corners_ws(scene, atlas, texel), texel.point_ws), 1e-9);
        ASSERT_EQ(atlas.triangles[texel.triangle].facet, texel.facet);
        const DVec3 center_ws = facet.point_ws({texel.x + 0.5, texel.y + 0.5});
        if (!texel.clamped) {
            // Within what a facet's triangles may be off its map.
            ASSERT_LT(glm::distance(texel.point_ws, center_ws), 0.03 * options.texel_size_m);
        }
        const unsigned side = atlas.page_sides_texels[chart.page];
        ASSERT_LT(texel.x, side);
        ASSERT_LT(texel.y, side);
        std::uint32_t& owner = pages[chart.page][std::size_t{texel.y} * side + texel.x];
        ASSERT_EQ(owner, 0u) << "a texel of two charts";
        owner = facet.chart + 1;
    }

    // No texel has another chart within the padding.
    const int padding = static_cast<int>(options.padding_texels);
    for (std::size_t p = 0; p < pages.size(); ++p) {
        const int side = static_cast<int>(atlas.page_sides_texels[p]);
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                const std::uint32_t own = pages[p][static_cast<std::size_t>(y) * side + x];
                if (own == 0) continue;
                for (int dy = 0; dy <= padding && y + dy < side; ++dy) {
                    for (int dx = -padding; dx <= padding; ++dx) {
                        if (x + dx < 0 || x + dx >= side) continue;
                        const auto other =
                            pages[p][static_cast<std::size_t>(y + dy) * side + x + dx];
                        ASSERT_TRUE(other == 0 || other == own) << x << ", " << y;
                    }
                }
            }
        }
    }

    // Tiles cover every texel once, in order, each within its square.
    std::uint64_t next = 0;
    for (const Tile& tile : found.tiles) {
        ASSERT_EQ(tile.first_texel, next);
        ASSERT_GE(tile.texel_count, 1u);
        ASSERT_LE(tile.texel_count, kMaxTileTexels);
        ASSERT_LE(tile.width, kTileSide);
        ASSERT_LE(tile.height, kTileSide);
        for (std::uint32_t i = 0; i < tile.texel_count; ++i) {
            const Texel& texel = found.texels[next + i];
            ASSERT_EQ(texel.facet, tile.facet);
            ASSERT_GE(texel.x, tile.x);
            ASSERT_LT(texel.x, tile.x + tile.width);
            ASSERT_GE(texel.y, tile.y);
            ASSERT_LT(texel.y, tile.y + tile.height);
        }
        next += tile.texel_count;
    }
    ASSERT_EQ(next, found.texels.size());
}

TEST(Texels, AreSoundOnBuiltinScenes) {
    expect_sound(make_builtin_scene("courtyard"), {.texel_size_m = 0.1});
    expect_sound(make_builtin_scene("gas-station"), {.texel_size_m = 0.1, .padding_texels = 4});
    expect_sound(make_builtin_scene("field-small"), {.texel_size_m = 0.5, .padding_texels = 1});
    expect_sound(make_builtin_scene("cube"), {.texel_size_m = 0.07, .padding_texels = 0});
}

TEST(Texels, AreSoundOnPagesThatAreFull) {
    expect_sound(make_builtin_scene("courtyard"), {.texel_size_m = 0.1, .max_page_texels = 256});
}

TEST(Texels, OfACubeLieOnItsSides) {
    const Scene scene = placed(unit_cube(), {scene::translation({10, 0, 0})});
    const Atlas atlas = make_atlas(scene, {.texel_size_m = 0.1});
    const Texels found = make_texels(scene, atlas);
    ASSERT_EQ(found.texels.size(), 600u);
    EXPECT_EQ(found.tiles.size(), 24u) << "10 x 10 texels are 4 squares of 8 and less";
    for (const Texel& texel : found.texels) {
        EXPECT_FALSE(texel.clamped);
        const DVec3 p = texel.point_ws - DVec3(10, 0, 0);
        EXPECT_NEAR(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), 0.5, 1e-12);
        EXPECT_NEAR(glm::dot(p, atlas.facets[texel.facet].normal_ws), 0.5, 1e-12);
    }
}

TEST(Texels, HaveTheSurfacesArea) {
    for (const char* name : {"courtyard", "gas-station", "field-small"}) {
        const Scene scene = make_builtin_scene(name);
        const Atlas atlas = make_atlas(scene, {.texel_size_m = 0.1});
        const Texels found = make_texels(scene, atlas);
        double surface_m2 = 0.0;
        double border_m2 = 0.0;
        for (const Facet& facet : atlas.facets) {
            const double texel_m2 = glm::length(glm::cross(facet.u_ws, facet.v_ws));
            for (std::uint32_t i = 0; i < facet.triangle_count; ++i) {
                const Corners& c = atlas.triangles[facet.first_triangle + i].corners_texels;
                const dvec2 a = c[1] - c[0];
                const dvec2 b = c[2] - c[0];
                surface_m2 += 0.5 * std::abs(a.x * b.y - a.y * b.x) * texel_m2;
            }
        }
        double inside_m2 = 0.0;
        double touched_m2 = 0.0;
        for (const Texel& texel : found.texels) {
            const Facet& facet = atlas.facets[texel.facet];
            const double texel_m2 = glm::length(glm::cross(facet.u_ws, facet.v_ws));
            touched_m2 += texel_m2;
            if (!texel.clamped) inside_m2 += texel_m2;
        }
        for (const Chart& chart : atlas.charts)
            border_m2 += 2.0 * (chart.size.width + chart.size.height) * 0.01;
        // Touched texels cover it; they exceed it by no more than charts' borders have texels, and
        // a chart's border is at most about twice that of its rectangle.
        EXPECT_GT(touched_m2, surface_m2 * (1.0 - 1e-3)) << name;
        EXPECT_LT(touched_m2 - surface_m2, 2.0 * border_m2) << name;
        EXPECT_LT(std::abs(inside_m2 - surface_m2), border_m2) << name;
    }
}

TEST(Texels, TinyTrianglesHaveFewButOne) {
    // Legs of 0.15 m on texels of 0.1 m: 2 x 2, the long edge through the middle.
    const Scene small = scene_of({soup({{0, 0, 0}, {0.15f, 0, 0}, {0, 0.15f, 0}})});
    const Atlas atlas = make_atlas(small, {.texel_size_m = 0.1});
    ASSERT_EQ(atlas.charts.size(), 1u);
    EXPECT_EQ(atlas.charts[0].size, (Extent{2, 2}));
    EXPECT_EQ(make_texels(small, atlas).texels.size(), 3u);

    const Scene tiny = scene_of({soup({{0, 0, 0}, {1e-3f, 0, 0}, {0, 1e-3f, 0}})});
    const Texels one = make_texels(tiny, make_atlas(tiny, {.texel_size_m = 0.1}));
    ASSERT_EQ(one.texels.size(), 1u);
    EXPECT_TRUE(one.texels[0].clamped || glm::length(one.texels[0].point_ws) < 2e-3)
        << "on the triangle either way";
}

TEST(Texels, DegenerateTrianglesHaveNone) {
    Mesh mesh = unit_cube();
    mesh.triangles.emplace_back(0, 0, 0);
    mesh.triangles.emplace_back(0, 1, 1);
    const Scene scene = scene_of({mesh});
    EXPECT_EQ(make_texels(scene, make_atlas(scene, {.texel_size_m = 0.1})).texels.size(), 600u);
}

TEST(Texels, BothSidesOfASheetHaveTheirOwn) {
    Mesh sheet = scene::ground(Vec2(0), Vec2(1));
    sheet.texcoords.clear();
    for (const bool kept : {false, true}) {
        if (kept) {
            for (const Vec3 p : sheet.positions)
                sheet.lightmap_texcoords.emplace_back(p.x, p.z);
        }
        const Scene scene = scene_of({sheet}, true);
        const Atlas atlas = make_atlas(scene, {.texel_size_m = 0.1});
        EXPECT_EQ(atlas.charts.at(0).texcoord_set, kept ? 1 : -1);
        const Texels found = make_texels(scene, atlas);
        EXPECT_EQ(found.texels.size(), 200u);
        std::map<double, int> by_side;
        for (const Texel& texel : found.texels) {
            const DVec3 normal = atlas.facets[texel.facet].normal_ws;
            ++by_side[normal.y];
            EXPECT_EQ(atlas.triangles[texel.triangle].back, normal.y < 0.0);
        }
        EXPECT_EQ(by_side, (std::map<double, int>{{-1.0, 100}, {1.0, 100}}));
    }
}

}  // namespace
}  // namespace gnomon::lightmap
