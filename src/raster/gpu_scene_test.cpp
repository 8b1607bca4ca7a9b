#include "raster/gpu_scene.h"

#include "raster/drawn_test.h"
#include "raster/small_scene_test.h"

#include <glm/ext/matrix_transform.hpp>

#include <set>
#include <vector>

namespace gnomon::raster {
namespace {

class GpuSceneTest : public gpu::DeviceTest {
protected:
    static Drawn draw(const GpuScene& scene) {
        constexpr Extent kSize{64, 48};
        ReceiverPass pass(device());
        Receivers receivers;
        gpu::Submission submission(device());
        gpu::Commands commands = submission.begin();
        pass.record(commands, scene, look_at({2, 3, 9}, {0, 0, 0}), kSize, false, receivers);
        submission.submit_and_wait();
        return read_back(device(), receivers);
    }

    static void expect_alike(const GpuScene& placed, const GpuScene& made) {
        ASSERT_EQ(placed.draws().size(), made.draws().size());
        for (std::size_t i = 0; i < made.draws().size(); ++i) {
            EXPECT_EQ(placed.draws()[i].mesh, made.draws()[i].mesh);
            EXPECT_EQ(placed.draws()[i].first_slot, made.draws()[i].first_slot);
            EXPECT_EQ(placed.draws()[i].slot_count, made.draws()[i].slot_count);
            EXPECT_EQ(placed.draws()[i].part_count, made.draws()[i].part_count);
            EXPECT_EQ(placed.draws()[i].mirrored, made.draws()[i].mirrored);
        }
        ASSERT_EQ(placed.parts().size(), made.parts().size());
        for (std::size_t i = 0; i < made.parts().size(); ++i) {
            EXPECT_EQ(placed.parts()[i].slot, made.parts()[i].slot);
            EXPECT_EQ(placed.parts()[i].scale, made.parts()[i].scale);
            EXPECT_EQ(placed.part_bounds_ws()[i].min, made.part_bounds_ws()[i].min);
            EXPECT_EQ(placed.part_bounds_ws()[i].max, made.part_bounds_ws()[i].max);
        }
        const Drawn a = draw(placed);
        const Drawn b = draw(made);
        EXPECT_EQ(a.ids, b.ids);
        EXPECT_EQ(a.depths, b.depths);
        EXPECT_EQ(a.packed_normals, b.packed_normals);
    }
};

Instance placed(std::uint32_t mesh, bool mirrored = false) {
    Instance instance;
    instance.mesh = mesh;
    if (mirrored) instance.world_from_local = glm::scale(Mat4(1.0f), {-1, 1, 1});
    return instance;
}

/// Masked, solid and single-sided meshes, one of no triangles, placed in no order.
Scene mixed_scene() {
    SceneData data = scene_data({wall({}, 1), wall({}, 2), wall({}, 3), Mesh{}, wall({}, 4)});
    data.materials.resize(3);
    data.materials[1].alpha_cutoff = 0.5f;
    data.materials[2].double_sided = false;
    data.meshes[0].material = 1;
    data.meshes[2].material = 2;
    data.meshes[4].material = 1;
    data.instances = {placed(2), placed(0), placed(1), placed(3), placed(2, true),
                      placed(1), placed(4), placed(2), placed(0), placed(1, true)};
    return Scene(std::move(data));
}

TEST_F(GpuSceneTest, DrawsEachInstanceOfAnyTriangleOnce) {
    const Scene scene = mixed_scene();
    const GpuScene gpu_scene(device(), scene);
    std::multiset<std::uint32_t> drawn;
    for (const Draw& draw : gpu_scene.draws()) {
        for (std::uint32_t i = 0; i < draw.slot_count; ++i)
            drawn.insert(gpu_scene.instance_at(draw.first_slot + i));
    }
    EXPECT_EQ(drawn, (std::multiset<std::uint32_t>{0, 1, 2, 4, 5, 6, 7, 8, 9}));
}

TEST_F(GpuSceneTest, DrawsTogetherOnlyWhatIsAlike) {
    const Scene scene = mixed_scene();
    const GpuScene gpu_scene(device(), scene);
    for (const Draw& draw : gpu_scene.draws()) {
        const Mesh& mesh = scene.meshes()[draw.mesh];
        EXPECT_EQ(draw.index_count, 3 * mesh.triangles.size());
        EXPECT_EQ(draw.material, mesh.material);
        EXPECT_EQ(draw.masked, scene.materials()[mesh.material].masked());
        EXPECT_EQ(draw.double_sided, scene.materials()[mesh.material].double_sided);
        for (std::uint32_t i = 0; i < draw.slot_count; ++i) {
            const std::uint32_t instance = gpu_scene.instance_at(draw.first_slot + i);
            EXPECT_EQ(scene.instances()[instance].mesh, draw.mesh);
            EXPECT_EQ(instance == 4 || instance == 9, draw.mirrored);
        }
    }
    // Meshes 0 and 4; 1 and 2 as they are and mirrored.
    EXPECT_EQ(gpu_scene.draws().size(), 6u);
}

// Turned over, instances change places: they are drawn with those that are wound like them.
TEST_F(GpuSceneTest, PlacedElsewhereIsAsMadeThere) {
    const Scene scene = mixed_scene();
    GpuScene gpu_scene(device(), scene);
    const Mat4 aside = glm::translate(Mat4(1.0f), Vec3(3, 0, 1));
    const Mat4 turned_over = glm::scale(aside, {2, -1, 1});
    const std::vector<std::vector<InstancePose>> steps{
        {{7, aside}, {0, glm::scale(aside, Vec3(2))}},
        {{5, turned_over}, {3, aside}},
        {{5, aside}, {8, turned_over}}};
    Scene moved = scene;
    for (const std::vector<InstancePose>& poses : steps) {
        moved = moved.moved(poses);
        for (const Scene& next : {moved, scene.moved(poses), scene, moved}) {
            gpu::Submission submission(device());
            gpu::Commands commands = submission.begin();
            gpu_scene.place(commands, next);
            submission.submit_and_wait();
            expect_alike(gpu_scene, GpuScene(device(), Scene(next.data())));
        }
    }
}

TEST_F(GpuSceneTest, MayBeEmpty) {
    EXPECT_TRUE(GpuScene(device(), Scene()).draws().empty());
    const Scene without_triangles(scene_data({Mesh{}}));
    EXPECT_TRUE(GpuScene(device(), without_triangles).draws().empty());
}

TEST_F(GpuSceneTest, KnowsItsMemory) {
    SceneData data = scene_data({wall({}, 1)});
    const std::uint64_t small = GpuScene(device(), Scene(data)).memory_bytes();
    constexpr unsigned kSide = 256;
    data.textures.push_back({.name = "texture", .size = {kSide, kSide}});
    data.textures[0].rgba.resize(4 * kSide * kSide);
    const std::uint64_t large = GpuScene(device(), Scene(data)).memory_bytes();
    // Mip levels add a third; drivers may pad.
    EXPECT_GE(large - small, std::uint64_t{4} * kSide * kSide * 4 / 3);
}

}  // namespace
}  // namespace gnomon::raster
