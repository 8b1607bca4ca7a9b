#include <gnomon/error.h>
#include <gnomon/sun.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace gnomon {
namespace {

using namespace std::chrono;

const Place kMunich{48.137, 11.575, 520.0};
const Place kTromso{69.65, 18.96, 10.0};

SunPath path_of(const Place& place, const char* date, int utc_offset_h,
                const SunPathOptions& options = {}) {
    return sun_path(place, parse_date("date", date), hours(utc_offset_h), options);
}

/// Seconds of the local clock past 00:00 of `date`.
double local_s(const CivilTime& time, const char* date) {
    const auto midnight = sys_days(parse_date("date", date));
    return duration<double>(time.utc + time.utc_offset - midnight).count();
}

struct Published {
    const char* date;
    Place place;
    int utc_offset_h;
    double noon_s, sunrise_s, sunset_s, standard_sunrise_s, standard_sunset_s;
};

// By Skyfield 1.55 with DE421 (sun_test.cpp), seconds of the local clock past 00:00 of the date:
// almanac.find_transits(), then find_risings() and find_settings() in the half days around it, with
// horizon_degrees 0 and -0.8333.
constexpr Published kPublished[] = {
    {"2026-06-21", {48.137, 11.575, 520}, 2, 47730.6, 19183.3, 76277.7, 18807.2, 76653.9},
    {"2026-12-21", {48.137, 11.575, 520}, 1, 43904.9, 29244.4, 58565.0, 28873.8, 58935.6},
    {"2024-03-20", {-0.18, -78.47, 2850}, -5, 44467.4, 22872.5, 66062.0, 22672.6, 66262.0},
    {"1999-01-01", {-33.868, 151.209, 20}, 11, 46701.6, 21107.7, 72286.2, 20833.6, 72560.1},
    {"2010-06-21", {60.17, 24.94, 10}, 3, 48119.7, 14728.6, 81511.0, 14038.8, 82200.8},
    {"2025-06-21", {64.147, -21.94, 20}, 0, 48577.9, 11742.9, 85409.4, 10512.4, 86638.9},
    {"1965-06-21", {-54.8, -68.3, 10}, -3, 48890.8, 36394.3, 61387.3, 35921.0, 61860.6},
    {"2003-10-17",
     {39.742476, -105.1786, 1830.14},
     -7,
     42365.0,
     22630.0,
     62065.4,
     22364.3,
     62330.9},
    {"2030-09-01", {-13.83, -171.77, 2}, 13, 44834.7, 23741.7, 65938.3, 23533.5, 66146.5},
    {"2026-05-14", {69.65, 18.96, 10}, 2, 45629.2, 8429.5, 83194.0, 6788.2, 85007.9},
};

TEST(SunPath, RisesAndSetsWhenAnotherLibrarySaysSo) {
    // The sun climbs 0.00004 degrees, by which the positions differ, in 0.2 s where it rises as
    // flatly as in Tromso; Skyfield finds events to 0.1 s, and the table has that many digits.
    constexpr double kToleranceS = 0.4;
    for (const Published& row : kPublished) {
        SCOPED_TRACE(row.date);
        const SunPath path = path_of(row.place, row.date, row.utc_offset_h);
        EXPECT_NEAR(local_s(path.noon, row.date), row.noon_s, kToleranceS);
        ASSERT_TRUE(path.times.sunrise && path.times.sunset);
        EXPECT_NEAR(local_s(*path.times.sunrise, row.date), row.sunrise_s, kToleranceS);
        EXPECT_NEAR(local_s(*path.times.sunset, row.date), row.sunset_s, kToleranceS);
        EXPECT_EQ(path.geometric_times.sunrise->utc, path.times.sunrise->utc);
        ASSERT_TRUE(path.standard_times.sunrise && path.standard_times.sunset);
        // Skyfield was given -0.8333 for -0.83333 degrees.
        EXPECT_NEAR(local_s(*path.standard_times.sunrise, row.date), row.standard_sunrise_s,
                    kToleranceS);
        EXPECT_NEAR(local_s(*path.standard_times.sunset, row.date), row.standard_sunset_s,
                    kToleranceS);
    }
}

TEST(SunPath, StepsAreEvenAndPointToTheSun) {
    const SunPath path = path_of(kMunich, "2026-06-21", 2, {.steps = 10});
    ASSERT_EQ(path.steps.size(), 10u);
    const double part_s = path.times.daylight_s / 10.0;
    for (std::size_t i = 0; i < path.steps.size(); ++i) {
        const SunStep& step = path.steps[i];
        const double since_s = duration<double>(step.time.utc - path.times.sunrise->utc).count();
        EXPECT_NEAR(since_s, (static_cast<double>(i) + 0.5) * part_s, 0.001) << "a millisecond";
        const SunPosition sun = sun_position(kMunich, step.time);
        EXPECT_EQ(sun.azimuth_deg, step.sun.azimuth_deg);
        EXPECT_GT(step.sun.elevation_deg, 0.0);
        EXPECT_EQ(step.to_sun_ws, sky_direction_ws(sun.azimuth_deg, sun.elevation_deg));
        // Every step is as far from the pole as its declination says; 1e-9 rad are 0.0002 arc
        // seconds.
        EXPECT_NEAR(glm::dot(step.to_sun_ws, path.pole_ws),
                    std::sin(sun.declination_deg * std::acos(-1.0) / 180.0), 1e-9);
    }
}

TEST(SunPath, StepsAtTheEndsAreSunriseAndSunset) {
    const SunPath path =
        path_of(kMunich, "2026-06-21", 2, {.steps = 3, .placement = StepPlacement::ends});
    ASSERT_EQ(path.steps.size(), 3u);
    EXPECT_EQ(path.steps[0].time.utc, path.times.sunrise->utc);
    EXPECT_EQ(path.steps[2].time.utc, path.times.sunset->utc);
    // The sun climbs 15 arc seconds a second at most, and times are told to the millisecond.
    EXPECT_NEAR(path.steps[0].sun.elevation_deg, 0.0, 0.015 / 3600.0);
    EXPECT_NEAR(path.steps[2].sun.elevation_deg, 0.0, 0.015 / 3600.0);
}

TEST(SunPath, TurnsWithTheScene) {
    const SunPath plain = path_of(kMunich, "2026-06-21", 2);
    const SunPath turned = path_of(kMunich, "2026-06-21", 2, {.frame = {.north_deg = 90.0}});
    const SunPath z_up = path_of(kMunich, "2026-06-21", 2, {.frame = {.up = UpAxis::z}});
    for (std::size_t i = 0; i < plain.steps.size(); ++i) {
        const DVec3 p = plain.steps[i].to_sun_ws;
        EXPECT_LT(glm::length(turned.steps[i].to_sun_ws - DVec3(-p.z, p.y, p.x)), 1e-14);
        EXPECT_LT(glm::length(z_up.steps[i].to_sun_ws - DVec3(p.x, -p.z, p.y)), 1e-14);
    }
}

TEST(SunPath, PolarDayIsTheDayAroundNoon) {
    const SunPath path = path_of(kTromso, "2026-06-21", 2, {.steps = 48});
    EXPECT_EQ(path.times.daylight, Daylight::polar_day);
    EXPECT_FALSE(path.times.sunrise || path.times.sunset);
    EXPECT_EQ(path.times.daylight_s, 86400.0);
    ASSERT_EQ(path.steps.size(), 48u);
    double sum_h = 0.0;
    for (const SunStep& step : path.steps) {
        EXPECT_GT(step.sun.elevation_deg, 0.0);
        sum_h += duration<double, std::ratio<3600>>(step.time.utc - path.noon.utc).count();
    }
    EXPECT_NEAR(sum_h, 0.0, 0.001) << "as many before noon as after";
    EXPECT_NE(path.summary.find("polar day"), std::string::npos);
}

TEST(SunPath, PolarNightIsEmptyAndSaysSo) {
    const SunPath path = path_of(kTromso, "2026-12-21", 1);
    EXPECT_EQ(path.times.daylight, Daylight::polar_night);
    EXPECT_FALSE(path.times.sunrise || path.times.sunset);
    EXPECT_EQ(path.times.daylight_s, 0.0);
    EXPECT_TRUE(path.steps.empty());
    EXPECT_LT(path.noon_sun.elevation_deg, 0.0);
    EXPECT_NE(path.summary.find("polar night: the sun stays below 0 degrees all day"),
              std::string::npos);
}

TEST(SunPath, HorizonsDifferWhereThePolarNightBegins) {
    // The centre stays below the horizontal plane, but refraction and the sun's radius show its
    // limb.
    const SunPath path = path_of(kTromso, "2026-11-26", 1);
    EXPECT_EQ(path.times.daylight, Daylight::polar_night);
    EXPECT_EQ(path.standard_times.daylight, Daylight::day);
    const SunPath standard =
        path_of(kTromso, "2026-11-26", 1, {.horizon_deg = kStandardHorizonDeg, .steps = 5});
    EXPECT_EQ(standard.steps.size(), 5u);
}

TEST(SunPath, DaylightAcrossMidnightIsOneArc) {
    // Reykjavik's sun sets after midnight at its clock; the arc belongs to the date of its noon.
    const char* const date = "2026-06-21";
    const SunPath path =
        path_of({64.147, -21.94, 20.0}, date, 0, {.horizon_deg = kStandardHorizonDeg});
    ASSERT_TRUE(path.times.sunset);
    EXPECT_GT(local_s(*path.times.sunset, date), 86400.0);
    EXPECT_LT(local_s(*path.times.sunset, date), 90000.0);
    EXPECT_NEAR(path.times.daylight_s,
                local_s(*path.times.sunset, date) - local_s(*path.times.sunrise, date), 0.001);
}

TEST(SunPath, IsTheSameArcByAnyClockThatShowsItsNoonOnThatDate) {
    const Place sydney{-33.868, 151.209, 20.0};
    const SunPath own = path_of(sydney, "1999-01-01", 11);
    const SunPath utc = path_of(sydney, "1999-01-01", 0);  // noon at 01:58
    EXPECT_EQ(own.times.sunrise->utc, utc.times.sunrise->utc);
    EXPECT_EQ(own.times.sunset->utc, utc.times.sunset->utc);
    EXPECT_LT(local_s(*utc.times.sunrise, "1999-01-01"), 0.0) << "on the day before";
    // A clock so odd that it shows that noon on the day before.
    const SunPath odd = path_of(sydney, "1999-01-01", -3);
    EXPECT_NEAR(duration<double>(odd.noon.utc - own.noon.utc).count(), 86400.0, 40.0);
}

TEST(SunPath, EveryDateHasItsOwnNoonAtAnyOffset) {
    for (int offset_h = -18; offset_h <= 18; ++offset_h) {
        const SunPath first = path_of(kMunich, "2026-02-11", offset_h, {.steps = 1});
        const SunPath second = path_of(kMunich, "2026-02-12", offset_h, {.steps = 1});
        EXPECT_GE(local_s(first.noon, "2026-02-11"), 0.0);
        EXPECT_LT(local_s(first.noon, "2026-02-11"), 86400.0 + 30.0);
        EXPECT_NEAR(duration<double>(second.noon.utc - first.noon.utc).count(), 86400.0, 30.0);
        EXPECT_NEAR(first.noon_sun.hour_angle_deg, 0.0, 0.001 * 15.0 / 3600.0) << "a millisecond";
    }
}

TEST(SunPath, AtThePoleTheSunRisesOnceAYear) {
    const Place pole{90.0, 0.0, 0.0};
    EXPECT_EQ(path_of(pole, "2026-06-21", 0).times.daylight, Daylight::polar_day);
    EXPECT_EQ(path_of(pole, "2026-12-21", 0).times.daylight, Daylight::polar_night);
    // The equinox of 2026 is on March 20 at 14:46 UTC. The sun climbs 1' an hour and its parallax
    // is 0.15', so that the centre rises 9 minutes after; almanacs round to a minute.
    const SunPath path = path_of(pole, "2026-03-20", 0);
    EXPECT_EQ(path.times.daylight, Daylight::day);
    ASSERT_TRUE(path.times.sunrise);
    EXPECT_FALSE(path.times.sunset);
    EXPECT_NEAR(local_s(*path.times.sunrise, "2026-03-20"), (14 * 60 + 46 + 9) * 60.0, 90.0);
    EXPECT_NE(path.summary.find("sunset none"), std::string::npos);
}

TEST(SunPath, NamesWhatIsOutOfRange) {
    const auto error = [](const SunPathOptions& options) -> std::string {
        try {
            path_of(kMunich, "2026-06-21", 2, options);
        } catch (const Error& e) {
            return e.what();
        }
        return {};
    };
    EXPECT_EQ(error({.steps = 0}), "steps is 0; it must be 1 to 100000");
    EXPECT_EQ(error({.horizon_deg = 40.0}), "horizon_deg is 40; it must be -18 to 18 degrees");
    EXPECT_NE(error({.frame = {.north_deg = NAN}}).find("north_deg is nan"), std::string::npos);
    EXPECT_THROW(sun_path(kMunich, year(2026) / 6 / 21, hours(19)), Error);
    EXPECT_THROW(sun_path(kMunich, year(2026) / 2 / 30, hours(1)), Error);
    EXPECT_NO_THROW(sun_path(kMunich, year(1900) / 1 / 1, hours(1)));
    EXPECT_NO_THROW(sun_path(kMunich, year(2099) / 12 / 31, hours(-12)));
}

}  // namespace
}  // namespace gnomon
