#include "technique/technique_base.h"

#include <gnomon/error.h>

#include "base/parallel.h"
#include "raster/small_scene_test.h"
#include "visibility/context_test.h"

namespace gnomon {
namespace {

TEST(Supports, TellsTheKindsOfLightApart) {
    const std::vector<std::pair<Light, LightKinds>> lights = {
        {DirectionalLight{}, LightKinds::directional},
        {PointLight{}, LightKinds::point},
        {SpotLight{}, LightKinds::spot},
        {SphereLight{}, LightKinds::sphere},
        {DiscLight{}, LightKinds::disc},
        {RectLight{}, LightKinds::rect}};
    for (const auto& [light, kind] : lights) {
        for (const LightKinds kinds : {LightKinds::directional, LightKinds::point, LightKinds::spot,
                                       LightKinds::sphere, LightKinds::disc, LightKinds::rect}) {
            EXPECT_EQ(supports(kinds, light), kinds == kind) << light_kind(light);
        }
        EXPECT_EQ(light_kinds(kind), std::vector{light_kind(light)});
        EXPECT_TRUE(supports(LightKinds::all, light)) << light_kind(light);
        EXPECT_FALSE(supports(LightKinds::none, light)) << light_kind(light);
    }
    EXPECT_TRUE(supports(LightKinds::point | LightKinds::spot, SpotLight{}));
    EXPECT_FALSE(supports(LightKinds::point | LightKinds::spot, DirectionalLight{}));
}

TEST(FindTechnique, KnowsThemAllByName) {
    ASSERT_FALSE(techniques().empty());
    for (const TechniqueInfo& info : techniques()) {
        EXPECT_EQ(&find_technique(info.name), &info);
        EXPECT_EQ(!info.lookup_params.empty(), &info == &bake_technique()) << info.name;
        for (const std::string_view param : info.lookup_params)
            EXPECT_EQ(find_param(info.name, info.params(), std::string(param)).name, param);
    }
}

TEST(FindTechnique, SuggestsTheNearestName) {
    try {
        find_technique("shadow_mpa");
        FAIL() << "there is no such technique";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        const std::string text = error.what();
        EXPECT_NE(text.find("did you mean \"shadow_map\"?"), std::string::npos) << text;
        EXPECT_NE(text.find("ray_traced"), std::string::npos) << text;  // it lists what there is
    }
}

const TechniqueInfo kCounting{.name = "counting",
                              .lights = LightKinds::directional | LightKinds::point};

/// Says how often it was asked, and 0.25 everywhere.
class Counting final : public HostTechnique {
public:
    explicit Counting(Context& context) : HostTechnique(context, kCounting) {}
    int prepared = 0;
    int computed = 0;

private:
    void prepare_scene(const Scene&, Progress& progress) override {
        throw_if_cancelled(progress, "counting");
        ++prepared;
    }
    void compute(const Frame& frame, std::span<const trace::Receiver> receivers,
                 std::span<float> out, Progress&) override {
        ++computed;
        EXPECT_EQ(receivers.size(), std::size_t{frame.size.width} * frame.size.height);
        EXPECT_EQ(receivers.size(), out.size());
        for (float& v : out)
            v = 0.25f;
    }
    std::uint64_t memory_bytes() const override { return 1234; }
};

class TechniqueBaseTest : public ContextTest {
protected:
    static Frame frame(float wall_m = 5.0f) {
        return {.scene = Scene(raster::scene_data({raster::wall({0, 0, -wall_m}, 4)})),
                .light = DirectionalLight{},
                .size = {8, 4}};
    }
};

TEST_F(TechniqueBaseTest, PreparesWhenTheSceneIsAnotherOne) {
    Counting technique(context());
    Frame first = frame();
    technique.render(first);
    technique.render(first);
    EXPECT_EQ(technique.prepared, 1);
    first.camera = look_at({1, 2, 3}, {0, 0, 0});
    first.size = {3, 3};
    first.light = PointLight{};
    first.scene = Scene(first.scene);  // a copy is the same scene
    technique.render(first);
    EXPECT_EQ(technique.prepared, 1);
    const Frame second = frame(6.0f);
    technique.render(second);
    EXPECT_EQ(technique.prepared, 2);
    technique.prepare(first.scene);
    technique.render(first);
    EXPECT_EQ(technique.prepared, 3);
    EXPECT_EQ(technique.computed, 5);
}

TEST_F(TechniqueBaseTest, PreparesForASceneThatIsGoneAndCameAgain) {
    Counting technique(context());
    for (int i = 1; i <= 3; ++i) {
        technique.render(frame());  // a scene of its own, likely at the same address
        EXPECT_EQ(technique.prepared, i);
    }
}

TEST_F(TechniqueBaseTest, RefusesLightsThatItDoesNotClaim) {
    Counting technique(context());
    Frame bad = frame();
    bad.light = SphereLight{.name = "lamp"};
    try {
        technique.render(bad);
        FAIL() << "it was rendered";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_EQ(std::string(error.what()), "counting: cannot shadow a sphere light (\"lamp\")");
    }
    EXPECT_EQ(technique.computed, 0);
}

TEST_F(TechniqueBaseTest, RefusesBadFramesBeforeAnyWork) {
    Counting technique(context());
    Frame empty = frame();
    empty.size = {0, 4};
    EXPECT_THROW(technique.render(empty), Error);
    Frame crooked = frame();
    crooked.camera.view_from_world[0][0] = 2.0f;
    EXPECT_THROW(technique.render(crooked), Error);
    Frame unlit = frame();
    unlit.light = DirectionalLight{.to_light_ws = {0, 2, 0}};
    EXPECT_THROW(technique.render(unlit), Error);
    EXPECT_EQ(technique.prepared, 0);
}

TEST_F(TechniqueBaseTest, FillsTheVisibilityThatItIsGiven) {
    Counting technique(context());
    Visibility visibility;
    for (const Extent size : {Extent{8, 4}, Extent{1, 1}}) {
        Frame asked = frame();
        asked.size = size;
        technique.render(asked, visibility);
        EXPECT_EQ(visibility.image().size(), size);
        for (const float v : visibility.image().pixels())
            EXPECT_EQ(v, 0.25f);
    }
    EXPECT_EQ(technique.last_render().memory_bytes, 1234u);
    EXPECT_EQ(technique.last_render().gpu_ms, 0.0);
}

class Stopped : public Progress {
public:
    bool cancelled() const override { return true; }
};

TEST_F(TechniqueBaseTest, IsNotPreparedWhenCancelled) {
    Counting technique(context());
    const Frame asked = frame();
    Stopped progress;
    EXPECT_THROW(technique.prepare(asked.scene, progress), Error);
    technique.render(asked);
    EXPECT_EQ(technique.prepared, 1);
}

/// Two passes that leave 0.
class TwoPasses final : public GpuTechnique {
public:
    explicit TwoPasses(Context& context) : GpuTechnique(context, kCounting) {}

private:
    void record(gpu::Commands& commands, const RecordInput& input,
                gpu::Image& visibility) override {
        EXPECT_EQ(input.receivers.size, input.frame.size);
        for (const char* name : {"one", "two"}) {
            const gpu::Pass pass(commands, name);
            commands.use(visibility, gpu::Use::copy_target);
            const VkClearColorValue zero{};
            const VkImageSubresourceRange whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
            vkCmdClearColorImage(commands.handle(), visibility.handle(),
                                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &zero, 1, &whole);
        }
    }
    std::uint64_t memory_bytes() const override { return 7; }
};

TEST_F(TechniqueBaseTest, OnTheDeviceTellsItsPasses) {
    TwoPasses technique(context());
    for (int i = 0; i < 2; ++i) {
        const Visibility visibility = technique.render(frame());
        for (const float v : visibility.image().pixels())
            EXPECT_EQ(v, 0.0f);
        const RenderStats stats = technique.last_render();
        ASSERT_EQ(stats.passes.size(), 2u);
        EXPECT_EQ(stats.passes[0].name, "one");
        EXPECT_EQ(stats.passes[1].name, "two");
        EXPECT_DOUBLE_EQ(stats.gpu_ms, stats.passes[0].ms + stats.passes[1].ms);
        EXPECT_EQ(stats.memory_bytes, 7u);
    }
}

}  // namespace
}  // namespace gnomon
