#include <gnomon/error.h>
#include <gnomon/scene.h>

#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace gnomon {
namespace {

/// Three placements of a triangle and one of a mesh without any.
Scene triangles() {
    SceneData data;
    data.materials.emplace_back();
    data.meshes.push_back({.name = "triangle",
                           .positions = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}},
                           .triangles = {{0, 1, 2}}});
    data.meshes.push_back({.name = "nothing"});
    for (const float x : {-4.0f, 0.0f, 4.0f}) {
        data.instances.push_back({.mesh = 0,
                                  .world_from_local = glm::translate(Mat4(1.0f), Vec3(x, 0, 0)),
                                  .name = "t"});
    }
    data.instances.push_back({.mesh = 1, .name = "empty"});
    return Scene(data);
}

Mat4 at(Vec3 place) {
    return glm::translate(Mat4(1.0f), place);
}

std::string error_of(const Scene& scene, const InstancePose& pose) {
    try {
        scene.moved({&pose, 1});
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

TEST(MovedScene, HasItsInstancesElsewhereAndSharesTheRest) {
    const Scene scene = triangles();
    const std::array poses{InstancePose{1, at({0, 5, 0})}};
    const Scene moved = scene.moved(poses);
    EXPECT_EQ(moved.instances()[1].world_from_local, poses[0].world_from_local);
    EXPECT_EQ(moved.instances()[0].world_from_local, scene.instances()[0].world_from_local);
    EXPECT_EQ(moved.instances()[1].name, "t");
    EXPECT_EQ(scene.instances()[1].world_from_local, at({0, 0, 0}));  // as it was
    EXPECT_EQ(&moved.meshes(), &scene.meshes());
    EXPECT_EQ(&moved.textures(), &scene.textures());
    EXPECT_EQ(moved.triangle_count(), scene.triangle_count());
    EXPECT_TRUE(same(moved.contents_identity(), scene.contents_identity()));
    EXPECT_FALSE(same(moved.identity(), scene.identity()));
    EXPECT_EQ(moved.data().instances[1].world_from_local, poses[0].world_from_local);
    EXPECT_EQ(moved.data().meshes.size(), 2u);
}

TEST(MovedScene, BoundsFollow) {
    const Scene scene = triangles();
    EXPECT_EQ(scene.bounds().min, Vec3(-4, 0, 0));
    EXPECT_EQ(scene.bounds().max, Vec3(6, 1, 0));
    const std::array away{InstancePose{2, at({0, 7, 1})}, InstancePose{3, at({90, 0, 0})}};
    const Scene moved = scene.moved(away);
    EXPECT_EQ(moved.bounds().min, Vec3(-4, 0, 0));
    EXPECT_EQ(moved.bounds().max, Vec3(2, 8, 1));  // what has no triangles has no bounds
    // The box around the turned box: half as wide again as the triangle in it.
    const Mat4 turned = glm::rotate(Mat4(1.0f), radians(45.0f), Vec3(0, 0, 1));
    const std::array turns{InstancePose{0, turned}, InstancePose{1, turned},
                           InstancePose{2, turned}};
    const float half_root = std::sqrt(0.5f);
    const Box3 bounds = scene.moved(turns).bounds();
    EXPECT_FLOAT_EQ(bounds.min.x, -half_root);
    EXPECT_FLOAT_EQ(bounds.max.x, 2.0f * half_root);
    EXPECT_FLOAT_EQ(bounds.max.y, 3.0f * half_root);
}

TEST(MovedScene, RemembersWhatHasEverMoved) {
    const Scene scene = triangles();
    EXPECT_TRUE(scene.moving().empty());
    const std::array first{InstancePose{2, at({0, 1, 0})}};
    const std::array second{InstancePose{0, at({0, 2, 0})}, InstancePose{2, at({4, 0, 0})},
                            InstancePose{0, at({0, 3, 0})}};
    const Scene moved = scene.moved(first).moved(second);
    EXPECT_EQ(moved.moving(), (std::vector<std::uint32_t>{0, 2}));    // 2 is back where it was
    EXPECT_EQ(moved.instances()[0].world_from_local, at({0, 3, 0}));  // the last of two
    EXPECT_EQ(scene.moved(second).moving(), (std::vector<std::uint32_t>{0}));
}

// All poses of an animation can be handed over, whether they change or not.
TEST(MovedScene, IsTheSameWhereNothingMoves) {
    const Scene scene = triangles();
    const std::array still{InstancePose{1, scene.instances()[1].world_from_local}};
    EXPECT_TRUE(same(scene.moved(still).identity(), scene.identity()));
    EXPECT_TRUE(same(scene.moved({}).identity(), scene.identity()));
    EXPECT_EQ(Scene().moved({}).instances().size(), 0u);
}

TEST(MovedScene, RefusesWrongPosesByTheirValue) {
    const Scene scene = triangles();
    EXPECT_EQ(error_of(scene, {4, Mat4(1.0f)}), "moved: instance 4 of 4");
    Mat4 matrix(1.0f);
    matrix[3][1] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(
        error_of(scene, {1, matrix}),
        "moved: world_from_local of instance 1 has nan in row 1, column 3; it must be finite");
    matrix = Mat4(1.0f);
    matrix[0][3] = 0.5f;
    EXPECT_EQ(error_of(scene, {1, matrix}),
              "moved: world_from_local of instance 1 has the last row 0.5 0 0 1; an affine matrix "
              "has 0 0 0 1");
    EXPECT_NE(error_of(scene, {1, glm::scale(at({3e38f, 0, 0}), Vec3(2e38f))}).find("range"),
              std::string::npos);
    EXPECT_EQ(scene.instances()[1].world_from_local, at({0, 0, 0}));
}

}  // namespace
}  // namespace gnomon
