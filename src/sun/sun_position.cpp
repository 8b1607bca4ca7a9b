// The sun's apparent place, by the routines of ERFA (the IAU's SOFA under another licence): the
// Earth from X. Moisson and P. Bretagnon, "Analytical Planetary solution VSOP2000", 2001,
// precession and nutation IAU 2006/2000A, the Earth's rotation angle. They are put together here
// because ERFA's own chain (eraAtco13) is for stars: the sun is so near that parallax and light
// time are the place's. Left out: polar motion (0.5 arc seconds at most) and the bending of light,
// which the sun's own is not.
//
// Refraction: T. Saemundsson, "Atmospheric Refraction", Sky and Telescope 72, 1986, after G. G.
// Bennett, 1982, with the weight of air as in I. Reda and A. Andreas, "Solar position algorithm for
// solar radiation applications", 2004. Departure: it is never negative, as the formula is by 0.1
// arc seconds near the zenith. ERFA's own ends above the horizon.
#include "base/check.h"
#include "sun/solar.h"

#include <erfa.h>
#include <erfam.h>

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

using namespace std::chrono;

// IAU 2015, resolution B3: the nominal solar radius.
constexpr double kSunRadiusM = 6.957e8;

constexpr double kDegPerRad = ERFA_DR2D;
constexpr double kRadPerDeg = ERFA_DD2R;
constexpr double kSecondsPerDay = ERFA_DAYSEC;
constexpr double kJulianDateOf1970 = 2440587.5;
constexpr double kMaxDut1S = 1.0;  // UTC is kept within 0.9 s

struct Scales {
    double day = 0.0;  // Julian date of 0h UTC
    double ut1 = 0.0;  // fractions of a day past it
    double tt = 0.0;
};

// Before 1960 UTC has no defined distance to atomic time and ERFA's table gives 0. The sum is then
// wrong by up to 35 s (in 1900), in which the sun moves 1.5 arc seconds among the stars.
Scales scales_at(solar::Instant utc, double dut1_s) {
    const auto midnight = floor<days>(utc);
    const year_month_day date{midnight};
    double tai_minus_utc_s = 0.0;
    eraDat(static_cast<int>(date.year()), static_cast<int>(static_cast<unsigned>(date.month())),
           static_cast<int>(static_cast<unsigned>(date.day())), 0.0, &tai_minus_utc_s);
    const double utc_s = duration<double>(utc - midnight).count();
    return {.day = kJulianDateOf1970 + static_cast<double>(midnight.time_since_epoch().count()),
            .ut1 = (utc_s + dut1_s) / kSecondsPerDay,
            .tt = (utc_s + tai_minus_utc_s + ERFA_TTMTAI) / kSecondsPerDay};
}

// Degrees; formula and limits as given by Reda and Andreas.
double refraction_deg(double elevation_deg, const Atmosphere& air) {
    // With the whole disc below the horizon nothing is left to see.
    constexpr double kLowestDeg = -(0.26667 + 0.5667);
    if (elevation_deg < kLowestDeg) return 0.0;
    const double mean_deg =
        1.02 / (60.0 * std::tan(kRadPerDeg * (elevation_deg + 10.3 / (elevation_deg + 5.11))));
    return std::max(0.0,
                    air.pressure_hpa / 1010.0 * 283.0 / (273.0 + air.temperature_c) * mean_deg);
}

// What ERFA needs to know of the Earth and the place. Also the sun's centre, au from the
// barycentre, and its velocity, au a day.
eraASTROM astrometry_at(const Place& place, const Scales& scales, double sun_au[2][3]) {
    double earth_from_sun[2][3];
    double earth[2][3];
    eraEpv00(scales.day, scales.tt, earth_from_sun, earth);
    eraPvmpv(earth, earth_from_sun, sun_au);

    double celestial_from_gcrs[3][3];
    eraPnm06a(scales.day, scales.tt, celestial_from_gcrs);
    double x = 0.0;
    double y = 0.0;
    eraBpn2xy(celestial_from_gcrs, &x, &y);
    eraASTROM astrom;
    eraApco(scales.day, scales.tt, earth, earth_from_sun[0], x, y,
            eraS06(scales.day, scales.tt, x, y), eraEra00(scales.day, scales.ut1),
            place.longitude_deg * kRadPerDeg, place.latitude_deg * kRadPerDeg, place.height_m, 0.0,
            0.0, eraSp00(scales.day, scales.tt), 0.0, 0.0, &astrom);
    return astrom;
}

}  // namespace

namespace solar {

void require_place(const Place& place) {
    const auto require = [](std::string_view member, double value, double min, double max,
                            std::string_view unit) {
        if (!(value >= min && value <= max)) {
            fail_input("place: {} is {}; it must be {} to {} {}", member, value, min, max, unit);
        }
    };
    require("latitude_deg", place.latitude_deg, -90.0, 90.0, "degrees north");
    require("longitude_deg", place.longitude_deg, -180.0, 180.0, "degrees east");
    require("height_m", place.height_m, kMinHeightM, kMaxHeightM, "metres");
}

void require_date(year_month_day date) {
    const int year = static_cast<int>(date.year());
    const unsigned month = static_cast<unsigned>(date.month());
    const unsigned day = static_cast<unsigned>(date.day());
    if (!date.ok()) fail_input("date: {}-{:02}-{:02} does not exist", year, month, day);
    if (year < kFirstYear || year > kLastYear) {
        fail_input("date: {}-{:02}-{:02} is out of range; years are {} to {}", year, month, day,
                   kFirstYear, kLastYear);
    }
}

void require_utc_offset(minutes utc_offset) {
    if (utc_offset < -kMaxUtcOffset || utc_offset > kMaxUtcOffset) {
        fail_input("utc_offset is {} minutes; it must be {} to {}", utc_offset.count(),
                   -kMaxUtcOffset.count(), kMaxUtcOffset.count());
    }
}

void require_options(const SunOptions& options) {
    if (!(std::abs(options.dut1_s) <= kMaxDut1S)) {
        fail_input("dut1_s is {}; it must be -{} to {} s", options.dut1_s, kMaxDut1S, kMaxDut1S);
    }
    if (!options.refraction) return;
    const auto [pressure_hpa, temperature_c] = *options.refraction;
    if (!(pressure_hpa >= 0.0 && pressure_hpa <= 1200.0)) {
        fail_input("refraction: pressure_hpa is {}; it must be 0 to 1200 hPa", pressure_hpa);
    }
    if (!(temperature_c >= -90.0 && temperature_c <= 60.0)) {
        fail_input("refraction: temperature_c is {}; it must be -90 to 60 degrees", temperature_c);
    }
}

SunPosition position_at(const Place& place, Instant utc, const SunOptions& options) {
    const Scales scales = scales_at(utc, options.dut1_s);
    double sun_au[2][3];
    eraASTROM astrom = astrometry_at(place, scales, sun_au);

    // Where the sun was when its light left; the light's way is at first taken from where it is
    // now.
    double to_sun[3];
    double distance_au = astrom.em;
    eraPpsp(sun_au[0], -distance_au * ERFA_AULT / kSecondsPerDay, sun_au[1], to_sun);
    eraPmp(to_sun, astrom.eb, to_sun);
    double natural[3];
    eraPn(to_sun, &distance_au, natural);

    double proper[3];
    eraAb(natural, astrom.v, astrom.em, astrom.bm1, proper);
    double intermediate[3];
    eraRxp(astrom.bpn, proper, intermediate);
    double ascension = 0.0;
    double declination = 0.0;
    eraC2s(intermediate, &ascension, &declination);

    double azimuth = 0.0;
    double zenith = 0.0;
    double hour_angle = 0.0;
    double observed_ascension = 0.0;
    eraAtioq(ascension, declination, &astrom, &azimuth, &zenith, &hour_angle, &declination,
             &observed_ascension);

    SunPosition position;
    position.azimuth_deg = eraAnp(azimuth) * kDegPerRad;
    position.elevation_deg = 90.0 - zenith * kDegPerRad;
    if (options.refraction) {
        position.refraction_deg = refraction_deg(position.elevation_deg, *options.refraction);
        position.elevation_deg += position.refraction_deg;
    }
    position.declination_deg = declination * kDegPerRad;
    position.hour_angle_deg = eraAnpm(hour_angle) * kDegPerRad;
    position.distance_m = distance_au * ERFA_DAU;
    position.angular_diameter_deg = 2.0 * std::asin(kSunRadiusM / position.distance_m) * kDegPerRad;
    return position;
}

}  // namespace solar

SunPosition sun_position(const Place& place, const CivilTime& time, const SunOptions& options) {
    solar::require_place(place);
    solar::require_utc_offset(time.utc_offset);
    solar::require_date(year_month_day{floor<days>(time.utc + time.utc_offset)});
    solar::require_options(options);
    return solar::position_at(place, time.utc, options);
}

DVec3 sky_direction_ws(double azimuth_deg, double elevation_deg, const SceneFrame& frame) {
    const double azimuth = (azimuth_deg + frame.north_deg) * kRadPerDeg;
    const double elevation = elevation_deg * kRadPerDeg;
    const double east = std::cos(elevation) * std::sin(azimuth);
    const double north = std::cos(elevation) * std::cos(azimuth);
    const double up = std::sin(elevation);
    return frame.up == UpAxis::y ? DVec3(east, up, -north) : DVec3(east, north, up);
}

DirectionalLight sun_light(const SunPosition& position, const SceneFrame& frame) {
    DirectionalLight light =
        sun(0.0f, 0.0f, static_cast<float>(position.angular_diameter_deg * kRadPerDeg));
    light.to_light_ws = Vec3(sky_direction_ws(position.azimuth_deg, position.elevation_deg, frame));
    return light;
}

}  // namespace gnomon
