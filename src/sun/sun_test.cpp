#include <gnomon/error.h>
#include <gnomon/sun.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace gnomon {
namespace {

using namespace std::chrono;

// Shortest way around the circle, degrees.
double turn_deg(double a_deg, double b_deg) {
    return std::remainder(a_deg - b_deg, 360.0);
}

SunPosition sun_at(const char* time, const Place& place, const SunOptions& options = {}) {
    return sun_position(place, parse_time("time", time), options);
}

std::string error_of(const Place& place, const SunOptions& options = {}) {
    try {
        sun_at("2026-06-21T12:00Z", place, options);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    return {};
}

// I. Reda and A. Andreas, "Solar position algorithm for solar radiation applications", 2004, the
// worked example of its appendix. Their algorithm is within 0.0003 degrees of the Astronomical
// Almanac. Their difference of terrestrial and universal time, 67 s, is 2.8 s more than what
// leap seconds give: 0.00003 degrees.
TEST(SunPosition, IsThatOfTheSolarPositionAlgorithmsExample) {
    constexpr double kTheirErrorDeg = 0.0003;
    const SunPosition sun =
        sun_at("2003-10-17T12:30:30-07:00", {39.742476, -105.1786, 1830.14},
               {.refraction = Atmosphere{.pressure_hpa = 820.0, .temperature_c = 11.0}});
    EXPECT_NEAR(sun.zenith_deg(), 50.11162, kTheirErrorDeg);
    EXPECT_NEAR(sun.azimuth_deg, 194.34024, kTheirErrorDeg);
    EXPECT_NEAR(sun.declination_deg, -9.316179, kTheirErrorDeg);
    EXPECT_NEAR(sun.hour_angle_deg, 11.10629, kTheirErrorDeg);
    // Of the geocentre; the place is at most the Earth's radius, 4.3e-5 au, nearer.
    EXPECT_NEAR(sun.distance_m / 149597870700.0, 0.9965422974, 4.3e-5);
}

struct Published {
    const char* ut1;
    double latitude_deg, longitude_deg, height_m;
    double azimuth_deg, elevation_deg, hour_angle_deg, declination_deg, distance_au;
};

// By Skyfield 1.55 (B. Rhodes) with the ephemeris DE421 of the Jet Propulsion Laboratory, which
// share no code and no numbers with ERFA but the IAU's models:
//     t = timescale.ut1(year, month, day, hour, minute, second)
//     p = (earth + wgs84.latlon(latitude, longitude, height)).at(t).observe(sun).apparent()
//     p.altaz(), p.hadec()
// Dates and places are drawn at random along the years and from pole to pole.
constexpr Published kPublished[] = {
    {"1950-02-24T12:30:09Z", 90, -25.3, 35, 158.89221, -9.55949, -21.10779, -9.55949, 0.9898091},
    {"1954-01-13T17:58:18Z", 89.5, -120.95, 0, 146.54282, -21.06429, -33.56465, -21.48118,
     0.9835903},
    {"1958-09-18T11:17:49Z", 80, -141.43, 0, 29.65671, -6.73397, -150.54898, 1.97034, 1.0047020},
    {"1962-02-09T06:59:01Z", 78.22, -66.84, 5640, 36.79176, -24.39707, -145.65682, -14.80125,
     0.9867043},
    {"1966-05-07T05:19:18Z", 69.65, -9.43, 5640, 66.82546, 9.33599, -108.73526, 16.68673,
     1.0090665},
    {"1970-10-11T21:24:32Z", 66.5, 64.06, 0, 32.26264, -27.47530, -151.49250, -7.11987, 0.9980390},
    {"1974-04-16T08:05:59Z", 60.17, -16.89, 0, 97.71673, 15.94584, -75.37349, 10.02664, 1.0035977},
    {"1978-05-01T09:36:45Z", 55.75, 178.91, 5640, 324.19633, -12.98032, 143.82738, 15.01788,
     1.0076689},
    {"1982-09-07T13:27:38Z", 51.48, 24.32, 5640, 237.13777, 30.48232, 46.71526, 6.06494, 1.0075936},
    {"1986-08-06T07:19:16Z", 48.137, 8.88, 520, 98.92773, 30.46683, -62.77928, 16.75912, 1.0142853},
    {"1990-01-15T20:17:33Z", 40.71, -151.66, 0, 150.05337, 22.35940, -29.64997, -21.05826,
     0.9836610},
    {"1994-08-23T10:09:43Z", 35.68, 170.37, 3400, 315.51505, -30.84431, 142.13303, 11.44979,
     1.0111782},
    {"1998-07-07T20:40:28Z", 23.44, -51.82, 0, 286.65774, 20.00731, 77.06476, 22.53362, 1.0166519},
    {"2002-06-14T23:37:20Z", 10, 1.08, 0, 352.24656, -56.39948, 175.33773, 23.28936, 1.0157660},
    {"2006-02-27T01:45:14Z", 0, -49.77, 35, 251.68199, -62.12444, 153.33766, -8.45008, 0.9903785},
    {"2010-10-20T07:07:21Z", 0, 1.85, 5640, 101.15609, 22.08792, -67.52863, -10.32797, 0.9957669},
    {"2014-08-01T01:22:44Z", -1.29, -63.64, 35, 293.84873, -43.18231, 135.45137, 18.06862,
     1.0150417},
    {"2018-12-22T10:01:20Z", -12.05, -125.86, 35, 145.58545, -46.98998, -155.15432, -23.43310,
     0.9836738},
    {"2022-03-25T20:26:55Z", -23.5, 9.4, 35, 250.81526, -41.18877, 134.66682, 2.05200, 0.9973497},
    {"2026-10-07T14:18:08Z", -33.87, -129.04, 35, 95.50350, 1.94003, -91.45742, -5.65009,
     0.9994783},
    {"2030-10-06T10:36:00Z", -41.29, -16.12, 520, 49.61778, 42.78666, -34.14983, -5.21937,
     0.9997509},
    {"2034-08-06T11:50:51Z", -54.8, 58.11, 0, 308.57664, 5.08759, 54.34368, 16.59240, 1.0142927},
    {"2038-10-04T14:13:27Z", -66.6, 57.72, 35, 264.60890, 2.60527, 93.91626, -4.53059, 1.0003656},
    {"2042-01-02T01:47:10Z", -77.85, -43.73, 0, 196.78566, 11.30916, 162.09507, -22.91105,
     0.9833099},
    {"2046-01-18T15:37:15Z", -89.5, -81.93, 1830, 30.32187, 20.84617, -30.22697, -20.41435,
     0.9838268},
    {"2049-02-27T16:18:49Z", -90, 30.66, 0, 267.76510, 8.00099, 92.23490, -8.00099, 0.9904429},
};

TEST(SunPosition, IsThatOfAnotherLibraryAndEphemerisInAllYearsAndLatitudes) {
    // 0.13 arc seconds, by which the sun moves in 3.2 s: leap seconds stand here for the difference
    // of terrestrial and universal time, which Skyfield has as measured, 3.2 s less in 1950. And
    // 0.05 arc seconds between the models.
    constexpr double kToleranceDeg = (0.13 + 0.05) / 3600.0;
    constexpr double kToleranceAu = 1.5e-7;  // the table's rounding, and 15 km
    for (const Published& row : kPublished) {
        SCOPED_TRACE(row.ut1);
        const SunPosition sun =
            sun_at(row.ut1, {row.latitude_deg, row.longitude_deg, row.height_m});
        // Azimuths matter as little as they are near the zenith, so as arcs on the sky.
        const double azimuth_deg = turn_deg(sun.azimuth_deg, row.azimuth_deg) *
                                   std::cos(radians(static_cast<float>(row.elevation_deg)));
        EXPECT_NEAR(azimuth_deg, 0.0, kToleranceDeg);
        EXPECT_NEAR(sun.elevation_deg, row.elevation_deg, kToleranceDeg);
        EXPECT_NEAR(turn_deg(sun.hour_angle_deg, row.hour_angle_deg), 0.0, kToleranceDeg);
        EXPECT_NEAR(sun.declination_deg, row.declination_deg, kToleranceDeg);
        EXPECT_NEAR(sun.distance_m / 149597870700.0, row.distance_au, kToleranceAu);
    }
}

TEST(SunPosition, IsOverheadAtTheEquatorsEquinoxNoon) {
    // The equinox is at 03:06 UTC, noon then at 135.24 degrees east, where the equation of time is
    // -7.4 minutes: both to half of the last digit.
    const SunPosition sun = sun_at("2024-03-20T03:06:30Z", {0.0, 135.24, 0.0});
    EXPECT_NEAR(sun.declination_deg, 0.0, 0.5 / 60.0) << "1 arc minute an hour";
    EXPECT_NEAR(sun.hour_angle_deg, 0.0, 0.05 / 60.0 * 15.0);
    // Parallax, 8.8 arc seconds, is nothing overhead.
    EXPECT_NEAR(sun.elevation_deg, 90.0, 0.02);
}

TEST(SunPosition, AtThePolesGoesAroundAtTheElevationOfTheDeclination) {
    for (const int hour : {0, 6, 12, 18}) {
        const std::string time =
            "2026-06-21T" + std::string(hour < 10 ? "0" : "") + std::to_string(hour) + ":00:00Z";
        const SunPosition north = sun_at(time.c_str(), {90.0, 0.0, 0.0});
        const SunPosition south = sun_at(time.c_str(), {-90.0, 0.0, 0.0});
        EXPECT_NEAR(north.elevation_deg, north.declination_deg, 1e-9);
        EXPECT_NEAR(south.elevation_deg, -south.declination_deg, 1e-9);
        // The meridian of Greenwich goes on northwards to that of 180 degrees.
        EXPECT_NEAR(turn_deg(north.azimuth_deg, 180.0 + north.hour_angle_deg), 0.0, 1e-9);
    }
}

TEST(SunPosition, IsLargerAndNearerInJanuary) {
    const SunPosition january = sun_at("2026-01-04T12:00Z", {});
    const SunPosition july = sun_at("2026-07-04T12:00Z", {});
    // Explanatory Supplement to the Astronomical Almanac: 32'32" and 31'28", for a radius of 696000
    // km to be rounded to arc seconds.
    constexpr double kSecondDeg = 1.0 / 3600.0;
    EXPECT_NEAR(january.angular_diameter_deg, (32.0 + 32.0 / 60.0) / 60.0, 2.0 * kSecondDeg);
    EXPECT_NEAR(july.angular_diameter_deg, (31.0 + 28.0 / 60.0) / 60.0, 2.0 * kSecondDeg);
    EXPECT_LT(january.distance_m, july.distance_m);
}

TEST(SunPosition, UniversalTimeTurnsTheSky) {
    const Place place{48.137, 11.575, 520.0};
    const double late = sun_at("2026-06-21T10:00:00Z", place, {.dut1_s = 0.9}).hour_angle_deg;
    const double plain = sun_at("2026-06-21T10:00:00Z", place).hour_angle_deg;
    // 15.041 arc seconds a second, as the stars: terrestrial time, by which the sun moves, stands.
    EXPECT_NEAR((late - plain) * 3600.0, 0.9 * 15.041, 0.001);
}

TEST(SunPosition, RefractionLiftsTheSunUntilItsDiscIsSet) {
    const Place place{48.137, 11.575, 520.0};
    const SunOptions air{.refraction = Atmosphere{}};
    const SunPosition set = sun_at("2026-06-21T21:11:17+02:00", place, air);
    const SunPosition geometric = sun_at("2026-06-21T21:11:17+02:00", place);
    EXPECT_NEAR(geometric.elevation_deg, 0.0, 0.01) << "sunset, to the second";
    // Of a body that stands in the horizon, 1.02' / tan(10.3 / 5.11 degrees); 0.1' is 0.01 degrees'
    // part.
    EXPECT_NEAR(set.refraction_deg, 28.98 / 60.0, 0.1 / 60.0);
    EXPECT_EQ(set.elevation_deg, geometric.elevation_deg + set.refraction_deg);
    EXPECT_EQ(sun_at("2026-06-21T23:00:00+02:00", place, air).refraction_deg, 0.0);
    EXPECT_EQ(geometric.refraction_deg, 0.0);
}

TEST(SunPosition, NamesWhatIsOutOfRange) {
    EXPECT_NE(error_of({91.0, 0.0, 0.0}).find("latitude_deg is 91; it must be -90 to 90"),
              std::string::npos);
    EXPECT_NE(error_of({0.0, 181.0, 0.0}).find("longitude_deg is 181"), std::string::npos);
    EXPECT_NE(error_of({0.0, 0.0, NAN}).find("height_m is nan"), std::string::npos);
    EXPECT_NE(error_of({}, {.dut1_s = 2.0}).find("dut1_s is 2; it must be -1 to 1"),
              std::string::npos);
    EXPECT_NE(error_of({}, {.refraction = Atmosphere{.pressure_hpa = -1.0}}).find("pressure_hpa"),
              std::string::npos);
    EXPECT_NE(error_of({}, {.refraction = Atmosphere{.temperature_c = -273.0}}).find("-90 to 60"),
              std::string::npos);
    EXPECT_THROW(sun_position({}, CivilTime{sys_days(year(2100) / 1 / 1), minutes(0)}), Error);
    // 1900 has begun there, though not at Greenwich.
    EXPECT_NO_THROW(
        sun_position({}, CivilTime{sys_days(year(1899) / 12 / 31) + hours(23), hours(2)}));
}

TEST(SkyDirection, TurnsWithTheScenesNorth) {
    const auto expect_near = [](DVec3 a, DVec3 b) { EXPECT_LT(glm::length(a - b), 1e-15); };
    expect_near(sky_direction_ws(0.0, 0.0), {0.0, 0.0, -1.0});
    expect_near(sky_direction_ws(90.0, 0.0), {1.0, 0.0, 0.0});
    expect_near(sky_direction_ws(0.0, 90.0), {0.0, 1.0, 0.0});
    expect_near(sky_direction_ws(0.0, 0.0, {.north_deg = 90.0}), {1.0, 0.0, 0.0});
    expect_near(sky_direction_ws(0.0, 0.0, {.up = UpAxis::z}), {0.0, 1.0, 0.0});
    expect_near(sky_direction_ws(90.0, 0.0, {.up = UpAxis::z}), {1.0, 0.0, 0.0});
    expect_near(sky_direction_ws(0.0, 90.0, {.up = UpAxis::z}), {0.0, 0.0, 1.0});
}

TEST(SunLight, IsTheSunOfThatDirectionAndSize) {
    const SunPosition position = sun_at("2026-01-04T12:00+01:00", {48.137, 11.575, 520.0});
    const DirectionalLight light = sun_light(position);
    const DirectionalLight same =
        sun(radians(static_cast<float>(position.elevation_deg)),
            radians(static_cast<float>(position.azimuth_deg)), light.angular_diameter_rad);
    constexpr float kFloatError = 1e-6f;  // of an angle of some radians in float
    EXPECT_LT(glm::length(light.to_light_ws - same.to_light_ws), kFloatError);
    EXPECT_EQ(light.irradiance, same.irradiance);
    EXPECT_NEAR(light.angular_diameter_rad, radians(32.53f / 60.0f), radians(0.03f / 60.0f));
    EXPECT_NO_THROW(validate(Light(light)));
}

}  // namespace
}  // namespace gnomon
