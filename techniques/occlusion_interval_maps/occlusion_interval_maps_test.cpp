// The look-up on the device against the same one in double, bake::TexelFinder: what either should
// see of the sun is tested where bakes are.

#include <gnomon/error.h>
#include <gnomon/technique.h>

#include "bake/baked_texels.h"
#include "bake/circle_path.h"
#include "visibility/context_impl.h"
#include "visibility/context_test.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace gnomon {
namespace {

constexpr double kLatitude_deg = 48.0;
constexpr double kTexel_m = 1.0;
constexpr double kOnCircle_rad = 1e-3;
constexpr Extent kSize{160, 90};
constexpr int kSteps = 511;
constexpr int kFineParts = 4;

/// A place in float is exact to 1e-5 texels or so, and where two texels ask from places that are a
/// 32nd of a texel apart their weights change 32 times as fast. A driver's arc tangent may err by
/// as much: 4096 units in the last place, over pi.
constexpr double kTolerance = 5e-4;
/// Of 14,400 receivers two: those on the very border of a texel or a fine cell may be beyond it,
/// and an edge between two others may be the same as the one or the other.
constexpr double kMostBeside = 2e-4;

struct Setting {
    std::string lookup, weight;
    int bits = 16;
};

std::ostream& operator<<(std::ostream& out, const Setting& setting) {
    return out << setting.lookup << ", " << setting.weight << ", " << setting.bits << " bits";
}

bake::TexelLookup lookup_of(const Setting& setting) {
    if (setting.lookup == "nearest") return bake::TexelLookup::nearest;
    return setting.lookup == "edges" ? bake::TexelLookup::edges : bake::TexelLookup::interpolated;
}

bake::PathThrough path_through(Vec3 to_light_ws, int steps) {
    const DVec3 pole_ws = sky_direction_ws(0.0, kLatitude_deg, {.up = UpAxis::y, .north_deg = 0.0});
    return bake::circle_through(DVec3(to_light_ws), pole_ws, DVec3(0, 1, 0), steps);
}

/// The technique's bake for a sun, made again.
class InDouble {
public:
    InDouble(const Scene& scene, const DirectionalLight& sun, const Setting& setting)
        : setting_(setting), bits_(setting.bits == 8 ? BakeBits::eight : BakeBits::sixteen) {
        through_ = path_through(sun.to_light_ws, std::min(kSteps, most_steps(bits_)));
        Progress silent;
        const bool edges = lookup_of(setting) == bake::TexelLookup::edges;
        texels_ = bake::baked_texels(scene, through_.path,
                                     {.texel_size_m = kTexel_m,
                                      .bits = bits_,
                                      .most_pairs = IntervalPage::kMostPairs,
                                      .resume_file = {}},
                                     {.lit_sides_only = true, .fine_parts = edges ? kFineParts : 1},
                                     silent);
    }

    const bake::PathThrough& through() const { return through_; }
    std::size_t fine_cells() const { return texels_.fine.first_samples.size(); }

    std::vector<double> seen(const DirectionalLight& sun,
                             const std::vector<trace::Receiver>& receivers) const {
        const DVec3 to_light = glm::normalize(DVec3(sun.to_light_ws));
        bake::LightOnPath light{
            .window = {.at_step = bake::step_on(through_, to_light, kOnCircle_rad),
                       .width_steps =
                           static_cast<double>(sun.angular_diameter_rad) * through_.steps_per_rad,
                       .codes_per_step = codes_per_step(bits_),
                       .even = setting_.weight == "even",
                       .ends = through_.ends}};
        light.along_ws = glm::normalize(glm::cross(through_.path.pole_ws, to_light));
        light.across_ws = glm::cross(to_light, light.along_ws);
        const bake::TexelFinder finder(texels_);
        std::vector<double> result(receivers.size(), 1.0);
        for (std::size_t i = 0; i < receivers.size(); ++i) {
            if (!receivers[i].exists()) continue;
            const lightmap::Facet* facet = finder.facet_of(receivers[i]);
            result[i] = facet == nullptr
                            ? 0.0
                            : finder.visibility(*facet, receivers[i], lookup_of(setting_), light);
        }
        return result;
    }

private:
    Setting setting_;
    BakeBits bits_;
    bake::PathThrough through_;
    bake::BakedTexels texels_;
};

class LookUp : public ContextTest, public testing::WithParamInterface<Setting> {
protected:
    static std::unique_ptr<Technique> make(const Setting& setting) {
        return make_technique(context(), "occlusion_interval_maps",
                              {{"texel_size", kTexel_m},
                               {"lookup", setting.lookup},
                               {"weight", setting.weight},
                               {"bits", std::to_string(setting.bits)}});
    }

    /// Returns how many receivers are in a penumbra.
    static std::size_t expect_same(Technique& technique, const Frame& frame,
                                   const InDouble& in_double) {
        Progress silent;
        const Visibility visibility = technique.render(frame);
        const std::vector<trace::Receiver>& receivers =
            context().impl().receiver_points(frame, silent)->points;
        const std::vector<double> expected =
            in_double.seen(std::get<DirectionalLight>(frame.light), receivers);
        std::size_t beside = 0;
        std::size_t between = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const auto found = static_cast<double>(visibility.image().pixels()[i]);
            if (std::abs(found - expected[i]) > kTolerance) ++beside;
            if (expected[i] > 0.01 && expected[i] < 0.99) ++between;
        }
        EXPECT_LE(static_cast<double>(beside), kMostBeside * static_cast<double>(expected.size()));
        return between;
    }
};

TEST_P(LookUp, IsThatInDouble) {
    Frame frame{.scene = make_builtin_scene("gas-station"), .size = kSize};
    frame.camera = frame.scene.cameras().at(0);
    DirectionalLight sun{.to_light_ws = normalize(Vec3(-0.5f, 0.6f, 0.4f)),
                         .angular_diameter_rad = radians(2.0f)};
    const InDouble in_double(frame.scene, sun, GetParam());
    const std::unique_ptr<Technique> technique = make(GetParam());
    std::size_t between = 0;
    for (const std::size_t step : {40u, 100u, 150u, 230u}) {
        SCOPED_TRACE(step);
        sun.to_light_ws = Vec3(in_double.through().path.to_light_ws.at(step));
        frame.light = sun;
        between += expect_same(*technique, frame, in_double);
    }
    frame.camera.ortho_height_m = 12.0f;
    frame.camera.ortho_depth_m = 100.0f;
    between += expect_same(*technique, frame, in_double);
    EXPECT_GT(between, 1000u);
    EXPECT_EQ(in_double.fine_cells() > 1000, GetParam().lookup == "edges");
}

// A sun that does not set goes on from its last step to its first.
TEST_P(LookUp, IsThatInDoubleOverTheEndsOfAClosedPath) {
    Frame frame{.scene = make_builtin_scene("gas-station"), .size = kSize};
    frame.camera = frame.scene.cameras().at(0);
    DirectionalLight sun{.to_light_ws = normalize(Vec3(0.1f, 0.6f, -0.8f)),
                         .angular_diameter_rad = radians(2.0f)};
    const InDouble in_double(frame.scene, sun, GetParam());
    ASSERT_TRUE(in_double.through().ends.closed);
    const std::vector<DVec3>& directions = in_double.through().path.to_light_ws;
    const std::unique_ptr<Technique> technique = make(GetParam());
    std::size_t between = 0;
    // Between them due north: many edges are along the path there, or have one time everywhere.
    for (const DVec3& to_light :
         {directions.front(), directions.back(),
          glm::normalize(0.6 * directions.front() + 0.4 * directions.back()),
          glm::normalize(directions.front() + directions.back())}) {
        sun.to_light_ws = Vec3(to_light);
        frame.light = sun;
        between += expect_same(*technique, frame, in_double);
        const Image seen = technique->render(frame).image();
        EXPECT_GT(std::ranges::count(seen.pixels(), 1.0f), 5000) << "wholly lit, as at noon";
    }
    EXPECT_GT(between, 300u);
}

const Setting kSettings[] = {{"nearest", "even", 8},       {"nearest", "disc", 16},
                             {"interpolated", "even", 16}, {"interpolated", "disc", 16},
                             {"edges", "even", 8},         {"edges", "disc", 16}};
INSTANTIATE_TEST_SUITE_P(All, LookUp, testing::ValuesIn(kSettings));

class Impatient final : public Progress {
public:
    bool cancelled() const override { return true; }
};

class LightOffThePath : public ContextTest {};

// What takes long is the bake: the look-up alone never asks whether it is to stop.
TEST_F(LightOffThePath, IsBakedAnewAndOthersAreNot) {
    Frame frame{.scene = make_builtin_scene("cube"), .size = {64, 36}};
    frame.camera = frame.scene.cameras().at(0);
    const bake::PathThrough path = path_through({-0.5f, 0.6f, 0.4f}, 24);
    const auto at_step = [&](std::size_t step) {
        return DirectionalLight{.to_light_ws = Vec3(path.path.to_light_ws.at(step))};
    };
    const std::unique_ptr<Technique> technique =
        make_technique(context(), "occlusion_interval_maps", {{"texels", 10'000}});
    Progress silent;
    Impatient impatient;
    Visibility visibility;
    frame.light = at_step(6);
    technique->prepare(frame.scene, silent);
    technique->render(frame, visibility, silent);
    const Image early = visibility.image();
    frame.light = at_step(12);
    technique->render(frame, visibility, impatient);
    EXPECT_FALSE(std::ranges::equal(visibility.image().pixels(), early.pixels()));

    frame.light = DirectionalLight{.to_light_ws = normalize(Vec3(0.2f, 0.9f, 0.1f))};
    EXPECT_THROW(technique->render(frame, visibility, impatient), Error);
    frame.light = at_step(6);
    technique->render(frame, visibility, impatient);
    EXPECT_TRUE(std::ranges::equal(visibility.image().pixels(), early.pixels()));
}

class TexelsThatDoNotFit : public ContextTest {};

TEST_F(TexelsThatDoNotFit, AreToldByTheParameterThatTheUserSets) {
    Frame frame{.scene = make_builtin_scene("courtyard"), .size = {64, 36}};
    frame.camera = frame.scene.cameras().at(0);
    frame.light = DirectionalLight{.to_light_ws = normalize(Vec3(-0.5f, 0.6f, 0.4f))};
    const auto told = [&](bool half) {
        try {
            make_technique(context(), "occlusion_interval_maps",
                           {{"texel_size", 1e-5}, {"half_resolution", half}})
                ->render(frame);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            return std::string(error.what());
        }
        return std::string("no error");
    };
    EXPECT_NE(told(false).find("light map: texel_size 1e-05 makes"), std::string::npos)
        << told(false);
    EXPECT_NE(told(true).find("texel_size, doubled by half_resolution: 2e-05 makes"),
              std::string::npos)
        << told(true);
    EXPECT_EQ(told(false).find("texel_size_m"), std::string::npos);
}

}  // namespace
}  // namespace gnomon
