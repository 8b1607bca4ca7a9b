// Maps that are kept and scrolled along a camera's path give the pictures of maps drawn anew.

#include <gnomon/technique.h>

#include "visibility/context_test.h"

#include <glm/ext/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gnomon {
namespace {

constexpr int kFrames = 24;

class ReusedMapsTest : public ContextTest {
protected:
    /// Compares a technique that reuses its maps with one that draws every caster in each frame.
    struct Pair {
        std::unique_ptr<Technique> reusing, drawing;

        explicit Pair(Params params) {
            params.set("fit", "stable");
            Params reuse = params;
            reuse.set("reuse_maps", true);
            reusing = make_technique(context(), "pssm", reuse);
            params.set("cull_casters", false);
            drawing = make_technique(context(), "pssm", params);
        }

        /// Share of pixels that differ at all.
        double different(const Frame& frame) const {
            const Visibility reused = reusing->render(frame);
            const Visibility drawn = drawing->render(frame);
            const std::span<const float> a = reused.image().pixels();
            const std::span<const float> b = drawn.image().pixels();
            std::size_t count = 0;
            for (std::size_t i = 0; i < a.size(); ++i)
                count += a[i] != b[i] ? 1 : 0;
            return static_cast<double>(count) / static_cast<double>(a.size());
        }
    };

    static Frame frame_of(const char* scene_name) {
        const Scene scene = make_builtin_scene(scene_name);
        return {.scene = scene,
                .camera = scene.cameras().at(0),
                .light = scene.lights().at(0),
                .size = {320, 180}};
    }

    /// Slow and fast turns, steps of parts of a texel and of metres.
    static Camera on_path(const Camera& start, int frame) {
        const auto t = static_cast<float>(frame);
        Camera camera = start;
        const Vec3 step_vs(0.004f * t * t, 0.01f * std::sin(t), 0.05f * t);
        const float turn_rad = radians(frame < kFrames / 2 ? 0.05f * t : 3.0f * std::sin(0.3f * t));
        camera.view_from_world = glm::rotate(Mat4(1.0f), turn_rad, Vec3(0, 1, 0)) *
                                 glm::translate(Mat4(1.0f), step_vs) * start.view_from_world;
        return camera;
    }
};

// Corners land on 1/256 of a texel. Where float rounds a corner to another one at another place of
// the map, an edge passes some texel's centre on the other side; and a depth's last bits decide
// about a receiver at the same depth. Pixels on such edges differ: none in field-small, two of
// 57,600 in courtyard, whose leaves have the most edges.
constexpr double kMostDifferent = 2e-4;

TEST_F(ReusedMapsTest, GiveThePicturesOfMapsDrawnAnew) {
    for (const char* scene : {"field-small", "courtyard"}) {
        for (const int step_texels : {1, 16}) {
            const Pair pair({{"stable_step", step_texels}, {"map_size", 1024}});
            Frame frame = frame_of(scene);
            const Camera start = frame.camera;
            for (int i = 0; i < kFrames; ++i) {
                frame.camera = on_path(start, i);
                const double different = pair.different(frame);
                EXPECT_LT(different, i == 0 ? 1e-12 : kMostDifferent) << scene << ", frame " << i;
            }
        }
    }
}

TEST_F(ReusedMapsTest, AreDrawnAnewWhenAnythingButTheCameraChanges) {
    const Pair pair({});
    Frame frame = frame_of("courtyard");
    // Nothing scrolls: all is drawn alike, to the last bit.
    const auto expect_same = [&](const char* what) {
        EXPECT_EQ(pair.different(frame), 0.0) << what;
    };
    expect_same("first");
    expect_same("the same again");
    frame.ignore_alpha = true;
    expect_same("masks taken for solid");
    frame.ignore_alpha = false;
    expect_same("masks again");
    frame.light = sun(radians(20.0f), radians(80.0f));
    expect_same("another sun");
    frame.camera = look_at({300, 40, 30}, {0, 1, 0});
    expect_same("a jump");
    frame.scene = make_builtin_scene("field-small");
    frame.camera = frame.scene.cameras().at(0);
    expect_same("another scene");
    frame.camera = look_at({0, 2, 0}, {0, 50, 1});
    expect_same("hardly anything is seen");
    frame.camera = frame.scene.cameras().at(0);
    expect_same("and back");
}

class MovedCastersTest : public ReusedMapsTest {
protected:
    /// The scene with things on their way: to and fro, round about, and one that stops.
    static Scene on_way(const Scene& scene, int frame) {
        const auto t = static_cast<float>(frame);
        std::vector<InstancePose> poses;
        for (std::uint32_t i = 1; i < scene.instances().size(); i += 3) {  // not the ground
            const float way = i % 2 == 0 ? t : std::min(t, 4.0f);
            const Mat4& rest = scene.instances()[i].world_from_local;
            poses.push_back(
                {i, glm::rotate(
                        glm::translate(Mat4(1.0f), {0.3f * std::sin(way), 0, 0.2f * way}) * rest,
                        0.1f * way, Vec3(0, 1, 0))});
        }
        return scene.moved(poses);
    }
};

// No map scrolls, so that all is drawn alike, to the last bit.
TEST_F(MovedCastersTest, GiveThePicturesOfMapsDrawnAnewWhileTheCameraRests) {
    for (const char* name : {"field-small", "courtyard"}) {
        const Pair pair({{"map_size", 1024}});
        Frame frame = frame_of(name);
        const Scene scene = frame.scene;
        for (const int i : {0, 1, 2, 3, 4, 5, 6, 6, 7, 0}) {
            frame.scene = i == 0 ? scene : on_way(scene, i);
            EXPECT_EQ(pair.different(frame), 0.0) << name << ", frame " << i;
        }
    }
}

TEST_F(MovedCastersTest, GiveThemAlongACamerasPath) {
    for (const int step_texels : {1, 16}) {
        const Pair pair({{"stable_step", step_texels}, {"map_size", 1024}});
        Frame frame = frame_of("field-small");
        const Scene scene = frame.scene;
        const Camera start = frame.camera;
        for (int i = 0; i < kFrames; ++i) {
            frame.camera = on_path(start, i / 2);  // every other frame it rests
            frame.scene = on_way(scene, i);
            EXPECT_LT(pair.different(frame), i == 0 ? 1e-12 : kMostDifferent) << i;
        }
    }
}

// What is made of a map follows when it scrolls.
TEST_F(ReusedMapsTest, OfOtherContentsFollow) {
    const Pair pair({{"content", "distance"}, {"map_size", 512}});
    Frame frame = frame_of("field-small");
    const Camera start = frame.camera;
    for (const int i : {0, 3, 3, 9}) {
        frame.camera = on_path(start, i);
        EXPECT_LT(pair.different(frame), kMostDifferent) << i;
    }
}

}  // namespace
}  // namespace gnomon
