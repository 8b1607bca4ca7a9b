#include "scene/caster_changes.h"

#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <array>

namespace gnomon::scene {
namespace {

using List = std::vector<std::uint32_t>;

/// A leaf with a hole twice, a plain triangle, and another one.
SceneData leaves() {
    SceneData data;
    data.textures.push_back({.name = "leaf", .size = {1, 2}, .rgba = {9, 9, 9, 0, 9, 9, 9, 255}});
    data.materials.push_back({.name = "plain"});
    data.materials.push_back({.name = "leaf", .base_color_texture = 0, .alpha_cutoff = 0.5f});
    for (const std::uint32_t material : {1u, 0u, 0u}) {
        data.meshes.push_back({.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                               .texcoords = {{0, 0}, {1, 0}, {0, 1}},
                               .triangles = {{0, 1, 2}},
                               .material = material});
    }
    for (const std::uint32_t mesh : {0u, 0u, 1u, 2u})
        data.instances.push_back({.mesh = mesh});
    return data;
}

/// What changes when this is done to the data.
template <typename Change>
std::optional<List> changed_by(Change change) {
    SceneData data = leaves();
    change(data);
    return changed_casters(Scene(leaves()), Scene(data));
}

TEST(ChangedCasters, AreThoseElsewhereOrOfOtherTriangles) {
    EXPECT_EQ(changed_by([](SceneData&) {}), List{});
    EXPECT_EQ(changed_by([](SceneData& data) { data.meshes[0].positions[2].y = 2.0f; }),
              (List{0, 1}));
    EXPECT_EQ(changed_by([](SceneData& data) {
                  data.meshes[1].triangles[0] = {0, 2, 1};
              }),
              (List{2}));
    EXPECT_EQ(changed_by([](SceneData& data) {
                  data.instances[1].world_from_local = glm::translate(Mat4(1.0f), Vec3(1, 0, 0));
              }),
              (List{1}));
    const Scene scene(leaves());
    const std::array pose{InstancePose{3, glm::translate(Mat4(1.0f), Vec3(0, 1, 0))}};
    EXPECT_EQ(changed_casters(scene, scene.moved(pose)), (List{3}));
}

TEST(ChangedCasters, AreThoseOfOtherHoles) {
    EXPECT_EQ(changed_by([](SceneData& data) { data.textures[0].rgba[3] = 255; }), (List{0, 1}));
    EXPECT_EQ(changed_by([](SceneData& data) { data.materials[1].alpha_cutoff = 0.4f; }),
              (List{0, 1}));
    EXPECT_EQ(changed_by([](SceneData& data) {
                  data.meshes[0].texcoords[1] = {2, 0};
              }),
              (List{0, 1}));
    EXPECT_EQ(changed_by([](SceneData& data) { data.meshes[2].material = 1; }), (List{3}));
    // What has none may look otherwise.
    EXPECT_EQ(changed_by([](SceneData& data) {
                  data.materials[0].base_color = Vec4(1.0f);
                  data.meshes[2].texcoords.clear();
              }),
              List{});
}

TEST(ChangedCasters, DoNotCareInWhichOrderMeshesAre) {
    EXPECT_EQ(changed_by([](SceneData& data) {
                  std::swap(data.meshes[0], data.meshes[2]);
                  for (Instance& instance : data.instances)
                      instance.mesh = 2 - instance.mesh;
              }),
              List{});
}

TEST(ChangedCasters, AreNotToldOfScenesThatHaveNothingInCommon) {
    EXPECT_FALSE(changed_by([](SceneData& data) { data.instances.pop_back(); }));
    EXPECT_FALSE(changed_by([](SceneData& data) {
        for (Mesh& mesh : data.meshes)
            mesh.positions[0].x = -1.0f;
    }));
}

}  // namespace
}  // namespace gnomon::scene
