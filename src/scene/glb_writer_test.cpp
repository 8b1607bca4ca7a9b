#include <gnomon/error.h>
#include <gnomon/scene.h>

#include "base/file.h"
#include "image/decode.h"
#include "scene/shapes.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace gnomon {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A binary glTF file taken apart; each check of the container is a test expectation.
struct Glb {
    Json json;
    std::vector<std::uint8_t> data;

    template <typename T>
    std::vector<T> values(const Json& accessor) const {
        const Json& view = json.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
        std::vector<T> result(view.at("byteLength").get<std::size_t>() / sizeof(T));
        std::memcpy(result.data(), data.data() + view.at("byteOffset").get<std::size_t>(),
                    result.size() * sizeof(T));
        return result;
    }
};

std::uint32_t word(const std::vector<std::uint8_t>& bytes, std::size_t offset) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

class GlbWriter : public testing::Test {
protected:
    GlbWriter() { fs::create_directories(folder_); }
    ~GlbWriter() override { fs::remove_all(folder_); }

    fs::path path() const { return folder_ / "scene.glb"; }

    Glb written(const Scene& scene) const {
        write_glb(path(), scene);
        const std::vector<std::uint8_t> bytes = read_file(path(), std::uint64_t{1} << 30);
        Glb glb;
        EXPECT_EQ(std::memcmp(bytes.data(), "glTF", 4), 0);
        EXPECT_EQ(word(bytes, 4), 2u);
        EXPECT_EQ(word(bytes, 8), bytes.size());
        const std::uint32_t json_size = word(bytes, 12);
        EXPECT_EQ(json_size % 4, 0u);
        EXPECT_EQ(std::memcmp(bytes.data() + 16, "JSON", 4), 0);
        const auto json_begin = bytes.begin() + 20;
        glb.json = Json::parse(json_begin, json_begin + json_size);
        const std::size_t data_header = 20u + json_size;
        if (data_header == bytes.size()) return glb;
        const std::uint32_t data_size = word(bytes, data_header);
        EXPECT_EQ(std::memcmp(bytes.data() + data_header + 4, "BIN\0", 4), 0);
        EXPECT_EQ(data_header + 8 + data_size, bytes.size());
        glb.data.assign(bytes.begin() + static_cast<std::ptrdiff_t>(data_header) + 8, bytes.end());
        const auto declared = glb.json.at("buffers").at(0).at("byteLength").get<std::size_t>();
        EXPECT_LE(declared, data_size);
        EXPECT_LT(data_size - declared, 4u);
        return glb;
    }

private:
    // Tests may run at the same time.
    fs::path folder_ = fs::temp_directory_path() / ("gnomon_glb_" + std::to_string(::getpid()));
};

TEST_F(GlbWriter, AccessorsFitTheirViewsAndTellTheirBounds) {
    const Glb glb = written(make_builtin_scene("courtyard"));
    for (const Json& accessor : glb.json.at("accessors")) {
        const Json& view =
            glb.json.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
        const std::size_t components = accessor.at("type") == "SCALAR" ? 1
                                       : accessor.at("type") == "VEC2" ? 2
                                       : accessor.at("type") == "VEC3" ? 3
                                                                       : 4;
        EXPECT_EQ(accessor.at("count").get<std::size_t>() * components * 4, view.at("byteLength"));
        EXPECT_EQ(view.at("byteOffset").get<std::size_t>() % 4, 0u);
        EXPECT_LE(
            view.at("byteOffset").get<std::size_t>() + view.at("byteLength").get<std::size_t>(),
            glb.data.size());
    }
    for (const Json& mesh : glb.json.at("meshes")) {
        for (const Json& primitive : mesh.at("primitives")) {
            const Json& accessor =
                glb.json.at("accessors")
                    .at(primitive.at("attributes").at("POSITION").get<std::size_t>());
            Box3 bounds;
            for (const Vec3 p : glb.values<Vec3>(accessor))
                bounds.include(p);
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_EQ(accessor.at("min").at(static_cast<std::size_t>(axis)), bounds.min[axis]);
                EXPECT_EQ(accessor.at("max").at(static_cast<std::size_t>(axis)), bounds.max[axis]);
            }
        }
    }
}

TEST_F(GlbWriter, InstancesShareTheirMesh) {
    const Scene scene = make_builtin_scene("torches");
    const Glb glb = written(scene);
    EXPECT_EQ(glb.json.at("meshes").size(), scene.meshes().size());
    std::size_t mesh_nodes = 0;
    for (const Json& node : glb.json.at("nodes"))
        mesh_nodes += node.contains("mesh");
    EXPECT_EQ(mesh_nodes, scene.instances().size());
    EXPECT_EQ(glb.json.at("extensions").at("KHR_lights_punctual").at("lights").size(), 16u);
}

TEST_F(GlbWriter, SameSceneSameBytes) {
    const auto bytes = [&] {
        write_glb(path(), make_builtin_scene("gas-station"));
        return read_file(path(), std::uint64_t{1} << 30);
    };
    EXPECT_EQ(bytes(), bytes());
}

TEST_F(GlbWriter, MaterialsKeepMaskSidesAndTextures) {
    const Scene scene = make_builtin_scene("courtyard");
    const Glb glb = written(scene);
    ASSERT_EQ(glb.json.at("materials").size(), scene.materials().size());
    for (std::size_t i = 0; i < scene.materials().size(); ++i) {
        const Material& material = scene.materials()[i];
        const Json& json = glb.json.at("materials").at(i);
        EXPECT_EQ(json.value("alphaMode", "OPAQUE"), material.masked() ? "MASK" : "OPAQUE");
        EXPECT_EQ(json.value("doubleSided", false), material.double_sided);
    }
    ASSERT_EQ(glb.json.at("images").size(), scene.textures().size());
    for (std::size_t i = 0; i < scene.textures().size(); ++i) {
        const std::vector<std::uint8_t> png = glb.values<std::uint8_t>(glb.json.at("images").at(i));
        EXPECT_EQ(image::decode(png, "embedded").rgba, scene.textures()[i].rgba);
    }
}

TEST_F(GlbWriter, EmptySceneIsValid) {
    const Glb glb = written(Scene());
    EXPECT_EQ(glb.json.at("asset").at("version"), "2.0");
    // glTF forbids empty arrays.
    for (const char* kind : {"nodes", "meshes", "buffers", "materials", "extensionsUsed"})
        EXPECT_FALSE(glb.json.contains(kind)) << kind;
}

TEST_F(GlbWriter, UnwritablePlaceIsAMachineError) {
    try {
        write_glb(path() / "no" / "such" / "folder.glb", Scene());
        FAIL() << "wrote into a folder that does not exist";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::machine);
    }
}

TEST_F(GlbWriter, NamesThatAreNoUtf8AreMended) {
    SceneData data;
    data.materials.push_back({.name = "caf\xe9"});
    const Glb glb = written(Scene(data));
    EXPECT_EQ(glb.json.at("materials").at(0).at("name"), "caf\xef\xbf\xbd");
}

/// A scene that has one of everything.
Scene sampler() {
    SceneData data;
    data.textures.push_back({.name = "dots",
                             .size = {2, 1},
                             .rgba = {255, 0, 0, 255, 0, 128, 255, 7},
                             .wrap_u = TextureWrap::mirror,
                             .wrap_v = TextureWrap::clamp});
    // uv turned by 30°, stretched and moved.
    const float c = std::cos(radians(30.0f));
    const float s = std::sin(radians(30.0f));
    data.materials.push_back({.name = "dotted",
                              .base_color = {0.5f, 0.25f, 0.125f, 0.75f},
                              .base_color_texture = 0,
                              .uv_scale_rotation = {2.0f * c, -2.0f * s, -3.0f * s, -3.0f * c},
                              .uv_offset = {0.25f, 0.5f},
                              .alpha_cutoff = 0.3f,
                              .double_sided = false});
    data.materials.push_back({.name = "plain"});
    Mesh sheet = scene::ground(Vec2(-1.0f), Vec2(1.0f));
    sheet.colors = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {1, 1, 1, 0.5f}};
    Mesh cube = scene::box(Vec3(-1.0f), Vec3(1.0f));
    cube.material = 1;
    for (const Vec3 p : cube.positions)
        cube.lightmap_texcoords.emplace_back(0.5f + 0.25f * p.x, 0.5f + 0.125f * p.z);
    data.meshes = {sheet, cube, Mesh{}};
    const Mat4 place = scene::translation({1, 2, 3}) * scene::rotation_y(0.3f);
    data.instances = {{.mesh = 0, .object = 0, .world_from_local = place, .name = "pair"},
                      {.mesh = 1, .object = 0, .world_from_local = place, .name = "pair"},
                      {.mesh = 1,
                       .object = 1,
                       .world_from_local = scene::scaling({-1, 1, 2}),
                       .name = "mirrored"},
                      {.mesh = 2, .object = 2, .name = "empty"}};
    data.cameras.push_back(look_at({1, 2, 8}, {0, 0, 0}, radians(33.0f)));
    data.cameras.push_back(look_at({4, 2, 8}, {0, 1, 0}));
    data.cameras.back().ortho_height_m = 3.0f;
    data.cameras.back().ortho_depth_m = 50.0f;
    data.lights = {
        sun(radians(30.0f), radians(100.0f)),
        PointLight{.position_ws = {1, 2, 3}, .intensity = {4, 2, 1}, .name = "lamp"},
        SpotLight{.position_ws = {0, 3, 0},
                  .direction_ws = normalize({1, -2, 0.5f}),
                  .intensity = {0.5f, 0.25f, 0.125f},
                  .inner_angle_rad = 0.2f,
                  .outer_angle_rad = 0.6f,
                  .name = "spot"},
        RectLight{.center_ws = {5, 5, 5}, .half_u_ws = {2, 0, 0}, .half_v_ws = {0, 0, 1.5f}},
    };
    return Scene(std::move(data));
}

void expect_near(const Mat4& a, const Mat4& b, float tolerance) {
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row)
            EXPECT_NEAR(a[column][row], b[column][row], tolerance) << column << ", " << row;
    }
}

void expect_same_meshes(const Scene& a, const Scene& b) {
    EXPECT_EQ(a.triangle_count(), b.triangle_count());
    ASSERT_EQ(a.instances().size(), b.instances().size());
    for (std::size_t i = 0; i < a.instances().size(); ++i) {
        const Instance& left = a.instances()[i];
        const Instance& right = b.instances()[i];
        EXPECT_EQ(left.name, right.name);
        EXPECT_EQ(left.object, right.object) << left.name;
        EXPECT_EQ(left.world_from_local, right.world_from_local) << left.name;
        const Mesh& left_mesh = a.meshes()[left.mesh];
        const Mesh& right_mesh = b.meshes()[right.mesh];
        EXPECT_EQ(left_mesh.positions, right_mesh.positions) << left.name;
        // Loaders keep only those that a texture uses.
        if (a.materials()[left_mesh.material].base_color_texture >= 0) {
            EXPECT_EQ(left_mesh.texcoords, right_mesh.texcoords) << left.name;
        }
        EXPECT_EQ(left_mesh.lightmap_texcoords, right_mesh.lightmap_texcoords) << left.name;
        EXPECT_EQ(left_mesh.colors, right_mesh.colors) << left.name;
        EXPECT_EQ(left_mesh.triangles, right_mesh.triangles) << left.name;
        EXPECT_EQ(left_mesh.normals.size(), right_mesh.normals.size()) << left.name;
    }
}

void expect_same_materials(const Scene& a, const Scene& b) {
    constexpr float kTolerance = 1e-6f;  // angles go through atan2 and back
    for (std::size_t i = 0; i < a.instances().size(); ++i) {
        const Material& left = a.materials()[a.meshes()[a.instances()[i].mesh].material];
        const Material& right = b.materials()[b.meshes()[b.instances()[i].mesh].material];
        EXPECT_EQ(left.name, right.name);
        EXPECT_EQ(left.base_color, right.base_color);
        EXPECT_EQ(left.alpha_cutoff, right.alpha_cutoff);
        EXPECT_EQ(left.double_sided, right.double_sided);
        EXPECT_NEAR(left.shininess, right.shininess, 1e-4f * left.shininess);
        EXPECT_EQ(left.uv_offset, right.uv_offset);
        for (int column = 0; column < 2; ++column) {
            for (int row = 0; row < 2; ++row) {
                EXPECT_NEAR(left.uv_scale_rotation[column][row],
                            right.uv_scale_rotation[column][row], kTolerance);
            }
        }
        ASSERT_EQ(left.base_color_texture < 0, right.base_color_texture < 0);
        if (left.base_color_texture < 0) continue;
        const Texture& t = a.textures()[static_cast<std::size_t>(left.base_color_texture)];
        const Texture& u = b.textures()[static_cast<std::size_t>(right.base_color_texture)];
        EXPECT_EQ(t.size, u.size);
        EXPECT_EQ(t.rgba, u.rgba);
        EXPECT_EQ(t.wrap_u, u.wrap_u);
        EXPECT_EQ(t.wrap_v, u.wrap_v);
    }
}

TEST_F(GlbWriter, SceneComesBack) {
    for (const Scene& scene : {sampler(), make_builtin_scene("courtyard"),
                               make_builtin_scene("field-small"), make_builtin_scene("torches")}) {
        SCOPED_TRACE(scene.source());
        write_glb(path(), scene);
        const Scene back = load_scene(path().string());
        EXPECT_TRUE(back.warnings().empty());
        SceneData expected = scene.data();
        std::erase_if(expected.instances, [](const Instance& i) { return i.name == "empty"; });
        expect_same_meshes(Scene(expected), back);
        expect_same_materials(Scene(expected), back);
        ASSERT_EQ(back.cameras().size(), scene.cameras().size());
        for (std::size_t i = 0; i < scene.cameras().size(); ++i) {
            const Camera& left = scene.cameras()[i];
            const Camera& right = back.cameras()[i];
            // A rigid matrix is inverted twice; its offsets are some metres to hundreds.
            expect_near(left.view_from_world, right.view_from_world, 1e-4f);
            EXPECT_EQ(left.near_m, right.near_m);
            EXPECT_EQ(left.ortho_height_m, right.ortho_height_m);
            EXPECT_EQ(left.ortho_depth_m, right.ortho_depth_m);
            if (left.ortho_height_m == 0.0f) {
                EXPECT_EQ(left.fov_y_rad, right.fov_y_rad);
            }
        }
    }
}

TEST_F(GlbWriter, LightsComeBack) {
    const Scene scene = sampler();
    write_glb(path(), scene);
    const Scene back = load_scene(path().string());
    ASSERT_EQ(back.lights().size(), 4u);
    constexpr float kTolerance = 1e-6f;  // directions become matrices, strengths are factored
    const auto near = [](Vec3 a, Vec3 b) { return glm::length(a - b) < 4.0f * kTolerance; };

    const auto& sun_before = std::get<DirectionalLight>(scene.lights()[0]);
    const auto& sun_after = std::get<DirectionalLight>(back.lights()[0]);
    EXPECT_TRUE(near(sun_before.to_light_ws, sun_after.to_light_ws));
    EXPECT_TRUE(near(sun_before.irradiance, sun_after.irradiance));
    EXPECT_EQ(sun_before.angular_diameter_rad, sun_after.angular_diameter_rad);
    EXPECT_EQ(sun_after.name, "sun");

    const auto& lamp = std::get<PointLight>(back.lights()[1]);
    EXPECT_EQ(lamp.position_ws, Vec3(1, 2, 3));
    EXPECT_TRUE(near(lamp.intensity, {4, 2, 1}));

    const auto& spot_before = std::get<SpotLight>(scene.lights()[2]);
    const auto& spot_after = std::get<SpotLight>(back.lights()[2]);
    EXPECT_TRUE(near(spot_before.direction_ws, spot_after.direction_ws));
    EXPECT_TRUE(near(spot_before.intensity, spot_after.intensity));
    EXPECT_EQ(spot_before.inner_angle_rad, spot_after.inner_angle_rad);
    EXPECT_EQ(spot_before.outer_angle_rad, spot_after.outer_angle_rad);

    // Radiance 1 over 4 m x 3 m.
    const auto& rect = std::get<PointLight>(back.lights()[3]);
    EXPECT_EQ(rect.position_ws, Vec3(5, 5, 5));
    EXPECT_TRUE(near(rect.intensity, Vec3(12.0f)));
}

TEST_F(GlbWriter, FarSceneGoesBackToItsPlace) {
    SceneData data = sampler().data();
    data.origin_offset_m = {85'000.125, 12.5, -447'000.25};
    const Glb glb = written(Scene(data));
    const Json& root = glb.json.at("nodes").back();
    EXPECT_EQ(root.at("translation"), Json({85'000.125, 12.5, -447'000.25}));
    EXPECT_EQ(root.at("children").size(), glb.json.at("nodes").size() - 1);

    const Scene back = load_scene(path().string());
    const auto& lamp = std::get<PointLight>(back.lights().at(1));
    const DVec3 place = back.origin_offset_m() + DVec3(lamp.position_ws);
    // Near the origin again, float resolves much less than a millimetre.
    EXPECT_NEAR(glm::length(place - data.origin_offset_m - DVec3(1, 2, 3)), 0.0, 1e-4);
}

}  // namespace
}  // namespace gnomon
