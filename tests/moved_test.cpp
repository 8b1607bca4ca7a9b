// A scene whose instances move gives the pictures and the truth of one that was made with them
// where they are, with every technique and frame after frame.

#include "harness.h"
#include "subjects.h"
#include "technique/map_technique.h"

#include <glm/ext/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>

namespace gnomon {
namespace {

using test::context;

constexpr Extent kSize{96, 64};
constexpr int kSteps = 4;

// Instances of the yard.
constexpr std::uint32_t kBall = 2;
constexpr std::uint32_t kLeaf = 3;
constexpr std::uint32_t kBox = 4;

/// A leaf with a hole: a texture that is clear in its middle.
Texture leaf_texture() {
    constexpr unsigned kSide = 8;
    Texture texture{.name = "leaf", .size = {kSide, kSide}};
    for (unsigned i = 0; i < kSide * kSide; ++i) {
        const bool hole = i % kSide / 2 % 3 != 0 && i / kSide / 2 % 3 != 0;
        for (const int value : {90, 140, 40, hole ? 0 : 255})
            texture.rgba.push_back(static_cast<std::uint8_t>(value));
    }
    return texture;
}

/// A ground and a mast that stay, whose bounds hold all that moves: a ball, a masked leaf and a
/// box.
Scene yard() {
    Mesh leaf = test::quad({-0.5f, 1.1f, 0.5f}, {1, 0.3f, 0}, {0, 0.2f, -1});
    leaf.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    leaf.material = 1;
    SceneData data = test::scene_data({test::ground(4.0f),
                                       test::box({-2.1f, -0.01f, -1.2f}, {-1.8f, 3.0f, -0.9f}),
                                       test::ball({0, 0, 0}, 0.4f, 6), leaf,
                                       test::box({-0.2f, -0.2f, -0.2f}, {0.2f, 0.3f, 0.2f})});
    data.textures.push_back(leaf_texture());
    data.materials.push_back({.name = "leaf", .base_color_texture = 0, .alpha_cutoff = 0.5f});
    data.instances[kBall].world_from_local = glm::translate(Mat4(1.0f), Vec3(0.5f, 0.5f, 0.3f));
    data.instances[kBox].world_from_local = glm::translate(Mat4(1.0f), Vec3(1.3f, 0.25f, -0.4f));
    return Scene(std::move(data));
}

/// From step 2 on the leaf rests; the box turns over at last.
std::vector<InstancePose> poses_at(int step) {
    const auto t = static_cast<float>(step);
    const Mat4 one(1.0f);
    const Mat4 box = glm::translate(one, Vec3(1.3f, 0.5f, -0.4f + 0.2f * t));
    return {{kBall, glm::translate(one, Vec3(0.5f - 0.4f * t, 0.5f + 0.1f * t, 0.3f))},
            {kLeaf, glm::rotate(glm::translate(one, Vec3(0, 0, 0.3f * std::min(t, 2.0f))),
                                0.2f * std::min(t, 2.0f), Vec3(0, 1, 0))},
            {kBox, step == kSteps ? glm::scale(box, Vec3(1, -1, 1)) : box}};
}

/// The same scene, made with its instances there.
Scene made_at(int step) {
    SceneData data = yard().data();
    for (const InstancePose& pose : poses_at(step))
        data.instances[pose.instance].world_from_local = pose.world_from_local;
    return Scene(std::move(data));
}

/// And its leaf bent.
Scene bent_at(int step) {
    SceneData data = made_at(step).data();
    data.meshes[data.instances[kLeaf].mesh].positions[2].y -= 0.1f * static_cast<float>(step);
    return Scene(std::move(data));
}

Camera front_view() {
    return look_at({0.5f, 3.0f, 4.5f}, {0.0f, 0.3f, 0.0f});
}

Light light_for(LightKinds kinds) {
    const Vec3 lamp(-1.2f, 2.4f, 1.3f);
    const std::array<Light, 4> lights{
        DirectionalLight{.to_light_ws = normalize({-0.5f, 1.0f, 0.4f})},
        PointLight{.position_ws = lamp},
        SpotLight{.position_ws = lamp, .direction_ws = -normalize(lamp)},
        SphereLight{.center_ws = lamp}};
    return *std::ranges::find_if(lights,
                                 [&](const Light& light) { return supports(kinds, light); });
}

Frame frame_of(const Scene& scene, const Light& light) {
    return {.scene = scene, .camera = front_view(), .light = light, .size = kSize};
}

std::vector<float> pixels(const Visibility& visibility) {
    const std::span<const float> values = visibility.image().pixels();
    return {values.begin(), values.end()};
}

/// What the technique offers to be quick, as far as it offers any of it.
Params quick(const TechniqueInfo& info) {
    Params params;
    for (const ParamInfo& param : info.params()) {
        if (param.name == "map_size") params.set(param.name, 128);
        if (param.name == "texels") params.set(param.name, 2000);
    }
    return params;
}

class Moved : public test::DeviceTest, public testing::WithParamInterface<const TechniqueInfo*> {};

std::vector<const TechniqueInfo*> all_techniques() {
    std::vector<const TechniqueInfo*> all;
    for (const TechniqueInfo& info : techniques())
        all.push_back(&info);
    return all;
}

INSTANTIATE_TEST_SUITE_P(Techniques, Moved, testing::ValuesIn(all_techniques()),
                         [](const auto& test) { return std::string(test.param->name); });

TEST_P(Moved, PicturesAreThoseOfTheSceneMadeSo) {
    const Light light = light_for(GetParam()->lights);
    const auto technique = make_technique(context(), GetParam()->name, quick(*GetParam()));
    const Scene scene = yard();
    Visibility visibility = technique->render(frame_of(scene, light));
    // One after the other, as an animation goes; then anew.
    std::vector<std::vector<float>> pictures;
    for (int step = 0; step <= kSteps; ++step) {
        technique->render(frame_of(scene.moved(poses_at(step)), light), visibility);
        pictures.push_back(pixels(visibility));
    }
    for (int step = 0; step <= kSteps; ++step) {
        const auto anew = make_technique(context(), GetParam()->name, quick(*GetParam()));
        EXPECT_EQ(pictures[static_cast<std::size_t>(step)],
                  pixels(anew->render(frame_of(made_at(step), light))))
            << "step " << step;
    }
    EXPECT_NE(pictures[0], pictures[1]);
}

// What is made for a placement is gone when the next one has come.
TEST_P(Moved, ScenesOfThePastAreForgotten) {
    constexpr int kFrames = 100;
    const Light light = light_for(GetParam()->lights);
    const auto technique = make_technique(context(), GetParam()->name, quick(*GetParam()));
    const Scene scene = yard();
    std::vector<SceneKey> keys;
    std::uint64_t memory_bytes = 0;
    for (int i = 0; i < kFrames; ++i) {
        const std::array poses{InstancePose{
            kBall, glm::translate(Mat4(1.0f), Vec3(0.01f * static_cast<float>(i), 0.5f, 0.3f))}};
        Frame frame = frame_of(scene.moved(poses), light);
        frame.size = {24, 16};
        keys.push_back(frame.scene.identity());
        technique->render(frame);
        const std::uint64_t now_bytes = technique->last_render().memory_bytes;
        // Buffers of shadow volumes grow with their casters' silhouettes, and by half at once.
        if (i == 0) memory_bytes = now_bytes;
        EXPECT_LE(now_bytes, memory_bytes + memory_bytes / 2);
    }
    const auto alive =
        std::ranges::count_if(keys, [](const SceneKey& key) { return !key.expired(); });
    // The last one, and one whose tree is made in the frame after the next at the latest.
    EXPECT_LE(alive, 2);
}

class MovedScenes : public test::DeviceTest {};

TEST_F(MovedScenes, HaveTheTruthOfTheSceneMadeSo) {
    const Light light = light_for(LightKinds::point);
    const Scene scene = yard();
    std::vector<std::vector<float>> truths;
    for (int step = 0; step <= kSteps; ++step) {
        truths.push_back(
            pixels(trace_visibility(context(), frame_of(scene.moved(poses_at(step)), light))));
    }
    for (int step = 0; step <= kSteps; ++step) {
        EXPECT_EQ(truths[static_cast<std::size_t>(step)],
                  pixels(trace_visibility(context(), frame_of(made_at(step), light))));
    }
    EXPECT_NE(truths[0], truths[1]);
}

/// A technique that keeps what rests in its maps, and how its maps are to be drawn.
struct Reusing {
    std::string label;
    std::string technique;
    Params params;
};

std::ostream& operator<<(std::ostream& out, const Reusing& reusing) {
    return out << reusing.label;
}

class MovedReusing : public test::DeviceTest, public testing::WithParamInterface<Reusing> {
protected:
    std::unique_ptr<Technique> reusing_technique() { return made_with("reuse_maps", true); }
    /// Draws all of its maps for each frame.
    std::unique_ptr<Technique> drawing_technique() { return made_with("cull_casters", false); }

private:
    std::unique_ptr<Technique> made_with(const char* name, bool value) {
        Params params = GetParam().params;
        params.set("map_size", 256);
        params.set(name, value);
        return make_technique(context(), GetParam().technique, params);
    }
};

INSTANTIATE_TEST_SUITE_P(
    Maps, MovedReusing,
    testing::Values(
        Reusing{"pssm", "pssm", {{"fit", "stable"}}}, Reusing{"pssm_tight", "pssm", {}},
        Reusing{"pssm_vertices", "pssm", {{"fit", "stable"}, {"positions_only", false}}},
        Reusing{"pssm_indices", "pssm", {{"fit", "stable"}, {"optimised_indices", false}}},
        Reusing{"pssm_layered", "pssm", {{"fit", "stable"}, {"layered", true}}},
        Reusing{"pssm_moments", "pssm", {{"fit", "stable"}, {"content", "moments"}}},
        Reusing{"omni", "omni", {}}, Reusing{"omni_vertices", "omni", {{"positions_only", false}}},
        Reusing{"omni_indices", "omni", {{"optimised_indices", false}}},
        Reusing{"omni_distance", "omni", {{"content", "distance"}}},
        Reusing{"shadow_map", "shadow_map", {}}, Reusing{"lispsm", "lispsm", {}},
        Reusing{"tsm", "tsm", {}}, Reusing{"psm", "psm", {}}),
    [](const auto& test) { return test.param.label; });

// The camera rests and jumps, so that no map scrolls and all pictures are alike to the bit.
TEST_P(MovedReusing, MapsGiveThePicturesOfMapsDrawnAnew) {
    const auto reusing = reusing_technique();
    const Light light = light_for(find_technique(GetParam().technique).lights);
    const Scene scene = yard();
    for (int step = 0; step <= 2 * kSteps; ++step) {
        // There and, without what is not moved, back.
        const int at = std::min(step, 2 * kSteps - step);
        Frame frame = frame_of(at == 0 ? scene : scene.moved(poses_at(at)), light);
        if (step == 3) frame.camera = look_at({3.5f, 2.0f, 3.0f}, {0.0f, 0.3f, 0.0f});
        const auto drawing = drawing_technique();
        EXPECT_EQ(pixels(reusing->render(frame)), pixels(drawing->render(frame))) << step;
        // What stays is drawn at first, without what moves when that moves first, and for each
        // of the camera's jumps.
        const bool is_drawn = step <= 1 || step == 3 || step == 4;
        EXPECT_EQ(dynamic_cast<MapTechnique&>(*reusing).map().drew_still(), is_drawn) << step;
    }
}

// Scenes that are made or loaded anew for each pose, as of skins.
TEST_P(MovedReusing, MapsFollowScenesMadeAnew) {
    const auto reusing = reusing_technique();
    const auto drawing = drawing_technique();
    const Light light = light_for(find_technique(GetParam().technique).lights);
    for (int step = 0; step <= kSteps; ++step) {
        const Frame frame = frame_of(bent_at(step), light);
        EXPECT_EQ(pixels(reusing->render(frame)), pixels(drawing->render(frame))) << step;
        EXPECT_EQ(dynamic_cast<MapTechnique&>(*reusing).map().drew_still(), step <= 1) << step;
    }
}

TEST_F(MovedScenes, LeaveNoShadowWhereTheyWere) {
    const auto technique = make_technique(
        context(), "pssm", {{"fit", "stable"}, {"reuse_maps", true}, {"map_size", 512}});
    const Light light = light_for(LightKinds::directional);
    const Scene scene = yard();
    const auto lit = [&](const Scene& of) {
        const std::vector<float> values = pixels(technique->render(frame_of(of, light)));
        return std::ranges::count(values, 1.0f);
    };
    const auto with = lit(scene);
    const Mat4 far_off = glm::translate(Mat4(1.0f), Vec3(0, -40, 0));  // under the ground
    const std::vector<InstancePose> away{{kBall, far_off}, {kLeaf, far_off}, {kBox, far_off}};
    const auto without = lit(scene.moved(away));
    SceneData bare = scene.data();
    bare.instances.resize(kBall);
    const std::vector<float> expected = pixels(
        test::render("pssm", frame_of(Scene(bare), light), {{"fit", "stable"}, {"map_size", 512}}));
    EXPECT_EQ(without, std::ranges::count(expected, 1.0f));
    EXPECT_GT(without, with + 50);  // the ball's shadow alone
    EXPECT_EQ(lit(scene), with);
}

}  // namespace
}  // namespace gnomon
