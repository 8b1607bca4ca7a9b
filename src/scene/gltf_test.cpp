#include "scene/load_test_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iterator>
#include <limits>

namespace gnomon::scene {
namespace {

using nlohmann::json;

TEST(Gltf, LoadsATriangleAndAddsCameraAndSun) {
    TestGltf gltf;
    gltf.add_triangle();
    const Scene scene = gltf.load();
    ASSERT_EQ(scene.triangle_count(), 1u);
    EXPECT_TRUE(scene.warnings().empty());
    EXPECT_EQ(scene.cameras().size(), 1u);
    ASSERT_EQ(scene.lights().size(), 1u);
    EXPECT_EQ(light_kind(scene.lights()[0]), "directional");
    EXPECT_EQ(scene.bounds().max, Vec3(1, 1, 0));
    EXPECT_TRUE(scene.meshes()[0].normals.empty()) << "normals are not made up";
}

TEST(Gltf, SparseAccessorsReplaceElements) {
    TestGltf gltf;
    const int base = gltf.view(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int where = gltf.view(std::vector<std::uint8_t>{1});
    const int values = gltf.view(std::vector<float>{5, 6, 7});
    const json sparse{{"count", 1},
                      {"indices", {{"bufferView", where}, {"componentType", 5121}}},
                      {"values", {{"bufferView", values}}}};
    const json common{{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}, {"sparse", sparse}};
    json with_base = common;
    with_base["bufferView"] = base;
    gltf.mesh({{"attributes", {{"POSITION", gltf.accessor(with_base)}}}});
    gltf.mesh({{"attributes", {{"POSITION", gltf.accessor(common)}}}});
    gltf.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 1}}};
    gltf.json["scenes"][0]["nodes"] = {0, 1};
    const Scene scene = gltf.load();
    EXPECT_EQ(scene.meshes().at(0).positions, (std::vector<Vec3>{{0, 0, 0}, {5, 6, 7}, {0, 1, 0}}));
    EXPECT_EQ(scene.meshes().at(1).positions, (std::vector<Vec3>{{0, 0, 0}, {5, 6, 7}, {0, 0, 0}}))
        << "without a view the others are zero";
}

TEST(Gltf, InterleavedAttributesAreTakenApart) {
    TestGltf gltf;
    constexpr int kStride = 24;
    const int view = gltf.view(
        std::vector<float>{0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1}, kStride);
    const auto part = [&](int offset) {
        return gltf.accessor({{"bufferView", view},
                              {"byteOffset", offset},
                              {"componentType", 5126},
                              {"count", 3},
                              {"type", "VEC3"}});
    };
    gltf.mesh({{"attributes", {{"POSITION", part(0)}, {"NORMAL", part(12)}}}});
    const Scene scene = gltf.load();
    EXPECT_EQ(scene.meshes().at(0).positions[1], Vec3(1, 0, 0));
    EXPECT_EQ(scene.meshes().at(0).normals, std::vector<Vec3>(3, Vec3(0, 0, 1)));
}

TEST(Gltf, NormalisedIntegersAreDivided) {
    TestGltf gltf;
    gltf.add_triangle();
    const int view = gltf.view(std::vector<std::uint8_t>{255, 0, 51, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 4);
    json& attributes = gltf.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["COLOR_0"] = gltf.accessor({{"bufferView", view},
                                           {"componentType", 5121},
                                           {"normalized", true},
                                           {"count", 3},
                                           {"type", "VEC3"}});
    const int normals =
        gltf.view(std::vector<std::int8_t>{0, 0, -128, 0, 0, 0, 127, 0, 0, 127, 0, 0}, 4);
    attributes["NORMAL"] = gltf.accessor({{"bufferView", normals},
                                          {"componentType", 5120},
                                          {"normalized", true},
                                          {"count", 3},
                                          {"type", "VEC3"}});
    gltf.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    const Scene scene = gltf.load();
    EXPECT_EQ(scene.meshes().at(0).colors.at(0), Vec4(1.0f, 0.0f, 0.2f, 1.0f));
    EXPECT_EQ(scene.meshes().at(0).normals.at(0), Vec3(0, 0, -1)) << "-128 / 127 is clamped to -1";
}

TEST(Gltf, StripsAndFansBecomeTriangles) {
    TestGltf gltf;
    const int positions = gltf.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
    gltf.mesh({{"attributes", {{"POSITION", positions}}}, {"mode", 5}});
    gltf.mesh({{"attributes", {{"POSITION", positions}}}, {"mode", 6}});
    gltf.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 1}}};
    gltf.json["scenes"][0]["nodes"] = {0, 1};
    const Scene scene = gltf.load();
    EXPECT_EQ(scene.meshes().at(0).triangles,
              (std::vector<UVec3>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
    EXPECT_EQ(scene.meshes().at(1).triangles,
              (std::vector<UVec3>{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
    const std::vector<Vec3>& p = scene.meshes()[0].positions;
    for (const UVec3& t : scene.meshes()[0].triangles) {
        EXPECT_GT(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]).z, 0.0f) << "all face one way";
    }
}

TEST(Gltf, PointsAndLinesAreLeftOutWithAWarning) {
    for (const int mode : {0, 1, 2, 3}) {
        TestGltf gltf;
        gltf.add_triangle();
        gltf.json["meshes"][0]["primitives"][0]["mode"] = mode;
        const Scene scene = gltf.load();
        EXPECT_EQ(scene.triangle_count(), 0u);
        EXPECT_TRUE(has_warning(scene, "points and lines"));
        EXPECT_TRUE(has_warning(scene, "no triangles"));
    }
}

TEST(Gltf, HierarchiesOfMatricesAndTrsAreComposed) {
    TestGltf gltf;
    gltf.add_triangle();
    // The parent scales by 2 and moves by (10, 0, 0); the child turns X to Y, then moves by 1 in X.
    const double half = std::sqrt(0.5);
    gltf.json["nodes"] = {
        {{"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 10, 0, 0, 1}}, {"children", {1}}},
        {{"mesh", 0}, {"translation", {1, 0, 0}}, {"rotation", {0, 0, half, half}}}};
    const Scene scene = gltf.load();
    expect_near(corner_in_file(scene, 0, 0, 0), {12, 0, 0}, 10 * kRounding);
    expect_near(corner_in_file(scene, 0, 0, 1), {12, 2, 0}, 10 * kRounding);
    expect_near(corner_in_file(scene, 0, 0, 2), {10, 0, 0}, 10 * kRounding);
}

TEST(Gltf, NodesShareMeshesAndAreObjects) {
    TestGltf gltf;
    gltf.add_triangle();
    gltf.json["nodes"] = {{{"mesh", 0}, {"name", "a"}},
                          {{"mesh", 0}, {"name", "b"}, {"scale", {-1, 1, 1}}}};
    gltf.json["scenes"][0]["nodes"] = {0, 1};
    const Scene scene = gltf.load();
    EXPECT_EQ(scene.meshes().size(), 1u);
    ASSERT_EQ(scene.instances().size(), 2u);
    EXPECT_EQ(scene.instances()[1].name, "b");
    EXPECT_EQ(scene.instances()[1].object, 1u);
    EXPECT_LT(glm::determinant(glm::mat3(scene.instances()[1].world_from_local)), 0.0f);
}

TEST(Gltf, GpuInstancingPlacesEachInstance) {
    TestGltf gltf;
    gltf.add_triangle();
    const int translations = gltf.vec3({0, 0, 0, 0, 0, 5, 0, 0, 9});
    const int scales = gltf.vec3({1, 1, 1, 2, 2, 2, 3, 3, 3});
    gltf.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    gltf.json["nodes"] = {
        {{"mesh", 0},
         {"translation", {1, 0, 0}},
         {"extensions",
          {{"EXT_mesh_gpu_instancing",
            {{"attributes", {{"TRANSLATION", translations}, {"SCALE", scales}}}}}}}}};
    const Scene scene = gltf.load();
    ASSERT_EQ(scene.instances().size(), 3u);
    EXPECT_EQ(scene.meshes().size(), 1u);
    EXPECT_EQ(scene.triangle_count(), 3u);
    EXPECT_EQ(scene.instances()[2].object, 2u);
    expect_near(corner_in_file(scene, 2, 0, 1), {4, 0, 9}, 10 * kRounding);
}

TEST(Gltf, CamerasLookAlongMinusZOfTheirNodes) {
    TestGltf gltf;
    gltf.json.erase("nodes");
    gltf.add("cameras",
             {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}});
    gltf.add("cameras", {{"type", "orthographic"},
                         {"orthographic", {{"xmag", 4}, {"ymag", 3}, {"znear", 0}, {"zfar", 50}}}});
    gltf.json["nodes"] = {{{"camera", 0}, {"translation", {1, 2, 3}}, {"scale", {2, 2, 2}}},
                          {{"camera", 1}}};
    gltf.json["scenes"][0]["nodes"] = {0, 1};
    const Scene scene = gltf.load();
    ASSERT_EQ(scene.cameras().size(), 2u);
    const Camera& perspective = scene.cameras()[0];
    EXPECT_EQ(perspective.eye_ws(), Vec3(1, 2, 3));
    EXPECT_EQ(Vec3(perspective.view_from_world * Vec4(1, 2, 1, 1)), Vec3(0, 0, -2))
        << "the node's scale is no part of the view";
    EXPECT_FLOAT_EQ(perspective.fov_y_rad, 0.5f);
    EXPECT_FLOAT_EQ(perspective.near_m, 0.25f);
    EXPECT_FLOAT_EQ(scene.cameras()[1].ortho_height_m, 6.0f);
    EXPECT_FLOAT_EQ(scene.cameras()[1].ortho_depth_m, 50.0f);
}

TEST(Gltf, PunctualLightsAreConverted) {
    TestGltf gltf;
    gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "directional"}, {"intensity", 3}, {"color", {1, 0.5, 0}}},
        {{"type", "point"}, {"intensity", 2}, {"range", 7}},
        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}},
        {{"type", "nebula"}}};
    const auto node = [](int light) {
        return json{{"translation", {0, 4, 0}},
                    {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}},  // -Z becomes -Y
                    {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}};
    };
    gltf.json["nodes"] = {node(0), node(1), node(2), node(3)};
    gltf.json["scenes"][0]["nodes"] = {0, 1, 2, 3};
    const Scene scene = gltf.load();
    ASSERT_EQ(scene.lights().size(), 3u);
    const auto& sun = std::get<DirectionalLight>(scene.lights()[0]);
    expect_near(DVec3(sun.to_light_ws), {0, 1, 0}, kRounding);
    EXPECT_EQ(sun.irradiance, Vec3(3.0f, 1.5f, 0.0f));
    EXPECT_EQ(sun.angular_diameter_rad, kSunAngularDiameterRad);
    const auto& point = std::get<PointLight>(scene.lights()[1]);
    EXPECT_EQ(point.position_ws, Vec3(0, 4, 0));
    EXPECT_EQ(point.intensity, Vec3(2.0f));
    const auto& spot = std::get<SpotLight>(scene.lights()[2]);
    expect_near(DVec3(spot.direction_ws), {0, -1, 0}, kRounding);
    EXPECT_FLOAT_EQ(spot.inner_angle_rad, 0.1f);
    EXPECT_FLOAT_EQ(spot.outer_angle_rad, 0.2f);
    EXPECT_TRUE(has_warning(scene, "range is ignored"));
    EXPECT_TRUE(has_warning(scene, "nebula"));
}

TEST(Gltf, CoordinatesFarFromTheOriginAreRecentred) {
    TestGltf gltf;
    gltf.add_triangle();
    gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    gltf.json["nodes"] = {
        {{"children", {1, 2}}, {"translation", {84900.25, 0, -447500.125}}},
        {{"mesh", 0}, {"translation", {0.001, 0, 0}}},
        {{"translation", {0, 2, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
    const Scene scene = gltf.load();
    EXPECT_EQ(scene.origin_offset_m(), DVec3(84901, 0, -447500));
    expect_near(corner_in_file(scene, 0, 0, 1), {84901.251, 0, -447500.125}, kRounding);
    const auto& light = std::get<PointLight>(scene.lights().at(0));
    EXPECT_EQ(light.position_ws, Vec3(-0.75f, 2.0f, -0.125f)) << "lights move along";
    EXPECT_LT(glm::length(scene.cameras().at(0).eye_ws()), 10.0f) << "and so do cameras";
}

TEST(Gltf, VerticesFarFromTheOriginLoseNothing) {
    // 447500.125 is a float; the triangle is 1/8 m high, which is four steps of floats there.
    TestGltf gltf;
    gltf.mesh(
        {{"attributes",
          {{"POSITION", gltf.vec3({84900, 0, 447500, 84901, 0, 447500, 84900, 0, 447500.125f})}}}});
    const Scene scene = gltf.load();
    expect_near(corner_in_file(scene, 0, 0, 2), {84900, 0, 447500.125}, kRounding);
    for (const Vec3& p : scene.meshes().at(0).positions)
        EXPECT_LT(glm::length(p), 2.0f);
}

TEST(Gltf, BinaryContainersAreRead) {
    TestGltf gltf;
    gltf.add_triangle();
    const TestFolder folder;
    gltf.write(folder);
    std::ifstream bin_stream(folder.path() / "scene.bin", std::ios::binary);
    const std::string bin(std::istreambuf_iterator<char>(bin_stream), {});
    json document = gltf.json;
    document["buffers"][0].erase("uri");
    std::string text = document.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto u32 = [](std::size_t value) {
        const auto word = static_cast<std::uint32_t>(value);
        return std::string(reinterpret_cast<const char*>(&word), 4);
    };
    const std::string body =
        u32(text.size()) + "JSON" + text + u32(bin.size()) + std::string("BIN\0", 4) + bin;
    const std::string glb = "glTF" + u32(2) + u32(12 + body.size()) + body;
    EXPECT_EQ(load_scene(folder.write("a.glb", glb)).triangle_count(), 1u);
    // Every cut is refused, none crashes.
    for (std::size_t length = 0; length < glb.size(); ++length) {
        const std::string path = folder.write("cut.glb", glb.substr(0, length));
        EXPECT_THROW(load_scene(path), Error) << length;
    }
}

TEST(Gltf, FaultsAreNamed) {
    const auto error_after = [](const std::function<void(json&)>& change) {
        TestGltf gltf;
        gltf.add_triangle();
        change(gltf.json);
        const std::string error = gltf.error();
        EXPECT_NE(error.find("scene.gltf"), std::string::npos) << error;
        EXPECT_EQ(error.find('\n'), std::string::npos) << error;
        return error;
    };
    const auto expect_error = [&](const std::function<void(json&)>& change,
                                  const std::string& part) {
        const std::string error = error_after(change);
        EXPECT_NE(error.find(part), std::string::npos) << error;
    };
    expect_error([](json& j) { j["nodes"][0]["mesh"] = 7; },
                 "nodes[0].mesh: is 7, but there are 1");
    expect_error([](json& j) { j["nodes"][0]["mesh"] = -1; }, "nodes[0].mesh");
    expect_error([](json& j) { j["nodes"][0]["mesh"] = 4294967296; }, "nodes[0].mesh");
    expect_error([](json& j) { j["nodes"][0]["mesh"] = "0"; }, "nodes[0].mesh");
    expect_error([](json& j) { j["nodes"] = 3; }, "nodes: must be an array");
    expect_error([](json& j) { j["nodes"][0]["scale"] = {1, 2}; }, "array of 3 numbers");
    expect_error([](json& j) { j["nodes"] = {{{"children", {0}}}}; }, "own descendants");
    expect_error(
        [](json& j) {
            j["nodes"] = {{{"children", {1}}}, {{"children", {0}}}};
        },
        "own descendants");
    expect_error(
        [](json& j) {
            j["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
        },
        "nodes[2]: is a child of both nodes[0] and nodes[1]");
    expect_error([](json& j) { j["extensionsRequired"] = {"FOO_bar"}; }, "FOO_bar");
    expect_error([](json& j) { j["asset"]["version"] = "1.0"; }, "1.0");
    expect_error([](json& j) { j["asset"]["minVersion"] = "2.1"; }, "2.1");
    expect_error([](json& j) { j.erase("asset"); }, "asset: is missing");
    expect_error([](json& j) { j["accessors"][0]["count"] = 4; }, "accessors[0]: needs 48 bytes");
    expect_error([](json& j) { j["accessors"][0]["byteOffset"] = 8; }, "accessors[0]: needs");
    expect_error([](json& j) { j["accessors"][0]["type"] = "VEC2"; }, "accessors[0]: has 2");
    expect_error([](json& j) { j["accessors"][0]["componentType"] = 5130; }, "accessors[0]");
    expect_error([](json& j) { j["bufferViews"][0]["byteLength"] = 1000; }, "bufferViews[0]");
    expect_error([](json& j) { j["bufferViews"][0]["byteOffset"] = 1ull << 52; }, "bufferViews[0]");
    expect_error([](json& j) { j["bufferViews"][0]["byteStride"] = 8; }, "stride of 8");
}

TEST(Gltf, HarmlessFaultsAreTolerated) {
    TestGltf gltf;
    gltf.add_triangle();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const int normals = gltf.vec3({0, 0, 4, nan, 0, 0, 0, 0, 0});
    gltf.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals;
    gltf.json["meshes"][0]["primitives"][0]["indices"] = gltf.indices({0, 1, 2, 0, 1, 9, 0, 1});
    gltf.json["asset"]["version"] = "2.1";
    gltf.json["nodes"][0]["extras"]["anything"] = {1, nullptr, "x"};
    const Scene scene = gltf.load();
    EXPECT_EQ(scene.triangle_count(), 1u);
    EXPECT_EQ(scene.meshes().at(0).normals, std::vector<Vec3>(3, Vec3(0, 0, 1)));
    EXPECT_TRUE(has_warning(scene, "vertices that are not there"));
    EXPECT_TRUE(has_warning(scene, "normals without a direction"));
    EXPECT_TRUE(has_warning(scene, "no whole triangle"));
}

TEST(Gltf, TrianglesWithoutAPlaceAreLeftOut) {
    TestGltf gltf;
    const float infinity = std::numeric_limits<float>::infinity();
    gltf.mesh({{"attributes",
                {{"POSITION",
                  gltf.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, infinity, 0, 0, 0})}}}});
    const Scene scene = gltf.load();
    EXPECT_EQ(scene.triangle_count(), 1u);
    EXPECT_TRUE(has_warning(scene, "without a finite place"));
}

}  // namespace
}  // namespace gnomon::scene
