#include <gnomon/error.h>
#include <gnomon/sun_hours.h>

#include "bake/legend.h"
#include "bake/texel_receivers.h"
#include "interval/test_days.h"
#include "lightmap/atlas.h"
#include "trace/test_scenes.h"
#include "trace/tracer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numeric>

namespace gnomon {

namespace {

using namespace std::chrono;
using interval::Random;
using trace::Receiver;

constexpr Place kMunich{48.137, 11.575, 520.0};
constexpr year_month_day kEquinox = 2026y / March / 20;

SunHoursOptions on_day(year_month_day date, double step_minutes = 5.0, Place place = kMunich) {
    return {.place = place,
            .from = date,
            .to = date,
            .utc_offset = nearest_utc_offset(place),
            .step_minutes = step_minutes};
}

SunHoursResult hours_at(const Scene& scene, const std::vector<SunSensor>& sensors,
                        const SunHoursOptions& options) {
    Progress silent;
    return sun_hours(scene, sensors, options, silent);
}

SunHoursResult hours_on_surface(const Scene& scene, double texel_size_m,
                                const SunHoursOptions& options) {
    Progress silent;
    return sun_hours(scene, texel_size_m, options, silent);
}

double hours_between(const CivilTime& from, const CivilTime& to) {
    return duration<double, std::ratio<3600>>(to.utc - from.utc).count();
}

/// What sun_path tells of the day, which sun_hours has by other ways, in steps as documented.
SunPath path_of(const SunHoursOptions& options, year_month_day date) {
    SunPathOptions path{.frame = {UpAxis::y, options.north_deg},
                        .horizon_deg = options.horizon_deg};
    path.sun.refraction = options.refraction;
    const double daylight_s =
        sun_path(options.place, date, options.utc_offset, path).times.daylight_s;
    path.steps = std::max(1, static_cast<int>(std::ceil(daylight_s / 60.0 / options.step_minutes)));
    return sun_path(options.place, date, options.utc_offset, path);
}

/// Hours of each receiver, ray by ray.
std::vector<double> traced_hours(const Scene& scene, const std::vector<Receiver>& receivers,
                                 const SunHoursOptions& options, year_month_day date) {
    const trace::Tracer tracer = trace::make_tracer(scene, options.ignore_alpha);
    const SunPath path = path_of(options, date);
    std::vector<double> hours(receivers.size(), 0.0);
    for (const SunStep& step : path.steps) {
        const DirectionalLight sun{.to_light_ws = Vec3(step.to_sun_ws)};
        const std::vector<float> lit = trace::visibility(tracer, receivers, sun);
        for (std::size_t i = 0; i < lit.size(); ++i) {
            hours[i] +=
                lit[i] * path.times.daylight_s / 3600.0 / static_cast<double>(path.steps.size());
        }
    }
    return hours;
}

/// Points all over the scene's triangles, as many as wanted, with the normals of their fronts.
std::vector<SunSensor> random_sensors(const Scene& scene, std::size_t count) {
    std::vector<trace::SurfaceId> triangles;
    std::vector<double> areas;
    double area = 0.0;
    for (std::uint32_t i = 0; i < scene.instances().size(); ++i) {
        const std::size_t size = scene.meshes()[scene.instances()[i].mesh].triangles.size();
        for (std::uint32_t t = 0; t < size; ++t) {
            area += glm::length(trace::world_triangle(scene, {i, t}).front_normal_ws());
            triangles.push_back({i, t});
            areas.push_back(area);
        }
    }
    Random random(1);
    std::vector<SunSensor> sensors;
    while (sensors.size() < count) {
        const auto found = std::ranges::upper_bound(areas, area * random.between(0.0f, 1.0f));
        if (found == areas.end()) continue;
        const trace::Triangle triangle = trace::world_triangle(
            scene, triangles[static_cast<std::size_t>(found - areas.begin())]);
        const double s = random.between(0.0f, 1.0f), t = random.between(0.0f, 1.0f);
        const auto& [a, b, c] = triangle.corners_ws;
        const DVec3 point = s + t < 1.0 ? a + s * (b - a) + t * (c - a)
                                        : a + (1.0 - s) * (b - a) + (1.0 - t) * (c - a);
        sensors.push_back({point, glm::normalize(triangle.front_normal_ws())});
    }
    return sensors;
}

std::vector<Receiver> as_receivers(const std::vector<SunSensor>& sensors) {
    std::vector<Receiver> receivers;
    for (const SunSensor& sensor : sensors) {
        receivers.push_back({Vec3(sensor.position_ws),
                             Vec3(sensor.normal_ws / glm::length(sensor.normal_ws)),
                             {trace::kNoSurface, 0}});
    }
    return receivers;
}

/// Hours and rays agree to a step: the rays' directions are float, so that the one step at which
/// the sun passes an edge may differ. Returns how many points differ at all.
int expect_as_traced(const Scene& scene, const SunHoursResult& result,
                     const std::vector<Receiver>& receivers) {
    const std::vector<double> traced =
        traced_hours(scene, receivers, result.options, result.options.from);
    const double step_h = result.days.step_minutes / 60.0;
    int different = 0;
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        constexpr double kRounding_h = 1e-4;  // of sums in float
        EXPECT_NEAR(result.hours[i].mean_h, traced[i], step_h + kRounding_h) << i;
        different += std::abs(result.hours[i].mean_h - traced[i]) > 0.5 * step_h ? 1 : 0;
    }
    return different;
}

int expect_as_traced(const Scene& scene, const std::vector<SunSensor>& sensors,
                     const SunHoursOptions& options) {
    return expect_as_traced(scene, hours_at(scene, sensors, options), as_receivers(sensors));
}

std::string message_of(const auto& call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

TEST(SunHours, OpenGroundHasTheWholeDay) {
    const SunHoursResult result =
        hours_at(Scene(), {{}, {.normal_ws = {0, -1, 0}}}, on_day(kEquinox));
    EXPECT_NEAR(result.hours[0].mean_h, result.days.possible_h, 1e-4);
    EXPECT_NEAR(result.hours[0].longest_mean_h, result.days.possible_h, 1e-4);
    EXPECT_EQ(result.hours[1].mean_h, 0.0f) << "the underside";
    EXPECT_NEAR(result.days.possible_h, 12.0, 0.1) << "an equinox";
}

TEST(SunHours, WallLeavesTheMorning) {
    // Along the meridian, 1 km high and 2 km long, 1 m west of the sensor: it takes all sun from
    // the west but 0.001 rad over the zenith and along the wall, which pass in 15 s.
    const Scene scene =
        trace::make_scene({{trace::quad({0, 0, 1000}, {0, 0, -2000}, {0, 1000, 0})}});
    const SunHoursOptions options = on_day(kEquinox, 3.0);
    const SunPath path = path_of(options, kEquinox);
    const SunHoursResult result =
        hours_at(scene, {{.position_ws = {1, 0, 0}}, {.position_ws = {-1, 0, 0}}}, options);
    const double edge_h = 15.0 / 3600.0, half_step_h = 0.5 * result.days.step_minutes / 60.0;
    EXPECT_NEAR(result.hours[0].mean_h, hours_between(*path.times.sunrise, path.noon),
                half_step_h + edge_h);
    EXPECT_NEAR(result.hours[1].mean_h, hours_between(path.noon, *path.times.sunset),
                half_step_h + edge_h);
    EXPECT_EQ(result.hours[0].mean_h, result.hours[0].longest_mean_h) << "one span";
}

TEST(SunHours, PoleTakesItsAngleOutOfTheDay) {
    // A board 1 m wide, 2 m south of the sensor (south is +Z), too high to look over: it hides the
    // sun while its azimuth is within atan(0.5 / 2) of south.
    const Scene scene = trace::make_scene({{trace::quad({-0.5f, 0, 2}, {1, 0, 0}, {0, 100, 0})}});
    const SunHoursOptions options = on_day(2026y / June / 21, 2.0);
    const SunPath path = path_of(options, options.from);
    const double half_deg = std::atan2(0.5, 2.0) * 180.0 / std::acos(-1.0);
    double shade_s = 0.0;
    for (milliseconds t = -6h; t < 6h; t += 1s) {
        const CivilTime time{path.noon.utc + t, options.utc_offset};
        if (std::abs(sun_position(options.place, time).azimuth_deg - 180.0) < half_deg)
            shade_s += 1.0;
    }
    const SunHoursResult result = hours_at(scene, {{}}, options);
    const double step_h = result.days.step_minutes / 60.0;
    EXPECT_NEAR(result.hours[0].mean_h, result.days.possible_h - shade_s / 3600.0, step_h);
    // The longer half of the day. The sun's noon is not quite the middle of its arc.
    EXPECT_NEAR(result.hours[0].longest_mean_h, 0.5 * (result.days.possible_h - shade_s / 3600.0),
                step_h);
}

TEST(SunHours, AreThoseOfRaysOnBuiltinScenes) {
    for (const char* name : {"courtyard", "gas-station", "cube"}) {
        const Scene scene = make_builtin_scene(name);
        const int different = expect_as_traced(scene, random_sensors(scene, 500), on_day(kEquinox));
        EXPECT_LE(different, 5) << name << ": an edge at the very step is rare";
    }
}

TEST(SunHours, AreThoseOfRaysWithNorthHorizonAndRefraction) {
    const Scene scene = make_builtin_scene("courtyard");
    SunHoursOptions options = on_day(2026y / November / 3, 10.0, {-33.9, 151.2, 0.0});
    options.north_deg = 30.0;
    options.horizon_deg = 5.0;
    options.refraction = Atmosphere{};
    expect_as_traced(scene, random_sensors(scene, 200), options);
}

TEST(SunHours, TexelsAreThoseOfRays) {
    constexpr double kTexel_m = 0.3;
    const Scene scene = make_builtin_scene("courtyard");
    const SunHoursResult result = hours_on_surface(scene, kTexel_m, on_day(kEquinox, 30.0));
    const lightmap::Atlas atlas = lightmap::make_atlas(scene, {.texel_size_m = kTexel_m});
    const std::vector<Receiver> receivers =
        bake::texel_receivers(atlas, lightmap::make_texels(scene, atlas));
    ASSERT_EQ(receivers.size(), result.hours.size());
    // Regular grids put some texels exactly into the plane of another surface (7 of 44,130: beside
    // the terrace's steps and on a bench), where a ray begins on what may shade it: single
    // precision takes it for hit, double for not.
    constexpr std::ptrdiff_t kInPlanes = 10;
    const std::vector<double> traced = traced_hours(scene, receivers, result.options, kEquinox);
    const double step_h = result.days.step_minutes / 60.0;
    std::ptrdiff_t different = 0;
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        constexpr double kRounding_h = 1e-4;  // of sums in float
        different += std::abs(result.hours[i].mean_h - traced[i]) > step_h + kRounding_h ? 1 : 0;
    }
    EXPECT_LE(different, kInPlanes);
}

TEST(SunHours, DaysOfAPeriodAreCountedTogetherAsAlone) {
    const Scene scene = make_builtin_scene("courtyard");
    const std::vector<SunSensor> sensors = random_sensors(scene, 100);
    SunHoursOptions options = on_day(kEquinox, 60.0);
    options.to = 2026y / May / 20;
    options.every_days = 3;
    const SunHoursResult together = hours_at(scene, sensors, options);
    ASSERT_EQ(together.days.period, 62);
    ASSERT_EQ(together.days.sampled, 21);
    std::vector<SunHours> alone(sensors.size(), {0.0f, 24.0f, 0.0f, 24.0f});
    for (sys_days day = kEquinox; day <= sys_days(options.to); day += days(3)) {
        const SunHoursResult result = hours_at(scene, sensors, on_day(day, 60.0));
        for (std::size_t i = 0; i < sensors.size(); ++i) {
            alone[i].mean_h += result.hours[i].mean_h / 21.0f;
            alone[i].longest_mean_h += result.hours[i].longest_mean_h / 21.0f;
            alone[i].worst_h = std::min(alone[i].worst_h, result.hours[i].mean_h);
            alone[i].longest_worst_h =
                std::min(alone[i].longest_worst_h, result.hours[i].longest_mean_h);
        }
    }
    constexpr float kRounding_h = 1e-4f;  // of sums in float
    for (std::size_t i = 0; i < sensors.size(); ++i) {
        EXPECT_NEAR(together.hours[i].mean_h, alone[i].mean_h, kRounding_h);
        EXPECT_NEAR(together.hours[i].longest_mean_h, alone[i].longest_mean_h, kRounding_h);
        EXPECT_NEAR(together.hours[i].worst_h, alone[i].worst_h, kRounding_h);
        EXPECT_NEAR(together.hours[i].longest_worst_h, alone[i].longest_worst_h, kRounding_h);
    }
}

TEST(SunHours, PolarNightIsToldInWords) {
    const Place tromso{69.65, 18.96, 0.0};
    const SunHoursResult night =
        hours_at(Scene(), {{}}, on_day(2026y / December / 21, 5.0, tromso));
    EXPECT_EQ(night.hours[0].mean_h, 0.0f);
    EXPECT_NE(table(night).find("polar night"), std::string::npos);
    SunHoursOptions winter = on_day(2026y / November / 20, 60.0, tromso);
    winter.to = 2026y / December / 31;
    const SunHoursResult season = hours_at(Scene(), {{}}, winter);
    EXPECT_GT(season.days.polar_nights, 20);
    EXPECT_LT(season.days.polar_nights, season.days.sampled);
    EXPECT_EQ(season.hours[0].worst_h, 0.0f);
    EXPECT_NEAR(season.hours[0].mean_h, season.days.possible_h, 1e-4);
    EXPECT_NE(table(season).find("days are polar night"), std::string::npos);
}

TEST(SunHours, PolarDayLastsAllDay) {
    const SunHoursResult day =
        hours_at(Scene(), {{}}, on_day(2026y / June / 21, 2.0, {69.65, 18.96, 0.0}));
    EXPECT_NEAR(day.hours[0].mean_h, 24.0, 1e-3);
    EXPECT_NEAR(day.hours[0].longest_mean_h, 24.0, 1e-3);
}

TEST(SunHours, TexelsHaveTheSurfacesArea) {
    // A cube of side 2 on nothing: all its sides are seen, 4 m2 each.
    const Scene scene = trace::make_scene({{trace::cube()}});
    const SunHoursResult result = hours_on_surface(scene, 0.23, on_day(kEquinox, 30.0));
    const std::array<double, 2> thresholds_h = {0.5, 25.0};
    const std::vector<SunHoursSummary> summaries = summarize(result, thresholds_h);
    ASSERT_EQ(summaries.size(), 7u);
    EXPECT_NEAR(summaries[0].weight, 24.0, 1e-4);
    for (std::size_t i = 1; i < 7; ++i)
        EXPECT_NEAR(summaries[i].weight, 4.0, 1e-4) << summaries[i].facing;
    const auto facing = [&](std::string_view name) {
        return *std::ranges::find(summaries, name, &SunHoursSummary::facing);
    };
    EXPECT_NEAR(facing("up").mean_h, result.days.possible_h, 1e-3);
    EXPECT_EQ(facing("down").greatest_h, 0.0);
    EXPECT_NEAR(facing("up").met[0], 1.0, 1e-9);
    EXPECT_EQ(facing("up").met[1], 0.0);
    // East and west have half the day each; the south on an equinox nearly all of it.
    const double step_h = result.days.step_minutes / 60.0;
    EXPECT_NEAR(facing("east").mean_h, 0.5 * result.days.possible_h, step_h);
    EXPECT_NEAR(facing("west").mean_h, 0.5 * result.days.possible_h, step_h);
    EXPECT_GT(facing("south").mean_h, 0.95 * result.days.possible_h);
}

TEST(SunHours, FacingGoesByTrueNorth) {
    SunHoursOptions options = on_day(kEquinox, 30.0);
    options.north_deg = 90.0;  // north is +X
    const SunHoursResult result = hours_at(Scene(), {{.normal_ws = {1, 0, 0}}}, options);
    EXPECT_EQ(summarize(result).back().facing, "north");
    EXPECT_LT(result.hours[0].mean_h, 1.0f);
}

TEST(SunHours, PagesSayWhereThereIsNoSurface) {
    const Scene scene = trace::make_scene({{trace::cube()}});
    const SunHoursResult result = hours_on_surface(scene, 0.2, on_day(kEquinox, 30.0));
    std::size_t surface = 0;
    for (const Image& page : sun_hours_pages(result)) {
        for (const float hours : page.pixels()) {
            EXPECT_TRUE(hours == -1.0f || (hours >= 0.0f && hours <= 24.0f)) << hours;
            surface += hours >= 0.0f ? 1 : 0;
        }
    }
    EXPECT_EQ(surface, result.points.size());
}

TEST(SunHours, GridLeavesOutInsides) {
    // [-1, 1]³: of the points of a plane through its middle and beside it.
    const Scene other_sides =
        trace::make_scene({{trace::cube()}, {trace::quad({-3, -1, 3}, {6, 0, 0}, {0, 0, -6})}});
    SceneData data = other_sides.data();
    for (Material& material : data.materials)
        material.double_sided = !material.double_sided;
    const Scene scene(std::move(data));
    ASSERT_NE(scene.materials()[0].double_sided, other_sides.materials()[0].double_sided);
    const SunGrid grid = make_sun_grid(scene, 0.5, 0.0);
    EXPECT_EQ(grid.size, (Extent{12, 12}));
    for (const Scene& sides : {scene, other_sides}) {
        Progress silent;
        const SunHoursResult result = sun_hours(sides, grid, on_day(kEquinox, 30.0), silent);
        for (std::size_t i = 0; i < result.points.size(); ++i) {
            const DVec3 p = result.points[i].position_ws;
            const bool inside = std::abs(p.x) < 1.0 && std::abs(p.z) < 1.0;
            EXPECT_EQ(result.weights[i], inside ? 0.0 : 1.0) << p.x << ", " << p.z;
        }
        EXPECT_EQ(summarize(result).front().points, 144u - 16u);
    }
    EXPECT_EQ(make_sun_grid(scene, 0.5).first_ws.y, 0.0) << "1 m over the lowest point";
}

TEST(SunHours, ThatNeedMoreMemoryThanThereIsAreRefusedBeforeTheyStart) {
    const Scene scene = make_builtin_scene("courtyard");
    SunHoursOptions options = on_day(kEquinox, 60.0);
    const auto told = [&] {
        try {
            hours_on_surface(scene, 0.05, options);
            return std::string("no error");
        } catch (const Error& error) {
            return std::string(error.what());
        }
    };
    // Twice what the light map alone takes.
    options.memory_limit_bytes = 2 * lightmap::estimate(scene, {.texel_size_m = 0.05}).bytes;
    EXPECT_NE(told().find("memory_limit_bytes allows"), std::string::npos) << told();
    options.memory_limit_bytes = std::uint64_t{1} << 40;
    options.more_bytes = std::uint64_t{1} << 41;  // of pictures
    EXPECT_NE(told().find("memory_limit_bytes allows"), std::string::npos) << told();
}

TEST(SunHours, OptionsOutOfRangeAreErrors) {
    const auto told = [](const auto& change) {
        SunHoursOptions options = on_day(kEquinox);
        change(options);
        return message_of([&] { hours_at(Scene(), {{}}, options); });
    };
    EXPECT_NE(told([](auto& o) { o.step_minutes = 1.0; }).find("2 to 60"), std::string::npos);
    EXPECT_NE(told([](auto& o) { o.every_days = 0; }).find("1 to 366"), std::string::npos);
    EXPECT_NE(told([](auto& o) { o.horizon_deg = 30.0; }).find("-1 to 18"), std::string::npos);
    EXPECT_NE(told([](auto& o) { o.to = 2025y / March / 1; }).find("period"), std::string::npos);
    EXPECT_NE(told([](auto& o) { o.place.latitude_deg = 91.0; }).find("91"), std::string::npos);
    EXPECT_NE(message_of([] {
                  hours_at(Scene(), {{}, {.normal_ws = DVec3(0.0)}}, on_day(kEquinox));
              }).find("point 2"),
              std::string::npos);
}

TEST(SunHours, TexelSizeIsARoundNumber) {
    // 24 m2 in 400,000 texels: 0.0077 m.
    EXPECT_NEAR(choose_texel_size_m(trace::make_scene({{trace::cube()}})), 0.01, 1e-9);
}

TEST(SunHours, ColorsAreThoseOfViridis) {
    // matplotlib's table at quarters.
    constexpr std::array<std::array<int, 3>, 5> kTable = {{{0x44, 0x01, 0x54},
                                                           {0x3b, 0x52, 0x8b},
                                                           {0x21, 0x91, 0x8c},
                                                           {0x5e, 0xc9, 0x62},
                                                           {0xfd, 0xe7, 0x25}}};
    for (std::size_t i = 0; i < kTable.size(); ++i) {
        const Vec3 color = bake::false_color(0.25 * static_cast<double>(i));
        for (int channel = 0; channel < 3; ++channel) {
            const int table = kTable[i][static_cast<std::size_t>(channel)];
            EXPECT_NEAR(color[channel], static_cast<float>(table) / 255.0f, 0.02f) << i;
        }
    }
}

TEST(SunHours, PictureShowsTheTexelsHours) {
    // From above, the cube's top has all hours and the ground far away, north of it, some shade.
    const Scene scene = trace::make_scene({{trace::cube()}});
    const SunHoursResult result = hours_on_surface(scene, 0.1, on_day(kEquinox, 30.0));
    Progress silent;
    constexpr Extent kSize{64, 64};
    const Image picture = sun_hours_picture(scene, result, top_camera(scene, kSize), kSize, silent);
    EXPECT_GT(picture.width(), kSize.width) << "a legend";
    const double part = result.days.possible_h / std::ceil(result.days.possible_h - 1e-3);
    const Vec3 expected = bake::false_color(part);
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(picture.at(32, 32, channel), expected[channel], 1e-3f);
}

TEST(SunHours, AreThoseOfRaysInACity) {
    const char* const folder = std::getenv("GNOMON_SCENES");
    if (folder == nullptr) GTEST_SKIP() << "GNOMON_SCENES is not set";
    const auto file = std::filesystem::path(folder) / "delft-city-block" / "testarea.obj";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
    const Scene scene = load_scene(file.string(), {.up = UpAxis::z});
    const int different = expect_as_traced(scene, random_sensors(scene, 10'000),
                                           on_day(kEquinox, 5.0, {52.0, 4.37, 0.0}));
    RecordProperty("different", different);
}

// Clocks are put forward on 29 March: on each day they tell their own time.
TEST(SunHours, OfAZoneMindItsSummerTimeDayByDay) {
    const std::vector<SunSensor> open{{{0.0, 10.0, 0.0}, {0.0, 1.0, 0.0}}};
    const Scene scene = make_builtin_scene("cube");
    SunHoursOptions options = on_day(kEquinox, 30.0);
    options.time_zone = "Europe/Berlin";
    for (const auto& [date, offset] :
         {std::pair{2026y / March / 28, "+01:00"}, {2026y / March / 29, "+02:00"}}) {
        options.from = options.to = date;
        const std::string told = hours_at(scene, open, options).days.summary;
        EXPECT_NE(told.find(offset), std::string::npos) << told;
    }
    options.time_zone = "Europe/Berln";
    EXPECT_THROW(hours_at(scene, open, options), Error);
}

}  // namespace

}  // namespace gnomon
