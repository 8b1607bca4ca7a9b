#pragma once

#include <gnomon/light.h>
#include <gnomon/light_path.h>
#include <gnomon/math.h>
#include <gnomon/scene.h>

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Where the sun stands, from a place and a time. docs/sun.md tells how accurate it is and why.
namespace gnomon {

/// A place on the Earth, on the ellipsoid WGS84 (what GPS gives).
struct Place {
    double latitude_deg = 0.0;   ///< north is positive, -90 to 90
    double longitude_deg = 0.0;  ///< east is positive, -180 to 180
    double height_m = 0.0;       ///< above the sea, -500 to 10000
};

/// A moment, and the clock that tells it. Days have 86400 s: there are no leap seconds to name.
struct CivilTime {
    std::chrono::sys_time<std::chrono::milliseconds> utc{};
    std::chrono::minutes utc_offset{0};  ///< local clock minus UTC, -18 h to 18 h
};

/// The moment when a clock `utc_offset` ahead of UTC shows `since_midnight` on `date`.
/// Throws Error{input} for a date that does not exist or lies outside 1900 to 2099, and for an
/// offset beyond 18 h.
CivilTime civil_time(std::chrono::year_month_day date, std::chrono::milliseconds since_midnight,
                     std::chrono::minutes utc_offset);

/// "2003-10-17T12:30:30-07:00", rounded to whole seconds.
std::string to_string(const CivilTime& time);

/// Air that bends the sun's light.
struct Atmosphere {
    double pressure_hpa = 1010.0;  ///< at the place itself, 0 to 1200
    double temperature_c = 10.0;   ///< -90 to 60
};

struct SunOptions {
    /// Air to look through. None: where the sun is, not where it seems to be.
    std::optional<Atmosphere> refraction;
    /// UT1 - UTC, what the Earth's rotation is ahead of the clock, -1 to 1 s. Published by the
    /// IERS; 0 turns the sky by less than 0.9 s = 13.5 arc seconds too much or too little.
    double dut1_s = 0.0;
};

/// The sun's centre as seen from a place.
struct SunPosition {
    double azimuth_deg = 0.0;      ///< clockwise from north, 0 to 360
    double elevation_deg = 0.0;    ///< above the horizontal plane, -90 to 90, refraction included
    double refraction_deg = 0.0;   ///< how much of elevation_deg is refraction, >= 0
    double declination_deg = 0.0;  ///< of the true equator, without refraction
    double hour_angle_deg = 0.0;   ///< past the meridian, west is positive, -180 to 180
    double distance_m = 0.0;
    double angular_diameter_deg = 0.0;

    double zenith_deg() const { return 90.0 - elevation_deg; }
};

/// The apparent place of the sun's centre for an eye at `place`: with light time, aberration,
/// precession, nutation and the parallax of the place. At a pole, north is the direction in which
/// the meridian of `longitude_deg` would lead on.
/// Throws Error{input} when a member is out of range or the local year is not 1900 to 2099.
SunPosition sun_position(const Place& place, const CivilTime& time, const SunOptions& options = {});

/// How the sky lies on a scene.
struct SceneFrame {
    UpAxis up = UpAxis::y;
    /// Azimuth of true north in the scene, clockwise seen from above, -360 to 360. With 0, north is
    /// -Z and east is +X (up = y), or north is +Y and east is +X (up = z).
    double north_deg = 0.0;
};

/// Unit vector, in the scene's frame, towards a point of the sky.
DVec3 sky_direction_ws(double azimuth_deg, double elevation_deg, const SceneFrame& frame = {});

/// The sun as a light: direction and disc from `position`, irradiance as sun() has it.
DirectionalLight sun_light(const SunPosition& position, const SceneFrame& frame = {});

enum class Daylight {
    day,          ///< the sun rises or sets
    polar_day,    ///< up all day
    polar_night,  ///< not up at all
};

/// Elevation of the sun's centre, without refraction, at which the upper limb of a mean sun touches
/// the horizon in mean air: 34' of refraction and 16' of radius. What almanacs call sunrise.
inline constexpr double kStandardHorizonDeg = -50.0 / 60.0;

struct SunPathOptions {
    SunOptions sun;  ///< refraction bends the steps' directions, not the horizon's
    SceneFrame frame;
    /// Elevation of the sun's centre, without refraction, where daylight begins and ends, -18
    /// to 18. 0 suits bakes: no light comes from below the horizontal plane. kStandardHorizonDeg is
    /// the almanac's.
    double horizon_deg = 0.0;
    int steps = 24;  ///< 1 to 100000
    StepPlacement placement = StepPlacement::middles;
};

/// Daylight above one horizon. Without value: the sun does not cross it there.
struct SunTimes {
    Daylight daylight = Daylight::day;
    std::optional<CivilTime> sunrise, sunset;
    double daylight_s = 0.0;  ///< length of the arc
};

struct SunStep {
    CivilTime time;
    SunPosition sun;
    DVec3 to_sun_ws{0.0};  ///< unit vector in the scene's frame
};

/// One day's arc of the sun.
struct SunPath {
    CivilTime noon;  ///< the sun's upper transit of the meridian
    SunPosition noon_sun;
    SunTimes times;              ///< at SunPathOptions::horizon_deg
    SunTimes geometric_times;    ///< at 0: the sun's centre in the horizontal plane
    SunTimes standard_times;     ///< at kStandardHorizonDeg
    DVec3 pole_ws{0.0};          ///< the sky's north pole, about which the sun's hour circles turn
    std::vector<SunStep> steps;  ///< in order of time; empty in a polar night
    /// What the path has to say in words: times, or why there are none. One line.
    std::string summary;
};

/// The daylight around the solar noon of `date`: the first noon at or after local 00:00, and the
/// arc through the highest point of the 24 h around it, whatever date its ends fall on. A polar day
/// is those 24 h. Near a pole an arc can begin or end with the 24 h, without a sunrise or a sunset.
/// Throws Error{input} as sun_position does, and for steps or a horizon out of range.
SunPath sun_path(const Place& place, std::chrono::year_month_day date,
                 std::chrono::minutes utc_offset, const SunPathOptions& options = {});

// ---- From text. `flag` begins every message: what the user calls the value. All throw
// Error{input}.

/// "48.137,11.575" or "48.137,11.575,520": degrees north, degrees east, metres.
Place parse_place(std::string_view flag, std::string_view text);

/// "2026-06-21". Dates that do not exist are errors.
std::chrono::year_month_day parse_date(std::string_view flag, std::string_view text);

/// "Z", "+02:00", "-0330" or "+2". Names of zones are no offsets: they need a date.
std::chrono::minutes parse_utc_offset(std::string_view flag, std::string_view text);

/// Whether a text is meant as an offset: anything but a name.
bool is_utc_offset(std::string_view text);

/// What clocks of a zone of the IANA database, such as "Europe/Berlin", are ahead of UTC at their
/// noon of `date`, in whole minutes. On a day on which they are put forward or back, at night, that
/// is what they show while it is light. Suggests the nearest name for one that is none; throws
/// Error{machine} when the machine has no such database.
std::chrono::minutes zone_utc_offset(std::string_view flag, std::string_view zone,
                                     std::chrono::year_month_day date);

/// An offset, or a zone's on that date.
std::chrono::minutes clock_utc_offset(std::string_view flag, std::string_view text,
                                      std::chrono::year_month_day date);

/// "2003-10-17T12:30:30-07:00"; seconds and their fraction may be left out, and the offset too when
/// there is one to use `otherwise`.
CivilTime parse_time(std::string_view flag, std::string_view text,
                     std::optional<std::chrono::minutes> otherwise = {});

/// The whole hour nearest to the sun's own time at `place`: what to take, and to tell, when no
/// offset is given. Zones and summer time are politics, so clocks there may differ.
std::chrono::minutes nearest_utc_offset(const Place& place);

/// "+02:00".
std::string utc_offset_text(std::chrono::minutes utc_offset);

}  // namespace gnomon
