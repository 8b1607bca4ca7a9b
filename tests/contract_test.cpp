// What every technique promises, whatever it does: tested over the registry, so that a new
// technique is held to it by being there.

#include "harness.h"

#include <algorithm>
#include <set>

namespace gnomon {

namespace {

using test::context;

constexpr Extent kSize{64, 48};
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The registry's techniques that cast shadows; the one that does not is there to be compared with.
bool casts(const TechniqueInfo& info) {
    return info.name != "local_illumination";
}

/// A ground with a box and a ball on it.
Scene still_life() {
    return test::make_scene({test::ground(3.0f),
                             test::box({-0.9f, -0.01f, -0.4f}, {-0.1f, 1, 0.4f}),
                             test::ball({0.8f, 0.6f, 0.2f}, 0.5f, 8)});
}

Scene other_still_life() {
    return test::make_scene({test::ground(3.0f), test::ball({-0.5f, 0.9f, 0.0f}, 0.7f, 8)});
}

Camera front_view() {
    return look_at({0.5f, 3.0f, 4.0f}, {0.0f, 0.3f, 0.0f});
}

Camera side_view() {
    return look_at({4.0f, 2.0f, -0.5f}, {0.0f, 0.3f, 0.0f});
}

/// One light of each kind, high to the left; those with area shine down and to the right.
std::vector<Light> lights_above() {
    const Vec3 position(-1.8f, 3.1f, 1.3f);
    const Vec3 direction = -normalize(position);
    const Vec3 half_u = 0.2f * normalize(glm::cross(Vec3(0, 0, 1), direction));
    DirectionalLight hard_sun = sun(radians(50.0f), radians(300.0f), 0.0f);
    hard_sun.name = "hard sun";
    return {hard_sun,
            sun(radians(50.0f), radians(300.0f)),
            PointLight{.position_ws = position},
            SpotLight{.position_ws = position, .direction_ws = direction},
            SphereLight{.center_ws = position},
            DiscLight{.center_ws = position, .normal_ws = direction, .radius_m = 0.2f},
            RectLight{.center_ws = position,
                      .half_u_ws = half_u,
                      .half_v_ws = glm::cross(direction, half_u)}};
}

/// One light of each kind, wholly below a ground at y = 0 and shining up.
std::vector<Light> lights_below() {
    const Vec3 position(0.3f, -2.0f, 0.2f);
    const Vec3 up(0, 1, 0);
    return {sun(radians(-5.0f), radians(300.0f)),
            PointLight{.position_ws = position},
            SpotLight{.position_ws = position, .direction_ws = up},
            SphereLight{.center_ws = position},
            DiscLight{.center_ws = position, .normal_ws = up},
            RectLight{.center_ws = position, .half_u_ws = {0, 0, 0.5f}, .half_v_ws = {0.5f, 0, 0}}};
}

Frame still_frame(const Light& light) {
    return {.scene = still_life(), .camera = front_view(), .light = light, .size = kSize};
}

std::vector<float> pixels(const Visibility& visibility) {
    const std::span<const float> values = visibility.image().pixels();
    return {values.begin(), values.end()};
}

void expect_in_range(const Visibility& visibility, Extent size) {
    ASSERT_EQ(visibility.size(), size);
    ASSERT_EQ(visibility.image().size(), size);
    for (const float value : visibility.image().pixels())
        ASSERT_TRUE(value >= 0.0f && value <= 1.0f) << value;  // false for NaN
}

void expect_all(const Visibility& visibility, float expected) {
    for (const float value : visibility.image().pixels())
        ASSERT_EQ(value, expected);
}

/// What the Error of `call` says; a failure when there is none or it does not blame the input.
template <typename Call>
std::string input_error(Call call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

void expect_says(const std::string& message, std::string_view word) {
    EXPECT_NE(message.find(word), std::string::npos)
        << "\"" << message << "\" does not say \"" << word << "\"";
}

class Contract : public test::DeviceTest, public testing::WithParamInterface<const TechniqueInfo*> {
protected:
    const TechniqueInfo& info() const { return *GetParam(); }
    std::string name() const { return std::string(info().name); }

    std::unique_ptr<Technique> make(const Params& params = {}) const {
        return test::make_small(info().name, params);
    }

    /// Those of `lights` that the technique says it can shadow.
    std::vector<Light> claimed(const std::vector<Light>& lights) const {
        std::vector<Light> result;
        std::copy_if(lights.begin(), lights.end(), std::back_inserter(result),
                     [this](const Light& light) { return supports(info().lights, light); });
        return result;
    }
    Light any_light() const { return claimed(lights_above()).front(); }
    /// Straight down on the origin.
    Light overhead() const {
        return claimed({DirectionalLight{}, PointLight{.position_ws = {0, 8, 0}}}).front();
    }
};

std::vector<const TechniqueInfo*> all_techniques() {
    std::vector<const TechniqueInfo*> all;
    for (const TechniqueInfo& info : techniques())
        all.push_back(&info);
    return all;
}

INSTANTIATE_TEST_SUITE_P(Techniques, Contract, testing::ValuesIn(all_techniques()),
                         [](const auto& test) { return std::string(test.param->name); });

TEST_P(Contract, EveryLightItClaimsGivesLightAndShadowAndNothingElse) {
    const auto technique = make();
    ASSERT_FALSE(claimed(lights_above()).empty());
    for (const Light& light : claimed(lights_above())) {
        SCOPED_TRACE(light_name(light));
        const Visibility visibility = technique->render(still_frame(light));
        expect_in_range(visibility, kSize);
        const std::span<const float> values = visibility.image().pixels();
        EXPECT_EQ(*std::min_element(values.begin(), values.end()), 0.0f);
        EXPECT_EQ(*std::max_element(values.begin(), values.end()), 1.0f);
    }
}

// Hard lights, so that the truth has two values; soft ones have their closed forms elsewhere.
TEST_P(Contract, ShadowsAreWhereTheTruthHasThem) {
    if (!casts(info())) GTEST_SKIP() << "casts no shadows";
    const auto technique = make();
    Camera parallel = front_view();
    parallel.ortho_height_m = 4.0f;
    parallel.ortho_depth_m = 20.0f;
    for (const Light& light : claimed(lights_above())) {
        if (has_extent(light)) continue;
        for (const Camera& camera : {front_view(), parallel}) {
            SCOPED_TRACE(light_name(light) + (camera.ortho_height_m > 0.0f ? ", parallel" : ""));
            Frame frame = still_frame(light);
            frame.camera = camera;
            const Visibility truth = trace_visibility(context(), frame);
            const Comparison error =
                compare(technique->render(frame), truth, comparison_mask(context(), frame));
            EXPECT_GT(error.pixels, 1000u);
            EXPECT_EQ(error.artefact_lit, 0.0);
            EXPECT_EQ(error.artefact_shadow, 0.0);
        }
    }
}

TEST_P(Contract, AnEmptySceneIsLitEverywhere) {
    const auto technique = make();
    for (const Light& light : claimed(lights_above())) {
        const Frame frame{.scene = {}, .camera = front_view(), .light = light, .size = kSize};
        const Visibility visibility = technique->render(frame);
        expect_in_range(visibility, kSize);
        expect_all(visibility, 1.0f);
    }
}

TEST_P(Contract, WhereNothingIsSeenIsLit) {
    Frame frame = still_frame(any_light());
    frame.camera = look_at({0, 2, 0}, {0, 3, 0.5f});  // up into the sky
    expect_all(make()->render(frame), 1.0f);
}

TEST_P(Contract, ALightWhollyBelowTheHorizonGivesNothing) {
    const auto technique = make();
    for (const Light& light : claimed(lights_below())) {
        SCOPED_TRACE(light_kind(light));
        const Frame frame{.scene = test::make_scene({test::ground(3.0f)}),
                          .camera = look_at({0, 1, 0.1f}, {0, 0, 0}),
                          .light = light,
                          .size = kSize};
        expect_all(technique->render(frame), 0.0f);
    }
}

TEST_P(Contract, RefusesExactlyTheLightsThatItDoesNotClaim) {
    const auto technique = make();
    for (const Light& light : lights_above()) {
        SCOPED_TRACE(light_name(light));
        if (supports(info().lights, light)) {
            EXPECT_NO_THROW(technique->render(still_frame(light)));
            continue;
        }
        const std::string message = input_error([&] { technique->render(still_frame(light)); });
        expect_says(message, name());
        expect_says(message, light_kind(light));
    }
}

TEST_P(Contract, RefusesAnUnknownParameterByName) {
    const std::string message = input_error([&] { make({{"no_such_parameter", 1}}); });
    expect_says(message, name());
    expect_says(message, "no_such_parameter");
}

TEST_P(Contract, RefusesValuesOutOfRangeByParameterAndValue) {
    for (const ParamInfo& param : info().params()) {
        std::vector<ParamValue> wrong{std::string("no_such_word")};
        if (param.type != gnomon::ParamType::boolean) wrong.emplace_back(true);
        if (param.type == gnomon::ParamType::integer) {
            wrong.emplace_back(static_cast<int>(param.min) - 1);
            wrong.emplace_back(static_cast<int>(param.max) + 1);
        }
        if (param.type == gnomon::ParamType::number) {
            wrong.emplace_back(std::nextafter(param.min, -1e300));
            wrong.emplace_back(std::nextafter(param.max, 1e300));
            wrong.emplace_back(std::numeric_limits<double>::quiet_NaN());
        }
        for (const ParamValue& value : wrong) {
            const std::string message = input_error([&] { make({{param.name, value}}); });
            expect_says(message, name() + "." + param.name);
            expect_says(message, to_string(value));
        }
    }
}

TEST_P(Contract, DefaultsAreWithinTheirRanges) {
    std::set<std::string> names;
    for (const ParamInfo& param : info().params()) {
        SCOPED_TRACE(param.name);
        EXPECT_TRUE(names.insert(param.name).second) << "twice";
        EXPECT_FALSE(param.meaning.empty());
        EXPECT_NO_THROW(make({{param.name, param.default_value}}));
        const std::string text = to_string(param.default_value);
        EXPECT_EQ(parse_param(info().name, param, text), param.default_value) << text;
    }
}

// Greatest values are left out: a map of 1 GiB is no unit test.
TEST_P(Contract, EveryChoiceEverySwitchAndEveryLeastValueRenders) {
    for (const ParamInfo& param : info().params()) {
        std::vector<ParamValue> values(param.choices.begin(), param.choices.end());
        if (param.type == gnomon::ParamType::boolean) values = {false, true};
        if (param.type == gnomon::ParamType::integer) values = {static_cast<int>(param.min)};
        if (param.type == gnomon::ParamType::number) values = {param.min};
        for (const ParamValue& value : values) {
            SCOPED_TRACE(param.name + " = " + to_string(value));
            expect_in_range(make({{param.name, value}})->render(still_frame(any_light())), kSize);
        }
    }
}

TEST_P(Contract, TheSameInputGivesTheSameImage) {
    for (const Light& light : claimed(lights_above())) {
        SCOPED_TRACE(light_name(light));
        const Frame frame = still_frame(light);
        const auto technique = make();
        const std::vector<float> first = pixels(technique->render(frame));
        EXPECT_EQ(pixels(technique->render(frame)), first);
        EXPECT_EQ(pixels(make()->render(frame)), first) << "made anew";
    }
}

TEST_P(Contract, ResizingBackAndForthGivesTheSameImage) {
    const auto technique = make();
    const Frame frame = still_frame(any_light());
    Visibility visibility;  // one for all, as a viewer has
    technique->render(frame, visibility);
    const std::vector<float> first = pixels(visibility);
    for (const Extent size : {Extent{17, 3}, Extent{3, 17}, Extent{200, 150}}) {
        Frame resized = frame;
        resized.size = size;
        technique->render(resized, visibility);
        expect_in_range(visibility, size);
        EXPECT_EQ(pixels(visibility), pixels(make()->render(resized)));
    }
    technique->render(frame, visibility);
    EXPECT_EQ(pixels(visibility), first);
}

TEST_P(Contract, OnePixelIsEnough) {
    const auto technique = make();
    Frame frame = still_frame(overhead());
    frame.size = {1, 1};
    frame.camera = look_at({2.5f, 1, 2.5f}, {2, 0, 2});  // at the bare ground
    expect_all(technique->render(frame), 1.0f);
    if (!casts(info())) return;
    frame.camera = look_at({2.5f, 0.2f, 0}, {0.8f, 0, 0.2f});  // at the ground under the ball
    expect_all(technique->render(frame), 0.0f);
}

TEST_P(Contract, RefusesFramesThatMakeNoSense) {
    const auto technique = make();
    const Frame good = still_frame(any_light());
    Frame frame = good;
    frame.size = {0, 0};
    expect_says(input_error([&] { technique->render(frame); }), "0x0");
    frame.size = {0, 48};
    expect_says(input_error([&] { technique->render(frame); }), "0x48");
    frame.size = {16385, 1};
    expect_says(input_error([&] { technique->render(frame); }), "16385x1");
    frame = good;
    frame.camera.view_from_world[3][1] = kNan;
    expect_says(input_error([&] { technique->render(frame); }), "camera");
    frame = good;
    frame.camera.fov_y_rad = kNan;
    expect_says(input_error([&] { technique->render(frame); }), "field of view");
    frame = good;
    frame.light = DirectionalLight{.to_light_ws = {0, kNan, 0}};
    expect_says(input_error([&] { technique->render(frame); }), "to_light_ws");
    // A refusal leaves nothing behind.
    EXPECT_EQ(pixels(technique->render(good)), pixels(make()->render(good)));
}

TEST_P(Contract, ScenesAndCamerasMayChange) {
    const Frame first = still_frame(any_light());
    Frame second = first;
    second.scene = other_still_life();
    Frame turned = second;
    turned.camera = side_view();
    const std::vector<float> alone = pixels(make()->render(second));

    const auto technique = make();
    technique->prepare(first.scene);
    const std::vector<float> before = pixels(technique->render(first));
    technique->prepare(second.scene);
    EXPECT_EQ(pixels(technique->render(second)), alone);
    EXPECT_EQ(pixels(technique->render(turned)), pixels(make()->render(turned)))
        << "another camera";
    EXPECT_EQ(pixels(technique->render(first)), before) << "a scene that is not prepared";
    EXPECT_NE(alone, before);
}

TEST_P(Contract, TwoOfItDoNotDisturbEachOther) {
    const Frame first = still_frame(any_light());
    Frame second = first;
    second.scene = other_still_life();
    const auto a = make();
    const auto b = make();
    const std::vector<float> of_first = pixels(a->render(first));
    const std::vector<float> of_second = pixels(b->render(second));
    EXPECT_EQ(pixels(a->render(first)), of_first);
    EXPECT_EQ(pixels(b->render(second)), of_second);
}

TEST_P(Contract, AVisibilityOutlivesItsTechnique) {
    const Frame frame = still_frame(any_light());
    const Visibility kept = make()->render(frame);
    EXPECT_EQ(pixels(kept), pixels(make()->render(frame)));
}

TEST_P(Contract, TellsWhatARenderTook) {
    const auto technique = make();
    const Visibility visibility = technique->render(still_frame(any_light()));
    const RenderStats stats = technique->last_render();
    EXPECT_GE(stats.cpu_ms, 0.0);
    EXPECT_GT(stats.cpu_ms + stats.gpu_ms, 0.0);
    double sum_ms = 0.0;
    std::set<std::string> names;
    for (const PassTime& pass : stats.passes) {
        EXPECT_TRUE(!pass.name.empty() && names.insert(pass.name).second) << pass.name;
        EXPECT_GT(pass.ms, 0.0) << pass.name;
        sum_ms += pass.ms;
    }
    EXPECT_DOUBLE_EQ(stats.gpu_ms, sum_ms);
    // Texels are somewhere.
    if (!visibility.texel_size_m().empty()) {
        EXPECT_GT(stats.memory_bytes, 0u);
    }
}

TEST_P(Contract, TexelsHaveASizeAtEveryReceiver) {
    const Frame frame = still_frame(any_light());
    const Visibility visibility = make()->render(frame);
    const Image& texel_m = visibility.texel_size_m();
    EXPECT_GE(visibility.filter_radius_texels(), 0.0f);
    if (texel_m.empty()) {
        EXPECT_EQ(visibility.filter_radius_texels(), 0.0f);
        return;
    }
    ASSERT_EQ(texel_m.size(), frame.size);
    const ComparisonMask mask = comparison_mask(context(), frame);
    for (std::size_t i = 0; i < texel_m.pixels().size(); ++i) {
        if (mask.facing.pixels()[i] > 0.0f) {
            ASSERT_GT(texel_m.pixels()[i], 0.0f);
        }
        ASSERT_LT(texel_m.pixels()[i], frame.scene.bounds().diagonal());
    }
}

TEST_P(Contract, HolesLetLightThroughIfItSaysSo) {
    SceneData data =
        test::scene_data({test::ground(3.0f), test::quad({-1, 1, 1}, {2, 0, 0}, {0, 0, -2})});
    Material hole;
    hole.base_color.a = 0.25f;
    hole.alpha_cutoff = 0.5f;
    data.materials.push_back(hole);
    data.meshes[1].material = 1;
    Frame frame{.scene = Scene(std::move(data)),
                .camera = look_at({0, 0.5f, 0}, {0, 0, 0}),  // under the sheet
                .light = overhead(),
                .size = {16, 12}};
    const auto technique = make();
    const float solid = casts(info()) ? 0.0f : 1.0f;
    expect_all(technique->render(frame), info().honors_alpha ? 1.0f : solid);
    frame.ignore_alpha = true;
    expect_all(technique->render(frame), solid);
}

TEST_P(Contract, ACancelledPreparationDoesNoHarm) {
    class Cancelled : public Progress {
        bool cancelled() const override { return true; }
    };
    const auto technique = make();
    const Frame frame = still_frame(any_light());
    Cancelled cancelled;
    try {
        technique->prepare(frame.scene, cancelled);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::cancelled) << error.what();
    }
    EXPECT_EQ(pixels(technique->render(frame)), pixels(make()->render(frame)));
}

TEST(Registry, IsInOrderAndNamesEachOnce) {
    ASSERT_FALSE(techniques().empty());
    for (std::size_t i = 1; i < techniques().size(); ++i)
        EXPECT_LT(techniques()[i - 1].name, techniques()[i].name);
    for (const TechniqueInfo& info : techniques()) {
        EXPECT_EQ(&find_technique(info.name), &info);
        EXPECT_FALSE(info.title.empty()) << info.name;
        EXPECT_FALSE(info.source.empty()) << info.name;
        EXPECT_NE(info.lights, LightKinds::none) << info.name;
    }
}

TEST(Registry, SuggestsTheNearestName) {
    const std::string message = input_error([] { find_technique("shadow_mop"); });
    expect_says(message, "shadow_mop");
    expect_says(message, "\"shadow_map\"");
}

}  // namespace

}  // namespace gnomon
