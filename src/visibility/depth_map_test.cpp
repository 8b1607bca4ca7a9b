#include "visibility/depth_map.h"

#include "gpu/device_test.h"
#include "visibility/context_impl.h"
#include "visibility/context_test.h"

#include <glm/ext/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon {
namespace {

constexpr unsigned kMapSize = 512;
constexpr std::uint64_t kAllTexels = std::uint64_t{kMapSize} * kMapSize;

/// A map that keeps what it can, and its counterparts that are drawn anew.
class ScrolledDepthMapTest : public ContextTest {
protected:
    static const gpu::Device& device() { return context().impl().device(); }

    static MapLayer layer_of(const Scene& scene, const Camera& camera,
                             const DirectionalLight& light) {
        constexpr float kMarginTexels = 3.0f;
        const LightFit fit = fit_directional_stable(light, camera, {320, 180}, {1.0, 16.0},
                                                    scene.bounds(), kMapSize, kMarginTexels);
        return {.fit = fit, .casters = CasterVolume(fit)};
    }

    static bool record(DepthMap& map, const Scene& scene, const MapLayer& layer,
                       const CasterOptions& options) {
        const raster::GpuScene& gpu_scene = context().impl().gpu_scene(scene);
        gpu::Submission submission(device());
        gpu::Commands commands = submission.begin();
        const bool is_drawn = map.record(commands, gpu_scene, std::span(&layer, 1), options);
        submission.submit_and_wait();
        return is_drawn;
    }

    static std::vector<float> depths(DepthMap& map) {
        // What is read back returns to the use that it had.
        return gpu::read_back<float>(device(), const_cast<gpu::Image&>(map.image()));
    }
};

/// Texels whose depths differ by more than rounding.
std::size_t count_off(const std::vector<float>& a, const std::vector<float>& b) {
    // Of a depth range of some tens of metres: under a millimetre, and above what interpolation in
    // float at another place of the map leaves.
    constexpr float kRounding = 1e-5f;
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        count += std::abs(a[i] - b[i]) > kRounding ? 1 : 0;
    return count;
}

TEST_F(ScrolledDepthMapTest, HoldsWhatDrawingAllOfItWould) {
    for (const char* name : {"field-small", "courtyard"}) {
        const Scene scene = make_builtin_scene(name);
        const auto light = std::get<DirectionalLight>(scene.lights().at(0));
        const Camera start = scene.cameras().at(0);
        DepthMap scrolled(device());
        for (int frame = 0; frame < 12; ++frame) {
            Camera camera = start;
            // To and fro across the light's image, by parts of a texel and by some tens.
            const float t = static_cast<float>(frame);
            camera.view_from_world = glm::translate(
                start.view_from_world, Vec3(0.02f * t * t, 0.0f, 0.7f * std::sin(1.3f * t)));
            const MapLayer layer = layer_of(scene, camera, light);
            record(scrolled, scene, layer, {.reuse = true});
            const std::uint64_t texels = scrolled.texels();
            EXPECT_LT(texels, frame == 0 ? kAllTexels + 1 : kAllTexels / 2) << name << frame;
            DepthMap drawn(device());
            record(drawn, scene, layer, {.reuse = true});
            EXPECT_EQ(drawn.texels(), kAllTexels);
            // Corners land on 1/256 of a texel, and where they land on another one an edge may
            // pass a texel's centre on the other side.
            const std::size_t off = count_off(depths(scrolled), depths(drawn));
            EXPECT_LT(off, kAllTexels / 2000) << name << ", frame " << frame;
        }
    }
}

/// One mesh, level, with its middle at the origin: many clusters.
Scene sheet_scene() {
    constexpr int kSquares = 64;  // along a side, of a metre each
    constexpr auto kCorners = static_cast<unsigned>(kSquares + 1);
    Mesh sheet;
    for (int z = 0; z <= kSquares; ++z) {
        for (int x = 0; x <= kSquares; ++x)
            sheet.positions.emplace_back(x - kSquares / 2, 0, z - kSquares / 2);
    }
    for (unsigned i = 0; i + kCorners + 1 < sheet.positions.size(); ++i) {
        if (i % kCorners == kCorners - 1) continue;
        sheet.triangles.emplace_back(i, i + kCorners, i + 1);
        sheet.triangles.emplace_back(i + 1, i + kCorners, i + kCorners + 1);
    }
    SceneData data;
    data.materials.emplace_back();
    data.meshes.push_back(std::move(sheet));
    data.instances = {Instance{}, Instance{}};
    data.instances[1].world_from_local = glm::translate(Mat4(1.0f), Vec3(0, 1, 0));
    return Scene(std::move(data));
}

TEST_F(ScrolledDepthMapTest, LeavesOutClustersButOfMeshesThatAreDrawnWholeNone) {
    const Scene scene = sheet_scene();
    const Camera camera = look_at({-28, 3, -28}, {-32, 0, -32});
    const MapLayer layer = layer_of(scene, camera, {.to_light_ws = normalize(Vec3(1, 4, 2))});
    DepthMap clusters(device());
    record(clusters, scene, layer, {.reuse = true});
    DepthMap meshes(device());
    record(meshes, scene, layer, {.reuse = true, .optimised_indices = false});
    EXPECT_GT(clusters.triangles(), 0u);
    EXPECT_LT(clusters.triangles(), meshes.triangles());
    EXPECT_EQ(meshes.triangles(), 2 * scene.meshes()[0].triangles.size());
    EXPECT_EQ(depths(clusters), depths(meshes));
}

// Where casters cover little, software devices clear in another way.
TEST_F(ScrolledDepthMapTest, HoldsNothingOfAnEarlierFrame) {
    const Scene scene = make_builtin_scene("field-small");
    const auto light = std::get<DirectionalLight>(scene.lights().at(0));
    const MapLayer all = layer_of(scene, scene.cameras().at(0), light);
    MapLayer none = all;
    none.caster_error_texels = 0.01f;                        // so that it is drawn anew
    none.casters.keep_before(ReceiverMask(all.fit, {}, 0));  // and without any
    DepthMap map(device());
    record(map, scene, all, {.reuse = true});
    EXPECT_GT(std::ranges::max(depths(map)), 0.0f);
    record(map, scene, none, {.reuse = true});
    EXPECT_EQ(map.triangles(), 0u);
    EXPECT_EQ(std::ranges::max(depths(map)), 0.0f);
}

TEST_F(ScrolledDepthMapTest, DrawsLittleWhenTheCameraMovesALittle) {
    const Scene scene = make_builtin_scene("courtyard");
    const auto light = std::get<DirectionalLight>(scene.lights().at(0));
    Camera camera = scene.cameras().at(0);
    DepthMap map(device());
    EXPECT_TRUE(record(map, scene, layer_of(scene, camera, light), {.reuse = true}));
    const std::uint64_t all_triangles = map.triangles();
    EXPECT_GT(all_triangles, 0u);
    EXPECT_EQ(map.texels(), kAllTexels);

    EXPECT_FALSE(record(map, scene, layer_of(scene, camera, light), {.reuse = true}));
    EXPECT_EQ(map.triangles(), 0u);
    EXPECT_EQ(map.texels(), 0u);

    camera.view_from_world = glm::translate(camera.view_from_world, Vec3(0.3f, 0.0f, 0.2f));
    EXPECT_TRUE(record(map, scene, layer_of(scene, camera, light), {.reuse = true}));
    // Perhaps none: where no caster is, none is drawn.
    EXPECT_LT(map.triangles(), all_triangles / 20);
    EXPECT_GT(map.texels(), 0u);
    EXPECT_LT(map.texels(), kAllTexels / 20);
}

TEST_F(ScrolledDepthMapTest, IsDrawnWholeWhenAnythingElseChanges) {
    const Scene scene = make_builtin_scene("courtyard");
    auto light = std::get<DirectionalLight>(scene.lights().at(0));
    const Camera camera = scene.cameras().at(0);
    DepthMap map(device());
    const auto texels = [&](const Scene& of, const MapLayer& layer, const CasterOptions& options) {
        record(map, of, layer, options);
        return map.texels();
    };
    MapLayer layer = layer_of(scene, camera, light);
    EXPECT_EQ(texels(scene, layer, {.reuse = true}), kAllTexels);
    EXPECT_EQ(texels(scene, layer, {.reuse = true}), 0u);
    EXPECT_EQ(texels(scene, layer, {.ignore_alpha = true, .reuse = true}), kAllTexels);
    layer.caster_error_texels = 0.5f;
    EXPECT_EQ(texels(scene, layer, {.ignore_alpha = true, .reuse = true}), kAllTexels);
    layer.faces = CasterFaces::lit;
    EXPECT_EQ(texels(scene, layer, {.ignore_alpha = true, .reuse = true}), kAllTexels);
    light.to_light_ws = normalize(light.to_light_ws + Vec3(0.01f, 0.0f, 0.0f));
    layer = layer_of(scene, camera, light);
    EXPECT_EQ(texels(scene, layer, {.reuse = true}), kAllTexels);
    const Scene other = make_builtin_scene("field-small");
    EXPECT_EQ(texels(other, layer, {.reuse = true}), kAllTexels);
    EXPECT_EQ(texels(other, layer, {.reuse = true}), 0u);
    EXPECT_EQ(texels(make_builtin_scene("field-small"), layer, {.reuse = true}), 0u);  // alike
    EXPECT_EQ(texels(other, layer, {}), kAllTexels);  // nothing is reused unless that is wanted
    EXPECT_EQ(texels(other, layer, {.reuse = true}), kAllTexels);
}

/// A map of a scene whose instances move, and its counterparts that are drawn anew.
class MovedDepthMapTest : public ScrolledDepthMapTest {
protected:
    MovedDepthMapTest() : scene_(make_builtin_scene("courtyard")) {
        camera_ = scene_.cameras().at(0);
        light_ = std::get<DirectionalLight>(scene_.lights().at(0));
    }

    std::uint32_t instance(std::string_view name) const {
        const std::vector<Instance>& all = scene_.instances();
        const auto found = std::ranges::find(all, name, &Instance::name);
        EXPECT_NE(found, all.end()) << name;
        return static_cast<std::uint32_t>(found - all.begin());
    }

    /// From where it was at first.
    InstancePose pose(std::string_view name, Vec3 by, float turn_rad = 0.0f) const {
        const Mat4& rest = scene_.instances()[instance(name)].world_from_local;
        return {instance(name),
                glm::rotate(glm::translate(Mat4(1.0f), by) * rest, turn_rad, Vec3(0, 1, 0))};
    }

    MapLayer layer() const { return layer_of(scene_, camera_, light_); }

    /// Texels that differ at all from those of a map drawn anew.
    std::size_t off(DepthMap& map, const Scene& scene, const MapLayer& layer) const {
        DepthMap anew(device());
        record(anew, Scene(scene.data()), layer, {.reuse = true});  // a scene of which none moves
        const std::vector<float> a = depths(map);
        const std::vector<float> b = depths(anew);
        std::size_t count = 0;
        for (std::size_t i = 0; i < a.size(); ++i)
            count += a[i] != b[i] ? 1 : 0;
        return count;
    }

    Scene scene_;
    Camera camera_;
    DirectionalLight light_;
};

/// How a map is drawn. Each holds to the texel what one does that is drawn anew by default.
struct Way {
    std::string label;
    CasterOptions options;
};

std::ostream& operator<<(std::ostream& out, const Way& way) {
    return out << way.label;
}

class MovedDepthMapWaysTest : public MovedDepthMapTest, public testing::WithParamInterface<Way> {
protected:
    static const CasterOptions& options() { return GetParam().options; }
};

INSTANTIATE_TEST_SUITE_P(
    Ways, MovedDepthMapWaysTest,
    testing::Values(Way{"defaults", {.reuse = true}},
                    Way{"one_by_one", {.reuse = true, .multi_draw = false}},
                    Way{"whole_vertices", {.reuse = true, .positions_only = false}},
                    Way{"whole_meshes", {.reuse = true, .optimised_indices = false}},
                    Way{"plain",
                        {.reuse = true,
                         .multi_draw = false,
                         .positions_only = false,
                         .optimised_indices = false}}),
    [](const auto& test) { return test.param.label; });

TEST_P(MovedDepthMapWaysTest, HoldsWhatDrawingAllOfItWould) {
    DepthMap map(device());
    const MapLayer rests = layer();
    record(map, scene_, rests, options());
    const std::uint64_t all_triangles = map.triangles();
    for (int frame = 0; frame < 10; ++frame) {
        const auto t = static_cast<float>(frame);
        // Leaves that pass through an urn which rests and one that turns, and out of the map.
        const std::vector<InstancePose> poses{
            pose("leaves", {0.9f * t - 4.0f, 0, 0.2f * t}),
            pose("urn-001", {0, 0.1f, 0}, 0.2f * std::floor(t / 3.0f))};
        const Scene moved = scene_.moved(poses);
        EXPECT_TRUE(record(map, moved, rests, options()));
        if (frame > 0) {
            EXPECT_LT(map.texels(), kAllTexels / 2) << frame;
            EXPECT_LT(map.triangles(), all_triangles / 2) << frame;
            EXPECT_FALSE(map.drew_still()) << frame;
        }
        EXPECT_EQ(off(map, moved, rests), 0u) << frame;
        EXPECT_FALSE(record(map, moved, rests, options()));  // all rest
    }
    // Back where they were, they leave nothing behind.
    record(map, scene_, rests, options());
    EXPECT_EQ(off(map, scene_, rests), 0u);
}

TEST_F(MovedDepthMapTest, FollowsAMapThatScrolls) {
    DepthMap map(device());
    record(map, scene_, layer(), {.reuse = true});
    for (int frame = 0; frame < 10; ++frame) {
        const auto t = static_cast<float>(frame);
        // Every other frame the camera rests, and a caster with it.
        camera_.view_from_world =
            glm::translate(scene_.cameras().at(0).view_from_world,
                           Vec3(0.1f * std::floor(t / 2.0f), 0.0f, 0.3f * std::floor(t / 2.0f)));
        const std::vector<InstancePose> poses{pose("leaves", {0.3f * t, 0, 0}),
                                              pose("urn-001", {0.2f * std::floor(t / 2.0f), 0, 0})};
        const Scene moved = scene_.moved(poses);
        const MapLayer now = layer();
        record(map, moved, now, {.reuse = true});
        DepthMap drawn(device());
        record(drawn, Scene(moved.data()), now, {.reuse = true});
        // As for maps that scroll without anything that moves.
        EXPECT_LT(count_off(depths(map), depths(drawn)), kAllTexels / 2000) << frame;
    }
}

TEST_F(MovedDepthMapTest, IsDrawnWholeOnceForWhatMovesForTheFirstTime) {
    DepthMap map(device());
    const MapLayer rests = layer();
    const auto texels = [&](const Scene& scene) {
        record(map, scene, rests, {.reuse = true});
        EXPECT_EQ(off(map, scene, rests), 0u);
        return map.texels();
    };
    const std::vector first{pose("leaves", {1, 0, 0})};
    const std::vector then{pose("leaves", {1.5f, 0, 0})};
    const std::vector other{pose("urn-001", {0, 0, 0.5f})};
    EXPECT_EQ(texels(scene_), kAllTexels);
    const std::uint64_t memory_before = map.memory_bytes();
    EXPECT_EQ(texels(scene_.moved(first)), 2 * kAllTexels);  // all that rest, and a copy
    EXPECT_GE(map.memory_bytes() - memory_before, kAllTexels * sizeof(float));
    EXPECT_LT(texels(scene_.moved(then)), kAllTexels / 2);
    EXPECT_EQ(texels(scene_.moved(other)), 2 * kAllTexels);
    EXPECT_LT(texels(scene_.moved(then).moved(other)), kAllTexels / 2);
    EXPECT_LT(texels(make_builtin_scene("courtyard")), kAllTexels / 2);  // at rest again
    EXPECT_EQ(texels(make_builtin_scene("field-small")), kAllTexels);    // where none moves
    EXPECT_EQ(map.memory_bytes(), memory_before);
}

// As a skin in another pose.
TEST_P(MovedDepthMapWaysTest, HoldsWhatChangesItsShape) {
    DepthMap map(device());
    const MapLayer rests = layer();
    record(map, scene_, rests, options());
    for (int frame = 0; frame < 6; ++frame) {
        SceneData data = scene_.data();
        for (Vec3& p : data.meshes[data.instances[instance("leaves")].mesh].positions)
            p.x += 0.1f * static_cast<float>(frame) * p.y * p.y;
        data.instances[instance("urn-001")].world_from_local =
            pose("urn-001", {0, 0.1f * static_cast<float>(frame), 0}).world_from_local;
        record(map, Scene(data), rests, options());
        if (frame > 1) {
            EXPECT_FALSE(map.drew_still()) << frame;
            EXPECT_LT(map.texels(), kAllTexels / 2) << frame;
        }
        EXPECT_EQ(off(map, Scene(data), rests), 0u) << frame;
    }
}

}  // namespace
}  // namespace gnomon
