// Contact: where a caster stands on the ground its shadow begins, whatever the bias, the sun and
// the filter; and under eaves, where their wall begins. A wall that the sun grazes is not in its
// own shadow.

#include "subjects.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon {

namespace {

using test::context;
using test::Subject;

constexpr double kPiD = std::numbers::pi;

/// Where a sheet stands on the ground, across the sun, its shadow begins: how far from it, across
/// the light and in texels, the farthest lit pixel is that lies in its shadow, over suns of all
/// heights and sides. Texels are wider than pixels. `judged`: how many pixels were looked at.
double widest_gap_texels(const Subject& subject, std::size_t& judged) {
    constexpr double kHalf_m = 0.6, kHeight_m = 4.0, kView_m = 2.0;
    constexpr Extent kSize{256, 256};
    constexpr double kPixel_m = kView_m / kSize.height;
    Params params = subject.params;
    const TechniqueInfo& info = find_technique(subject.technique);
    if (std::ranges::count(info.params(), "map_size", &ParamInfo::name) != 0)
        params.set("map_size", 192);
    const auto technique = test::make_small(subject.technique, params);
    double widest = 0.0;
    for (const double azimuth_deg : {30.0, 120.0, 210.0, 300.0}) {
        const double azimuth = azimuth_deg * kPiD / 180.0;
        const glm::dvec2 towards(std::sin(azimuth), -std::cos(azimuth));
        const glm::dvec2 sideways(-towards.y, towards.x);
        const Vec3 along(static_cast<float>(sideways.x), 0, static_cast<float>(sideways.y));
        const auto half = static_cast<float>(kHalf_m);
        const Scene scene = test::make_scene(
            {test::ground(1.5f), test::quad(-half * along - Vec3(0, 0.05f, 0), 2.0f * half * along,
                                            Vec3(0, static_cast<float>(kHeight_m) + 0.05f, 0))});
        for (const double elevation_deg : {5.0, 15.0, 35.0, 60.0, 85.0}) {
            const double elevation = elevation_deg * kPiD / 180.0;
            const Frame frame{
                .scene = scene,
                .camera = test::top_view({0, 0, 0}, static_cast<float>(kView_m), 8.0f),
                .light = sun(static_cast<float>(elevation), static_cast<float>(azimuth), 0.0f),
                .size = kSize};
            const Visibility visibility = technique->render(frame);
            const Image& texel_m = visibility.texel_size_m();
            for (unsigned y = 0; y < kSize.height; ++y) {
                for (unsigned x = 0; x < kSize.width; ++x) {
                    const glm::dvec2 p = kPixel_m * (glm::dvec2(x, y) + 0.5) - 0.5 * kView_m;
                    const double texel = texel_m.empty() ? kPixel_m : texel_m.at(x, y);
                    // Where texels explain what is lit, at the shadow's sides and its end.
                    const double rim_m =
                        (visibility.filter_radius_texels() + 1.5) * texel + kPixel_m;
                    const double gap_m = -glm::dot(p, towards);
                    const double end_m =
                        (kHeight_m / std::tan(elevation)) - rim_m / std::sin(elevation);
                    if (gap_m <= 0.0 || gap_m > end_m ||
                        std::abs(glm::dot(p, sideways)) > kHalf_m - rim_m) {
                        continue;
                    }
                    ++judged;
                    if (visibility.image().at(x, y) <= 0.5f) continue;
                    const double across_m = std::max(gap_m - kPixel_m, 0.0) * std::sin(elevation);
                    widest = std::max(widest, across_m / texel);
                }
            }
        }
    }
    return widest;
}

class Contact : public test::DeviceTest, public testing::WithParamInterface<Subject> {};

INSTANTIATE_TEST_SUITE_P(Techniques, Contact, testing::ValuesIn(test::subjects_apart()),
                         test::label);

TEST_P(Contact, AShadowBeginsAtItsCaster) {
    if (GetParam().label.ends_with("content_exponential")) {
        GTEST_SKIP() << "exponential maps light what is near its caster";
    }
    constexpr double kMostTexels = 1.5;
    std::size_t judged = 0;
    const double widest_texels = widest_gap_texels(GetParam(), judged);
    EXPECT_LE(widest_texels, kMostTexels);
    RecordProperty("widest_texels", std::to_string(widest_texels));
    EXPECT_GT(judged, 5000u);
}

/// A roof stands out from a wall that a high sun hardly meets, so that a texel holds much of the
/// wall: how lit the most lit pixel is in the part of its shadow that texels cannot explain. What
/// hides it from so near that it could be the wall itself is left out.
/// `judged`: how many pixels were looked at.
float most_lit_under_eaves(const Subject& subject, std::size_t& judged) {
    constexpr float kTop_m = 2.0f, kEaves_m = 0.3f, kDeep_m = 2.0f;
    constexpr float kThick_m = 0.05f, kHalf_m = 3.0f;
    constexpr float kOwn_texels = 4.0f;  // above the wall, along the light
    constexpr float kElevation_deg = 85.0f;
    constexpr Extent kSize{64, 256};
    Params params = subject.params;
    const TechniqueInfo& info = find_technique(subject.technique);
    if (std::ranges::count(info.params(), "map_size", &ParamInfo::name) != 0)
        params.set("map_size", 192);
    const auto technique = test::make_small(subject.technique, params);
    const Scene scene = test::make_scene(
        {test::quad({-kHalf_m, -kTop_m, 0}, {2 * kHalf_m, 0, 0}, {0, 2 * kTop_m, 0}),
         test::box({-kHalf_m, kTop_m, -kDeep_m}, {kHalf_m, kTop_m + kThick_m, kEaves_m})});
    Camera camera = test::top_view({0, 0, 0}, 2 * kTop_m, 8.0f);
    camera.view_from_world = glm::translate(Mat4(1.0f), {0, 0, -8.0f});  // towards the wall
    const Frame frame{.scene = scene,
                      .camera = camera,
                      .light = sun(radians(kElevation_deg), radians(180.0f), 0.0f),
                      .size = kSize};
    const Visibility visibility = technique->render(frame);
    const Image& texel_m = visibility.texel_size_m();
    const float tangent = std::tan(radians(kElevation_deg));
    constexpr float kPixel_m = 2 * kTop_m / static_cast<float>(kSize.height);
    float most = 0.0f;
    for (unsigned y = 0; y < kSize.height; ++y) {
        for (unsigned x = 0; x < kSize.width; ++x) {
            const float below_m = kPixel_m * (static_cast<float>(y) + 0.5f);
            const float texel = texel_m.empty() ? kPixel_m : texel_m.at(x, y);
            const auto rim_texels = static_cast<float>(visibility.filter_radius_texels() + 1.5);
            const bool explained = below_m > (kEaves_m - rim_texels * texel) * tangent;
            if (explained || below_m < kOwn_texels * texel) continue;
            ++judged;
            most = std::max(most, visibility.image().at(x, y));
        }
    }
    return most;
}

// Half of the filter was lit where planes went on through the roof.
TEST_P(Contact, AWallIsDarkUnderItsEaves) {
    if (GetParam().label.ends_with("content_exponential")) {
        GTEST_SKIP() << "exponential maps light what is near its caster";
    }
    std::size_t judged = 0;
    EXPECT_LT(most_lit_under_eaves(GetParam(), judged), 0.25f);
    EXPECT_GT(judged, 2000u);
}

class GrazedWall : public test::DeviceTest {
protected:
    /// A wall that is a quarter of the picture. The light is `before_wall` of its distance in front
    /// of it.
    static Frame frame(float before_wall, float angular_diameter_rad) {
        return {
            .scene = test::make_scene({test::ground(8.0f), test::box({-1, -0.05f, -2}, {1, 3, 0})}),
            .camera = look_at({2.5f, 1.6f, 4.0f}, {0, 1.4f, 0}),
            .light = DirectionalLight{.to_light_ws = normalize({0.1f, 1.0f, before_wall}),
                                      .angular_diameter_rad = angular_diameter_rad},
            .size = {160, 120}};
    }
    /// Its edges are.
    static constexpr double kMostFalse = 0.005;
};

// Of a map it covers nine millimetres, less than a texel, and most texels around it hold its roof.
// Looked up in its own place, up to 0.079 of the picture was dark.
TEST_F(GrazedWall, IsLitThoughNoTexelShowsIt) {
    const Frame grazed = frame(0.003f, 0.0f);
    for (const char* technique : {"shadow_map", "pssm", "lispsm", "tsm", "psm"}) {
        for (const char* filter : {"nearest", "hardware_2x2", "box_4x4", "disc"}) {
            const Params params{{"filter", std::string(filter)}, {"map_size", 512}};
            const Comparison error = test::compare_with_truth(technique, grazed, params);
            EXPECT_LT(error.false_shadow, kMostFalse) << technique << ", " << filter;
        }
    }
}

// The map is drawn from the sun's middle, which is just behind the wall; the half of the disc that
// is before it lights the wall. A plane that is turned over makes 0.018 of the picture false.
TEST_F(GrazedWall, IsLitByWhatItSeesOfTheSun) {
    constexpr float kBehind = 5e-4f;  // a ninth of the disc's radius
    const Frame grazed = frame(-kBehind, radians(0.53f));
    const Visibility truth = trace_visibility(context(), grazed, {.samples = 64});
    const ComparisonMask mask = comparison_mask(context(), grazed);
    for (const char* technique : {"lispsm", "psm"}) {
        for (const char* filter : {"box_3x3", "pcss"}) {
            const Params params{{"filter", std::string(filter)}, {"map_size", 512}};
            const Comparison error = compare(test::render(technique, grazed, params), truth, mask);
            EXPECT_LT(error.false_shadow, kMostFalse) << technique << ", " << filter;
        }
    }
}

class TooMuchBias : public test::DeviceTest {};

TEST_F(TooMuchBias, DetachesShadows) {
    std::size_t judged = 0;
    EXPECT_GT(widest_gap_texels({"", "shadow_map", {{"bias_constant", 6.0}}}, judged), 3.0);
}

}  // namespace

}  // namespace gnomon
