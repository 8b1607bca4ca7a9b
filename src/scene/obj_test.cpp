#include "scene/load_test_scene.h"
#include "scene/obj_polygon.h"

#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace gnomon::scene {
namespace {

Scene load_text(const std::string& text, const LoadOptions& options = {}) {
    const TestFolder folder;
    return load_scene(folder.write("scene.obj", text), options);
}

double area_m2(const Mesh& mesh) {
    double area = 0.0;
    for (const UVec3& t : mesh.triangles) {
        area += 0.5 * glm::length(glm::cross(mesh.positions[t.y] - mesh.positions[t.x],
                                             mesh.positions[t.z] - mesh.positions[t.x]));
    }
    return area;
}

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Obj, PolygonsBecomeTriangles) {
    const Scene scene = load_text(kSquare + "f 1 2 3 4\nf 4 3 2\n");
    EXPECT_EQ(scene.triangle_count(), 3u);
    EXPECT_EQ(scene.meshes().at(0).positions.size(), 4u) << "equal corners are one vertex";
    EXPECT_TRUE(scene.warnings().empty());
    EXPECT_TRUE(scene.meshes()[0].normals.empty());
}

TEST(Obj, NegativeIndicesCountFromTheEnd) {
    const Scene scene = load_text("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 7 7 7\n");
    EXPECT_EQ(scene.meshes().at(0).positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(Obj, GroupsAreObjectsAndMaterialsMeshes) {
    const TestFolder folder;
    folder.write("a library.mtl", "newmtl red\nKd 1 0 0\nnewmtl sky blue \nKd 0 0 1\n");
    const Scene scene = load_scene(folder.write(
        "scene.obj", "mtllib a library.mtl\n" + kSquare +
                         "o house\ng roof\nusemtl red\nf 1 2 3\nusemtl sky blue\nf 1 3 4\n"
                         "g wall\nf 1 2 4\ng roof\nf 2 3 4\n"));
    ASSERT_EQ(scene.instances().size(), 3u);
    EXPECT_EQ(scene.instances()[0].name, "house/roof");
    EXPECT_EQ(scene.instances()[0].object, scene.instances()[1].object);
    EXPECT_EQ(scene.instances()[2].name, "house/wall");
    EXPECT_NE(scene.instances()[0].object, scene.instances()[2].object);
    const auto color = [&](std::size_t instance) {
        const Mesh& mesh = scene.meshes()[scene.instances()[instance].mesh];
        return Vec3(scene.materials()[mesh.material].base_color);
    };
    EXPECT_EQ(color(0), Vec3(1, 0, 0));
    EXPECT_EQ(color(1), Vec3(0, 0, 1));
    EXPECT_TRUE(scene.warnings().empty());
}

TEST(Obj, ZUpIsTurned) {
    const Scene scene =
        load_text("v 1 2 3\nv 4 5 6\nv 7 8 10\nvn 0 0 1\nf 1//1 2//1 3//1\n", {.up = UpAxis::z});
    EXPECT_EQ(scene.meshes().at(0).positions[0], Vec3(1, 3, -2));
    EXPECT_EQ(scene.meshes().at(0).normals[0], Vec3(0, 1, 0));
}

TEST(Obj, CoordinatesFarFromTheOriginAreRecentredInDouble) {
    const Scene scene = load_text(
        "v 84616.123 447423.456 -0.5\nv 85140.001 447423.456 -0.5\nv 84616.123 447750.789 13.6\n"
        "f 1 2 3\n",
        {.up = UpAxis::z});
    EXPECT_EQ(scene.origin_offset_m(), DVec3(84878, 0, -447587));
    // Floats up to 262 m are 0.03 mm apart.
    expect_near(corner_in_file(scene, 0, 0, 0), {84616.123, -0.5, -447423.456}, 3e-5);
    expect_near(corner_in_file(scene, 0, 0, 2), {84616.123, 13.6, -447750.789}, 3e-5);
}

TEST(Obj, TextureCoordinatesAreTurnedToTheTop) {
    const TestFolder folder;
    folder.write_png("t.png", {1, 2, 3, 255, 4, 5, 6, 255});
    folder.write("m.mtl", "newmtl m\nKd 0 0 0\nmap_Kd -s 2 4 -o 0.5 0.25 -clamp on t.png\n");
    const Scene scene = load_scene(folder.write(
        "scene.obj",
        "mtllib m.mtl\n" + kSquare + "vt 0 0\nvt 1 0\nvt 0 0.25\nusemtl m\nf 1/1 2/2 3/3\n"));
    EXPECT_TRUE(scene.warnings().empty());
    const Material& material = scene.materials().at(scene.meshes().at(0).material);
    const Texture& texture =
        scene.textures().at(static_cast<std::size_t>(material.base_color_texture));
    EXPECT_EQ(texture.wrap_u, TextureWrap::clamp);
    EXPECT_EQ(Vec3(material.base_color), Vec3(1.0f)) << "a black Kd beside a texture";
    EXPECT_FALSE(material.masked());
    const auto uv = [&](std::size_t vertex) {
        const Vec2 p =
            material.uv_scale_rotation * scene.meshes()[0].texcoords[vertex] + material.uv_offset;
        return DVec3(p.x, p.y, 0.0);
    };
    expect_near(uv(0), {0.5, 1.0 - 0.25, 0}, kRounding);
    expect_near(uv(1), {2.5, 1.0 - 0.25, 0}, kRounding);
    expect_near(uv(2), {0.5, 1.0 - 1.25, 0}, kRounding);
}

Scene load_with_material(const TestFolder& folder, const std::string& mtl) {
    folder.write("m.mtl", "newmtl m\nKd 1 1 1\n" + mtl + "\n");
    return load_scene(folder.write(
        "scene.obj", "mtllib m.mtl\n" + kSquare + "vt 0 0\nusemtl m\nf 1/1 2/1 3/1\n"));
}

TEST(Obj, AlphaComesFromMapDOrTheTextureItself) {
    const TestFolder folder;
    folder.write_png("solid.png", {10, 20, 30, 255, 10, 20, 30, 255});
    folder.write_png("holes.png", {10, 20, 30, 255, 10, 20, 30, 0});
    folder.write_png("grey.png",
                     {255, 255, 255, 255, 0, 0, 0, 255, 255, 255, 255, 255, 0, 0, 0, 255});
    const auto load = [&](const std::string& mtl) {
        const Scene scene = load_with_material(folder, mtl);
        EXPECT_TRUE(scene.warnings().empty()) << mtl;
        return scene;
    };
    EXPECT_EQ(load("map_Kd solid.png").materials().at(0).alpha_cutoff, 0.0f);
    EXPECT_EQ(load("map_Kd holes.png").materials().at(0).alpha_cutoff, 0.5f);
    EXPECT_EQ(load("map_d holes.png").textures().at(0).rgba,
              (std::vector<std::uint8_t>{255, 255, 255, 255, 255, 255, 255, 0}));
    // The mask is wider than the picture, and has its values in its colours.
    const Scene masked = load("map_Kd solid.png\nmap_d grey.png");
    EXPECT_EQ(masked.materials().at(0).alpha_cutoff, 0.5f);
    EXPECT_EQ(masked.textures().at(0).size, (Extent{4, 1}));
    EXPECT_EQ(masked.textures().at(0).rgba[3], 255);
    EXPECT_EQ(masked.textures().at(0).rgba[7], 0);
    EXPECT_EQ(masked.textures().at(0).rgba[4], 10);
}

TEST(Obj, TransparencyIsAMask) {
    const TestFolder folder;
    EXPECT_FALSE(load_with_material(folder, "d 1").materials().at(0).masked());
    EXPECT_FALSE(load_with_material(folder, "d 0.7").materials().at(0).masked())
        << "more than half";
    const Scene glass = load_with_material(folder, "d 0.2");
    EXPECT_TRUE(glass.materials().at(0).masked());
    EXPECT_TRUE(has_warning(glass, "so transparent"));
    EXPECT_FLOAT_EQ(load_with_material(folder, "Tr 0.8").materials().at(0).base_color.a, 0.2f);
}

TEST(Obj, MissingFilesAreOneWarningEachKind) {
    const TestFolder folder;
    std::string mtl;
    std::string obj = "mtllib missing.mtl\nmtllib m.mtl\n" + kSquare + "vt 0 0\n";
    for (int i = 0; i < 20; ++i) {
        const std::string number = std::to_string(i);
        mtl += "newmtl m" + number + "\nmap_Kd picture" + number + ".png\n";
        obj += "usemtl m" + number + "\nf 1/1 2/1 3/1\nusemtl none" + number + "\nf 1/1 2/1 4/1\n";
    }
    folder.write("m.mtl", mtl);
    const Scene scene = load_scene(folder.write("scene.obj", obj));
    EXPECT_EQ(scene.triangle_count(), 40u);
    EXPECT_EQ(scene.warnings().size(), 3u);
    EXPECT_TRUE(has_warning(scene, "missing.mtl"));
    EXPECT_TRUE(has_warning(scene, "and 17 more"));
}

TEST(Obj, PathsOfAnotherMachineLeadToTheFileBesideTheScene) {
    const TestFolder folder;
    folder.write_png("t.png", {1, 2, 3, 255});
    for (const std::string name :
         {"C:\\work\\t.png", "/somewhere/t.png", "..\\t.png", "maps/t.png"}) {
        EXPECT_TRUE(load_with_material(folder, "map_Kd " + name).warnings().empty()) << name;
    }
}

TEST(Obj, FaultyFacesAreLeftOut) {
    const Scene scene =
        load_text(kSquare + "f 1 2 3\nf 1 2 99\nf 1 2\nf 0 1 2\nf -9 1 2\nf 1/5 2/5 3/5\n");
    EXPECT_EQ(scene.triangle_count(), 2u);
    EXPECT_TRUE(has_warning(scene, "vertices that are not there are left out (3 in all)"));
    EXPECT_TRUE(has_warning(scene, "fewer than three corners"));
}

TEST(Obj, LinesMayBeContinued) {
    EXPECT_EQ(load_text(kSquare + "f 1 2 \\\n 3 \\\r\n4\n").triangle_count(), 2u);
    EXPECT_EQ(load_text("\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3").triangle_count(), 1u);
}

TEST(Obj, OtherTextsAreRefused) {
    EXPECT_THROW(load_text(""), Error);
    EXPECT_THROW(load_text("no vertex in here\n"), Error);
    EXPECT_THROW(load_text(std::string("\xFF\xFEv\0 \0", 6)), Error);
}

TEST(Obj, ConcavePolygonsAreCutInside) {
    // An L of area 3: a fan from its first corner would cover the notch.
    const Scene scene =
        load_text("v 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nf 1 2 3 4 5 6\n");
    EXPECT_EQ(scene.triangle_count(), 4u);
    EXPECT_NEAR(area_m2(scene.meshes().at(0)), 3.0, kRounding);
}

// The sum of the triangles' areas along the polygon's normal, and of their magnitudes: equal, and
// the polygon's area, if and only if no triangle is turned over or overlaps.
void expect_cut(const std::vector<DVec3>& polygon, double area) {
    std::uint64_t budget = 1'000'000;
    std::vector<UVec3> triangles;
    triangulate(polygon, budget, triangles);
    ASSERT_EQ(triangles.size(), polygon.size() - 2);
    DVec3 sum(0.0);
    double magnitudes = 0.0;
    for (const UVec3& t : triangles) {
        const DVec3 normal =
            0.5 * glm::cross(polygon[t.y] - polygon[t.x], polygon[t.z] - polygon[t.x]);
        sum += normal;
        magnitudes += glm::length(normal);
    }
    EXPECT_NEAR(glm::length(sum), area, 1e-9 * area);
    EXPECT_NEAR(magnitudes, area, 1e-9 * area);
}

TEST(Triangulate, CutsConcaveQuadsAtTheNotch) {
    for (std::size_t first = 0; first < 4; ++first) {
        std::vector<DVec3> arrow{{0, 0, 0}, {2, -1, 0}, {0.5, 0, 0}, {2, 1, 0}};
        std::rotate(arrow.begin(), arrow.begin() + static_cast<std::ptrdiff_t>(first), arrow.end());
        expect_cut(arrow, 0.5);
    }
}

TEST(Triangulate, CutsStarsInAnyPlaneFarFromTheOrigin) {
    constexpr int kTips = 9;
    const double inner = 0.3;
    std::vector<DVec3> star;
    for (int i = 0; i < 2 * kTips; ++i) {
        const double angle = glm::pi<double>() * i / kTips;
        const double radius = i % 2 == 0 ? 1.0 : inner;
        const double x = radius * std::cos(angle);
        const double y = radius * std::sin(angle);
        star.emplace_back(85000.0 + x, 447000.0 + y, x + 0.5 * y);
    }
    // On the plane z = x + y / 2 areas are larger by the length of (1, 1/2, -1).
    const double area = kTips * inner * std::sin(glm::pi<double>() / kTips) * 1.5;
    std::uint64_t budget = 1'000'000;
    std::vector<UVec3> triangles;
    triangulate(star, budget, triangles);
    double sum = 0.0;
    for (const UVec3& t : triangles)
        sum += 0.5 * glm::length(glm::cross(star[t.y] - star[t.x], star[t.z] - star[t.x]));
    EXPECT_NEAR(sum, area, 1e-9);  // coordinates near 447,000 are 6e-11 apart
}

TEST(Triangulate, CutsAPolygonWithAHoleAtItsSeam) {
    // A square of 4 with a square hole of 1, joined by a seam that goes there and back.
    expect_cut({{0, 0, 0},
                {2, 0, 0},
                {2, 2, 0},
                {0, 2, 0},
                {0, 0, 0},
                {0.5, 0.5, 0},
                {0.5, 1.5, 0},
                {1.5, 1.5, 0},
                {1.5, 0.5, 0},
                {0.5, 0.5, 0}},
               3.0);
}

TEST(Triangulate, AlwaysEndsWithAllTriangles) {
    const std::vector<DVec3> bow{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 2, 0}};
    const std::vector<DVec3> point(7, DVec3(1.0));
    const std::vector<DVec3> nan(5, DVec3(std::nan("")));
    for (const std::vector<DVec3>& polygon : {bow, point, nan}) {
        for (std::uint64_t budget : {0, 10, 1000}) {
            std::vector<UVec3> triangles;
            triangulate(polygon, budget, triangles);
            EXPECT_EQ(triangles.size(), polygon.size() - 2);
        }
    }
}

}  // namespace
}  // namespace gnomon::scene
