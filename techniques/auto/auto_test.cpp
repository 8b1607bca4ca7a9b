#include <gnomon/technique.h>

#include "choice.h"
#include "visibility/context_test.h"

#include <gtest/gtest.h>

namespace gnomon::automatic {
namespace {

constexpr Extent kSize{1280, 720};

Frame frame_of(const Light& light) {
    return {.scene = {}, .camera = look_at({0, 2, 5}, {0, 0, 0}), .light = light, .size = kSize};
}

ParamValue value(const Choice& choice, const std::string& name) {
    return choice.params.values().at(name);
}

TEST(Choose, TracesRaysWithoutAGpu) {
    for (const Light& light : {Light(DirectionalLight{}), Light(PointLight{}), Light(RectLight{})})
        EXPECT_EQ(choose(frame_of(light), {1.0, 100.0}, true).technique, "ray_traced");
}

TEST(Choose, SplitsDeepViewsMore) {
    const Frame frame = frame_of(DirectionalLight{});
    int before = 0;
    for (const double far_m : {1.8, 3.6, 7.0, 15.0, 30.0, 60.0}) {
        const Choice choice = choose(frame, {1.0, far_m}, false);
        EXPECT_EQ(choice.technique, "pssm");
        EXPECT_EQ(std::get<int>(value(choice, "splits")), ++before);
    }
    EXPECT_EQ(std::get<int>(value(choose(frame, {0.01, 1e6}, false), "splits")), 6);
    EXPECT_EQ(std::get<int>(value(choose(frame, {0.0, 0.0}, false), "splits")), 1);
    Frame parallel = frame;
    parallel.camera.ortho_height_m = 10.0f;
    EXPECT_EQ(std::get<int>(value(choose(parallel, {1.0, 1000.0}, false), "splits")), 1);
}

TEST(Choose, FollowsThePictureAndTheSun) {
    Frame frame = frame_of(sun(radians(40.0f), 0.0f));
    EXPECT_EQ(std::get<int>(value(choose(frame, {1, 9}, false), "map_size")), 2048);
    EXPECT_EQ(std::get<std::string>(value(choose(frame, {1, 9}, false), "filter")), "pcss");
    frame.size = {64, 16384};
    frame.light = sun(radians(40.0f), 0.0f, 0.0f);
    EXPECT_EQ(std::get<int>(value(choose(frame, {1, 9}, false), "map_size")), 4096);
    EXPECT_EQ(std::get<std::string>(value(choose(frame, {1, 9}, false), "filter")), "box_3x3");
}

TEST(Choose, TakesATechniqueThatShadowsTheLight) {
    SpotLight wide;
    wide.outer_angle_rad = radians(85.0f);
    for (const Light& light :
         {Light(DirectionalLight{}), Light(PointLight{}), Light(SpotLight{}), Light(wide),
          Light(SphereLight{}), Light(DiscLight{}), Light(RectLight{})}) {
        const Choice choice = choose(frame_of(light), {1.0, 100.0}, false);
        EXPECT_TRUE(supports(find_technique(choice.technique).lights, light));
        EXPECT_FALSE(choice.reason.empty());
    }
}

class AutomaticTest : public ContextTest {};

TEST_F(AutomaticTest, IsWhatItChose) {
    const Scene scene = make_builtin_scene("gas-station");
    const Frame frame{.scene = scene,
                      .camera = scene.cameras().at(0),
                      .light = scene.lights().at(0),
                      .size = {160, 90}};
    const auto automatic = make_technique(context(), "auto", {{"device", "gpu"}});
    const Visibility visibility = automatic->render(frame);
    const std::string note = automatic->last_render().note;
    EXPECT_EQ(note.rfind("pssm, filter pcss, map_size 2048, splits ", 0), 0u) << note;
    const int splits =
        note.at(std::string("pssm, filter pcss, map_size 2048, splits ").size()) - '0';
    const Visibility chosen =
        make_technique(context(), "pssm",
                       {{"filter", "pcss"}, {"map_size", 2048}, {"splits", splits}})
            ->render(frame);
    EXPECT_TRUE(std::ranges::equal(visibility.image().pixels(), chosen.image().pixels()));
}

}  // namespace
}  // namespace gnomon::automatic
