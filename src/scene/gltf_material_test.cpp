#include "scene/load_test_scene.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gnomon::scene {
namespace {

using nlohmann::json;

// A triangle with texture coordinates (0, 0), (1, 0), (0, 1) as set 0, the same times 10 as set 1,
// and a material with these members.
TestGltf textured_triangle(const json& material) {
    TestGltf gltf;
    gltf.add_triangle();
    json& attributes = gltf.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["TEXCOORD_0"] = gltf.floats("VEC2", 2, {0, 0, 1, 0, 0, 1});
    attributes["TEXCOORD_1"] = gltf.floats("VEC2", 2, {0, 0, 10, 0, 0, 10});
    gltf.json["meshes"][0]["primitives"][0]["material"] = 0;
    gltf.json["materials"] = {material};
    gltf.json["textures"] = {{{"source", 0}}};
    gltf.json["images"] = {{{"uri", "a%20picture.png"}}};
    return gltf;
}

json with_texture(json material, const json& info = {{"index", 0}}) {
    material["pbrMetallicRoughness"]["baseColorTexture"] = info;
    return material;
}

// Half of it is a hole.
const std::vector<std::uint8_t> kHalfTransparent = {9, 8, 7, 255, 9, 8, 7, 0};

Scene load_with_picture(TestGltf& gltf, const std::vector<std::uint8_t>& rgba) {
    const TestFolder folder;
    folder.write_png("a picture.png", rgba);
    return load_scene(gltf.write(folder));
}

TEST(GltfMaterial, AlphaModesBecomeCutoffs) {
    const auto cutoff = [](const json& material) {
        TestGltf gltf = textured_triangle(with_texture(material));
        return load_with_picture(gltf, kHalfTransparent).materials().at(0).alpha_cutoff;
    };
    EXPECT_EQ(cutoff({{"alphaMode", "MASK"}}), 0.5f);
    EXPECT_EQ(cutoff({{"alphaMode", "MASK"}, {"alphaCutoff", 0.7}}), 0.7f);
    EXPECT_EQ(cutoff({{"alphaMode", "MASK"}, {"alphaCutoff", 0}}), 0.0f);
    EXPECT_EQ(cutoff({{"alphaMode", "BLEND"}}), 0.5f);
    EXPECT_EQ(cutoff({{"alphaMode", "OPAQUE"}}), 0.0f);
    EXPECT_EQ(cutoff(json::object()), 0.0f);
}

TEST(GltfMaterial, MasksThatCutNothingAreSolid) {
    TestGltf gltf = textured_triangle(with_texture({{"alphaMode", "MASK"}}));
    EXPECT_FALSE(load_with_picture(gltf, {1, 2, 3, 255}).materials().at(0).masked());
    // A vertex colour's alpha counts as well.
    gltf.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
        gltf.floats("VEC4", 4, {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0});
    EXPECT_TRUE(load_with_picture(gltf, {1, 2, 3, 255}).materials().at(0).masked());
}

TEST(GltfMaterial, TexturesHaveTheirNameWrapAndPixels) {
    TestGltf gltf = textured_triangle(with_texture(json::object()));
    gltf.json["textures"][0]["sampler"] = 0;
    gltf.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
    const Scene scene = load_with_picture(gltf, kHalfTransparent);
    const Texture& texture = scene.textures().at(0);
    EXPECT_EQ(texture.name, "a picture.png");
    EXPECT_EQ(texture.wrap_u, TextureWrap::clamp);
    EXPECT_EQ(texture.wrap_v, TextureWrap::mirror);
    EXPECT_EQ(texture.rgba, kHalfTransparent);
    EXPECT_EQ(scene.materials().at(0).base_color_texture, 0);
}

TEST(GltfMaterial, TextureCoordinatesAreThoseThatTheTextureAsksFor) {
    TestGltf gltf =
        textured_triangle(with_texture(json::object(), {{"index", 0}, {"texCoord", 1}}));
    EXPECT_EQ(load_with_picture(gltf, kHalfTransparent).meshes().at(0).texcoords[1], Vec2(10, 0));
}

TEST(GltfMaterial, SetOneIsTheLightMapsWithAndWithoutATexture) {
    const std::vector<Vec2> set_one = {{0, 0}, {10, 0}, {0, 10}};
    for (const json& material : {json::object(), with_texture(json::object())}) {
        TestGltf gltf = textured_triangle(material);
        EXPECT_EQ(load_with_picture(gltf, kHalfTransparent).meshes().at(0).lightmap_texcoords,
                  set_one);
    }
    TestGltf damaged = textured_triangle(json::object());
    damaged.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] =
        damaged.floats("VEC2", 2, {NAN, 0, 10, 0, 0, 10});
    const Scene scene = load_with_picture(damaged, kHalfTransparent);
    EXPECT_EQ(scene.meshes().at(0).lightmap_texcoords[0], Vec2(0.0f));
    EXPECT_TRUE(has_warning(scene, "not finite"));
}

TEST(GltfMaterial, TextureTransformScalesTurnsAndMoves) {
    const json transform{
        {"offset", {0.25, 0.5}}, {"scale", {2, 3}}, {"rotation", kPi / 2}, {"texCoord", 1}};
    TestGltf gltf = textured_triangle(with_texture(
        json::object(), {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}));
    gltf.json["extensionsRequired"] = {"KHR_texture_transform", "KHR_materials_unlit"};
    const Scene scene = load_with_picture(gltf, kHalfTransparent);
    EXPECT_EQ(scene.meshes().at(0).texcoords[1], Vec2(10, 0)) << "texCoord overrides";
    const Material& material = scene.materials().at(0);
    const auto uv = [&](Vec2 texcoord) {
        const Vec2 p = material.uv_scale_rotation * texcoord + material.uv_offset;
        return DVec3(p.x, p.y, 0.0);
    };
    // A quarter turn counter-clockwise with V pointing down: U (right) goes to -V (up).
    expect_near(uv({0, 0}), {0.25, 0.5, 0}, kRounding);
    expect_near(uv({1, 0}), {0.25, 0.5 - 2.0, 0}, kRounding);
    expect_near(uv({0, 1}), {0.25 + 3.0, 0.5, 0}, kRounding);
}

TEST(GltfMaterial, TexturesThatCannotBeReadAreOneWarning) {
    TestGltf gltf = textured_triangle(with_texture({{"alphaMode", "MASK"}}));
    const Scene missing = gltf.load();
    EXPECT_EQ(missing.materials().at(0).base_color_texture, -1);
    ASSERT_EQ(missing.warnings().size(), 1u);
    EXPECT_NE(missing.warnings()[0].find("a picture.png"), std::string::npos);

    const TestFolder folder;
    folder.write("a picture.png", "no picture");
    const Scene damaged = load_scene(gltf.write(folder));
    EXPECT_EQ(damaged.materials().at(0).base_color_texture, -1);
    EXPECT_EQ(damaged.warnings().size(), 1u);
}

TEST(GltfMaterial, MissingTextureCoordinatesBecomeZeroWithAWarning) {
    TestGltf gltf =
        textured_triangle(with_texture(json::object(), {{"index", 0}, {"texCoord", 5}}));
    const Scene scene = load_with_picture(gltf, kHalfTransparent);
    EXPECT_EQ(scene.meshes().at(0).texcoords, std::vector<Vec2>(3, Vec2(0.0f)));
    EXPECT_TRUE(has_warning(scene, "TEXCOORD_5"));
}

TEST(GltfMaterial, RoughSurfacesHaveWideFaintHighlights) {
    const auto material = [](double roughness) {
        TestGltf gltf = textured_triangle(
            {{"pbrMetallicRoughness", {{"roughnessFactor", roughness}, {"metallicFactor", 0}}}});
        return gltf.load().materials().at(0);
    };
    EXPECT_LT(material(0.9).shininess, material(0.3).shininess);
    EXPECT_LT(material(0.9).specular, material(0.3).specular);
    EXPECT_EQ(material(1.0).specular, 0.0f);
}

}  // namespace
}  // namespace gnomon::scene
