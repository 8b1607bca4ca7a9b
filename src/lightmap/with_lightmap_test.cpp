#include "lightmap/scenes_test.h"
#include "lightmap/texels.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

namespace gnomon::lightmap {
namespace {

double area_ws(const Scene& scene) {
    double area = 0.0;
    for (std::uint32_t i = 0; i < scene.instances().size(); ++i) {
        const Mesh& mesh = scene.meshes()[scene.instances()[i].mesh];
        const glm::mat3 linear(scene.instances()[i].world_from_local);
        for (const UVec3 t : mesh.triangles) {
            const DVec3 a(linear * (mesh.positions[t.y] - mesh.positions[t.x]));
            const DVec3 b(linear * (mesh.positions[t.z] - mesh.positions[t.x]));
            area += 0.5 * glm::length(glm::cross(a, b));
        }
    }
    return area;
}

TEST(WithLightmap, EveryInstanceHasItsOwnPlaces) {
    const Scene scene = placed(unit_cube(), {Mat4(1.0f), scene::translation({3, 0, 0})});
    const Atlas atlas = make_atlas(scene, {.texel_size_m = 0.1});
    const Scene mapped = with_lightmap(scene, atlas);
    ASSERT_EQ(mapped.instances().size(), 2u);
    ASSERT_EQ(mapped.meshes().size(), 2u);
    EXPECT_EQ(mapped.meshes()[0].name, "cube");
    EXPECT_NE(mapped.meshes()[0].lightmap_texcoords, mapped.meshes()[1].lightmap_texcoords);
    for (const Mesh& mesh : mapped.meshes()) {
        EXPECT_EQ(mesh.positions.size(), 24u) << "four corners a side";
        EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
        for (const Vec2 uv : mesh.lightmap_texcoords) {
            EXPECT_GE(std::min(uv.x, uv.y), 0.0f);
            EXPECT_LE(std::max(uv.x, uv.y), 1.0f);
        }
    }
    EXPECT_DOUBLE_EQ(area_ws(mapped), area_ws(scene));
}

TEST(WithLightmap, WhatWasMadeIsALightMapWhenItComesBackFromAFile) {
    const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                       ("gnomon_lightmap_" + std::to_string(::getpid()) + ".glb");
    // Whole numbers of texels, so that charts lie on texels' borders.
    const Scene scene = placed(unit_cube(), {Mat4(1.0f), scene::scaling({1, 2, 3})});
    const Options options{.texel_size_m = 0.1};
    const Scene mapped = with_lightmap(scene, make_atlas(scene, options));
    write_glb(path, mapped);
    const Scene back = load_scene(path.string());
    std::filesystem::remove(path);
    ASSERT_EQ(back.meshes().size(), 2u);
    for (std::size_t i = 0; i < 2; ++i)
        EXPECT_EQ(back.meshes()[i].lightmap_texcoords, mapped.meshes()[i].lightmap_texcoords);
    const Atlas again = make_atlas(back, options);
    EXPECT_TRUE(again.warnings.empty());
    for (const Chart& chart : again.charts)
        EXPECT_EQ(chart.texcoord_set, 1);
    EXPECT_EQ(make_texels(back, again).texels.size(),
              make_texels(scene, make_atlas(scene, options)).texels.size());
}

TEST(WithLightmap, BacksBecomeTrianglesOfOneSidedMaterials) {
    const Scene scene = scene_of({named(scene::ground(Vec2(0), Vec2(1)), "leaf")}, true);
    const Scene mapped =
        with_lightmap(scene, make_atlas(scene, {.texel_size_m = 0.1, .keep_texcoords = false}));
    ASSERT_EQ(mapped.meshes().size(), 1u);
    const Mesh& mesh = mapped.meshes()[0];
    ASSERT_EQ(mesh.triangles.size(), 4u);
    EXPECT_FALSE(mapped.materials()[mesh.material].double_sided);
    int up = 0;
    for (const UVec3 t : mesh.triangles) {
        const Vec3 normal = glm::cross(mesh.positions[t.y] - mesh.positions[t.x],
                                       mesh.positions[t.z] - mesh.positions[t.x]);
        up += normal.y > 0.0f ? 1 : -1;
        EXPECT_GT(glm::dot(normal, mesh.normals[t.x]), 0.0f) << "shading normals turn along";
    }
    EXPECT_EQ(up, 0);
}

TEST(WithLightmap, SeveralPagesAreSeveralMeshes) {
    const Scene scene = make_builtin_scene("courtyard");
    const Atlas atlas = make_atlas(scene, {.texel_size_m = 0.1, .max_page_texels = 256});
    ASSERT_GT(atlas.page_sides_texels.size(), 1u);
    const Scene mapped = with_lightmap(scene, atlas);
    EXPECT_GT(mapped.meshes().size(), scene.instances().size());
    EXPECT_TRUE(std::ranges::all_of(mapped.meshes(), [](const Mesh& mesh) {
        return mesh.name.find(", page ") != std::string::npos;
    }));
    std::size_t triangles = 0;
    for (const Mesh& mesh : mapped.meshes())
        triangles += mesh.triangles.size();
    EXPECT_EQ(triangles, atlas.triangles.size());
}

TEST(WithLightmap, PlacesOnTheMapAreThePointsOfTheTexels) {
    const Scene scene = make_builtin_scene("gas-station");
    const Atlas atlas = make_atlas(scene, {.texel_size_m = 0.2});
    for (const Facet& facet : atlas.facets) {
        const Chart& chart = atlas.charts[facet.chart];
        const Instance& instance = scene.instances()[chart.instance];
        const Mesh& mesh = scene.meshes()[instance.mesh];
        for (std::uint32_t i = 0; i < facet.triangle_count; ++i) {
            const PlacedTriangle& placed = atlas.triangles[facet.first_triangle + i];
            for (int c = 0; c < 3; ++c) {
                const Vec3 p = mesh.positions[mesh.triangles[placed.triangle][c]];
                const DVec3 p_ws(glm::dmat4(instance.world_from_local) * glm::dvec4(p, 1.0));
                const dvec2 at = placed.corners_texels[static_cast<std::size_t>(c)];
                // What a facet may be off its triangles, and a rounding.
                ASSERT_LT(glm::distance(facet.point_ws(at), p_ws), 0.0101 * 0.2);
            }
        }
    }
}

}  // namespace
}  // namespace gnomon::lightmap
