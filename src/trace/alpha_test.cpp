#include "trace/alpha.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>

namespace gnomon::trace {
namespace {

/// One row of texels with these alphas.
Texture row(const std::vector<int>& alphas, TextureWrap wrap) {
    Texture texture;
    texture.size = {static_cast<unsigned>(alphas.size()), 1};
    texture.wrap_u = texture.wrap_v = wrap;
    for (const int alpha : alphas) {
        texture.rgba.insert(texture.rgba.end(), {255, 255, 255, static_cast<std::uint8_t>(alpha)});
    }
    return texture;
}

// A byte is 1/255; lookups are a few float operations.
constexpr float kTolerance = 1e-6f;

TEST(TextureAlpha, IsExactAtTexelCentresAndLinearBetween) {
    const Texture texture = row({0, 255, 51, 102}, TextureWrap::repeat);
    EXPECT_NEAR(texture_alpha(texture, {0.125f, 0.5f}), 0.0f, kTolerance);
    EXPECT_NEAR(texture_alpha(texture, {0.375f, 0.5f}), 1.0f, kTolerance);
    EXPECT_NEAR(texture_alpha(texture, {0.25f, 0.3f}), 0.5f, kTolerance);
    EXPECT_NEAR(texture_alpha(texture, {0.5f, 0.9f}), 0.6f, kTolerance);
}

TEST(TextureAlpha, WrapsAsTheTextureSays) {
    // At u = 1 the lookup is half way between the last texel and what follows it.
    const auto at = [](float u, TextureWrap wrap) {
        return texture_alpha(row({0, 255, 51, 102}, wrap), {u, 0.5f});
    };
    EXPECT_NEAR(at(1.0f, TextureWrap::repeat), 0.2f, kTolerance);
    EXPECT_NEAR(at(1.0f, TextureWrap::mirror), 0.4f, kTolerance);
    EXPECT_NEAR(at(1.0f, TextureWrap::clamp), 0.4f, kTolerance);
    EXPECT_NEAR(at(-0.625f, TextureWrap::repeat), 1.0f, kTolerance);
    EXPECT_NEAR(at(-0.625f, TextureWrap::mirror), 0.2f, kTolerance);
    EXPECT_NEAR(at(1.375f, TextureWrap::mirror), 0.2f, kTolerance);
    EXPECT_NEAR(at(5.0f, TextureWrap::clamp), 0.4f, kTolerance);
    EXPECT_NEAR(at(-5.0f, TextureWrap::clamp), 0.0f, kTolerance);
}

TEST(TextureAlpha, ToleratesCoordinatesThatAreNotFiniteOrHuge) {
    const Texture texture = row({255, 255}, TextureWrap::mirror);
    EXPECT_EQ(texture_alpha(texture, {std::numeric_limits<float>::infinity(), 0.0f}), 1.0f);
    EXPECT_EQ(texture_alpha(texture, {std::numeric_limits<float>::quiet_NaN(), 1e30f}), 1.0f);
    EXPECT_EQ(texture_alpha(Texture{}, {0.5f, 0.5f}), 1.0f);
}

Scene triangle_scene(const Material& material, const Texture& texture) {
    SceneData data;
    data.materials = {material};
    data.textures = {texture};
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.texcoords = {{0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}};
    mesh.colors = {Vec4(1.0f), {1, 1, 1, 0.5f}, Vec4(1.0f)};
    mesh.triangles = {{0, 1, 2}};
    data.meshes = {mesh};
    data.instances.emplace_back();
    return Scene(std::move(data));
}

TEST(SurfaceAlpha, MultipliesMaterialTextureAndVertexColour) {
    Material material;
    material.base_color.a = 0.8f;
    material.base_color_texture = 0;
    material.alpha_cutoff = 0.5f;
    const Scene scene = triangle_scene(material, row({0, 255}, TextureWrap::clamp));
    // u = v = 1/4: texture coordinate 1/4 is the first texel's centre; at (3/4, 1/4) the second's.
    EXPECT_NEAR(surface_alpha(scene, scene.meshes()[0], 0, 0.25f, 0.25f), 0.0f, kTolerance);
    EXPECT_NEAR(surface_alpha(scene, scene.meshes()[0], 0, 0.75f, 0.25f), 0.8f * 0.625f,
                kTolerance);
    EXPECT_TRUE(is_hole(scene, scene.meshes()[0], 0, 0.25f, 0.25f));
}

TEST(SurfaceAlpha, AppliesTheMaterialsTextureTransform) {
    Material material;
    material.base_color_texture = 0;
    material.uv_scale_rotation = glm::mat2(0.0f, 1.0f, 1.0f, 0.0f);  // swaps u and v
    material.uv_offset = {0.5f, 0.0f};
    const Scene scene = triangle_scene(material, row({0, 255}, TextureWrap::repeat));
    EXPECT_NEAR(surface_alpha(scene, scene.meshes()[0], 0, 0.0f, 0.25f), 1.0f, kTolerance);
    EXPECT_NEAR(surface_alpha(scene, scene.meshes()[0], 0, 0.0f, 0.75f), 0.0f, kTolerance);
}

TEST(IsHole, NeverWithoutCutoff) {
    Material material;
    material.base_color.a = 0.0f;
    const Scene scene = triangle_scene(material, row({0}, TextureWrap::clamp));
    EXPECT_FALSE(is_hole(scene, scene.meshes()[0], 0, 0.2f, 0.2f));
}

}  // namespace
}  // namespace gnomon::trace
