#include "raster/gpu_scene.h"

#include "gpu/device_test.h"
#include "raster/small_scene_test.h"

#include <glm/ext/matrix_transform.hpp>

#include <set>

namespace gnomon::raster {
namespace {

class GpuSceneTest : public gpu::DeviceTest {};

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
