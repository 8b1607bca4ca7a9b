// The technique on a bake that is there, against the same texels in double; which of them a
// receiver is on is tested by the page of gnomon web, which has its own way to find them.

#include <gnomon/error.h>
#include <gnomon/technique.h>

#include "bake/path_place.h"
#include "bake/stored_texels.h"
#include "visibility/context_impl.h"
#include "visibility/context_test.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace gnomon {
namespace {

constexpr Extent kSize{160, 90};
constexpr double kTexel_m = 1.0;
constexpr Place kMunich{48.137, 11.575, 520.0};

/// As where the technique bakes by itself.
constexpr double kTolerance = 5e-4;
constexpr double kMostBeside = 2e-4;

constexpr double kOnPath_rad = 1e-6;
/// What a direction in single precision leaves of a step of 0.02 rad.
constexpr double kStep = 1e-5;

std::string message_of(const auto& call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    return {};
}

struct Setting {
    std::string lookup;
    BakeBits bits = BakeBits::sixteen;
};

std::ostream& operator<<(std::ostream& out, const Setting& setting) {
    return out << setting.lookup << ", " << static_cast<int>(setting.bits) << " bits";
}

IntervalBake bake_of(const BakePath& path, BakeBits bits) {
    Progress silent;
    return bake_intervals(
        make_builtin_scene("gas-station"), path,
        {.texel_size_m = kTexel_m, .bits = bits, .most_pairs = 16, .resume_file = {}}, silent);
}

BakePath summers_day(BakeBits bits) {
    using namespace std::chrono;
    SunPathOptions options;
    options.steps = std::min(most_steps(bits), 511);
    return bake_path(sun_path(kMunich, 2026y / June / 21, minutes(60), options), "Munich", "June");
}

/// A lamp that comes up far above the horizon and goes away before it is down.
BakePath lamps_sweep() {
    const LightPath sweep(LightPathKind::direction, Interpolation::spherical,
                          {{0.0, {1.0, 0.7, 0.2}}, {30.0, {0.0, 1.0, 0.5}}, {90.0, {-1, 0.9, 0}}});
    return bake_path(sweep, 90, 0.05);
}

double step_at(const BakePath& path, double clock_s) {
    return (clock_s - path.begin_s) / (path.end_s - path.begin_s) * path.steps();
}

class StoredBake : public ContextTest, public testing::WithParamInterface<Setting> {
protected:
    static bake::TexelLookup lookup() {
        if (GetParam().lookup == "nearest") return bake::TexelLookup::nearest;
        return GetParam().lookup == "edges" ? bake::TexelLookup::edges
                                            : bake::TexelLookup::interpolated;
    }

    static std::vector<double> in_double(const IntervalBake& bake, double clock_s,
                                         const std::vector<trace::Receiver>& receivers) {
        const double at = step_at(bake.path, clock_s);
        bake::LightOnPath light{
            .window = {.at_step = at,
                       .width_steps = disc_width_steps(bake.path, bake.codes_per_step()),
                       .codes_per_step = bake.codes_per_step(),
                       .ends = path_ends(bake.path)}};
        const DVec3 here = DVec3(light_at(bake.path, clock_s).to_light_ws);
        const std::optional<bake::PathPlace> place = bake::place_on(bake.path, here, kOnPath_rad);
        EXPECT_TRUE(place);
        EXPECT_NEAR(place->at_step, at, kStep);
        light.along_ws = place->along_ws;
        light.across_ws = glm::cross(here, light.along_ws);
        const bake::BakedTexels texels = bake::stored_texels(bake);
        const bake::TexelFinder finder(texels);
        std::vector<double> result(receivers.size(), 1.0);
        for (std::size_t i = 0; i < receivers.size(); ++i) {
            if (!receivers[i].exists()) continue;
            const lightmap::Facet* facet = finder.facet_of(receivers[i]);
            result[i] =
                facet == nullptr ? 0.0 : finder.visibility(*facet, receivers[i], lookup(), light);
        }
        return result;
    }

    static std::size_t expect_same(const IntervalBake& bake,
                                   std::initializer_list<double> parts_of_path) {
        const std::unique_ptr<Technique> technique =
            make_technique(context(), bake, {{"lookup", GetParam().lookup}});
        Frame frame{.scene = bake.scene, .size = kSize};
        frame.camera = frame.scene.cameras().at(0);
        Progress silent;
        std::size_t between = 0;
        for (const double part : parts_of_path) {
            SCOPED_TRACE(part);
            const double clock_s = std::lerp(bake.path.begin_s, bake.path.end_s, part);
            frame.light = light_at(bake.path, clock_s);
            const Visibility visibility = technique->render(frame);
            const std::vector<double> expected =
                in_double(bake, clock_s, context().impl().receiver_points(frame, silent)->points);
            std::size_t beside = 0;
            for (std::size_t i = 0; i < expected.size(); ++i) {
                const auto found = static_cast<double>(visibility.image().pixels()[i]);
                if (std::abs(found - expected[i]) > kTolerance) ++beside;
                if (expected[i] > 0.01 && expected[i] < 0.99) ++between;
            }
            EXPECT_LE(static_cast<double>(beside),
                      kMostBeside * static_cast<double>(expected.size()));
        }
        return between;
    }
};

TEST_P(StoredBake, IsLookedUpAsInDouble) {
    const IntervalBake bake = bake_of(summers_day(GetParam().bits), GetParam().bits);
    EXPECT_GT(expect_same(bake, {0.0, 0.2, 0.4567, 0.8, 1.0}), 500u);
}

TEST_P(StoredBake, GoesOnBeyondEndsThatAreUp) {
    const BakePath path = lamps_sweep();
    ASSERT_TRUE(path_ends(path).begins_up && path_ends(path).ends_up && !path_ends(path).closed);
    const IntervalBake bake = bake_of(path, GetParam().bits);
    EXPECT_GT(expect_same(bake, {0.0, 0.01, 0.5, 0.99, 1.0}), 500u);
}

constexpr BakeBits kEight = BakeBits::eight;
constexpr BakeBits kSixteen = BakeBits::sixteen;
const Setting kSettings[] = {{"nearest", kEight},
                             {"interpolated", kEight},
                             {"interpolated", kSixteen},
                             {"edges", kEight},
                             {"edges", kSixteen}};
INSTANTIATE_TEST_SUITE_P(All, StoredBake, testing::ValuesIn(kSettings));

class StoredBakeErrors : public ContextTest {
protected:
    StoredBakeErrors() : bake_(bake_of(summers_day(kEight), kEight)) {}
    IntervalBake bake_;
};

TEST_F(StoredBakeErrors, NameWhatIsNotOfTheBake) {
    const std::unique_ptr<Technique> technique = make_technique(context(), bake_);
    Frame frame{.scene = bake_.scene, .size = {16, 9}};
    frame.camera = frame.scene.cameras().at(0);
    frame.light = DirectionalLight{.to_light_ws = {0, 1, 0}, .name = "zenith"};
    std::string told = message_of([&] { technique->render(frame); });
    EXPECT_NE(told.find("zenith"), std::string::npos) << told;
    EXPECT_NE(told.find("not on the bake's path"), std::string::npos) << told;

    frame.light = light_at(bake_.path, 43200.0);
    frame.scene = make_builtin_scene("cube");
    told = message_of([&] { technique->render(frame); });
    EXPECT_NE(told.find("cube"), std::string::npos) << told;
    frame.scene = bake_.scene;
    EXPECT_EQ(message_of([&] { technique->render(frame); }), "");

    told = message_of([&] { make_technique(context(), bake_, {{"steps", 100}}); });
    EXPECT_NE(told.find("steps"), std::string::npos) << told;
    EXPECT_NE(told.find("lookup, weight"), std::string::npos) << told;

    SceneData data = bake_.scene.data();
    data.meshes.front().lightmap_texcoords.clear();
    bake_.scene = Scene(std::move(data));
    told = message_of([&] { make_technique(context(), bake_); });
    EXPECT_NE(told.find("TEXCOORD_1"), std::string::npos) << told;
}

TEST(LightAt, IsTheSunOfThatTime) {
    const BakePath path = summers_day(kSixteen);
    for (const double part : {0.0, 0.0007, 0.31, 0.5, 0.9993, 1.0}) {
        const double clock_s = std::lerp(path.begin_s, path.end_s, part);
        using namespace std::chrono;
        const auto since = duration_cast<milliseconds>(duration<double>(clock_s));
        const SunPosition sun =
            sun_position(kMunich, civil_time(2026y / June / 21, since, minutes(60)));
        const DVec3 wanted = sky_direction_ws(sun.azimuth_deg, sun.elevation_deg, {});
        const DVec3 found(light_at(path, clock_s).to_light_ws);
        EXPECT_LT(glm::distance(wanted, found), 1e-6) << part;
    }
    EXPECT_FLOAT_EQ(light_at(path, 43200.0).angular_diameter_rad,
                    static_cast<float>(path.angular_diameter_rad));
    EXPECT_NE(message_of([&] { light_at(path, path.begin_s - 1.0); }), "");
    EXPECT_NE(message_of([&] { light_at(path, path.end_s + 1.0); }), "");
    EXPECT_NE(message_of([&] { light_at(BakePath{}, 0.0); }), "");
}

}  // namespace
}  // namespace gnomon
