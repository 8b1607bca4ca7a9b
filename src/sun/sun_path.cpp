// A day's arc of the sun: noon by Newton's method on the hour angle, the arc's ends by bisection of
// the elevation. Near the poles, where declination moves the sun as much as the Earth's rotation
// does, noon is not the highest point and days are no symmetric arcs; so the 24 h around noon are
// searched.
#include "base/check.h"
#include "sun/solar.h"

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

using namespace std::chrono;
using solar::Instant;

constexpr milliseconds kDay = hours(24);
// A stretch of the sun's way in which it is not missed: it stays within 0.0003 degrees of its
// highest point for 10 minutes where it turns slowest, 1 degree from the pole.
constexpr milliseconds kSearchStep = minutes(10);
constexpr double kMaxHorizonDeg = 18.0;  // the astronomer's night
constexpr int kMaxSteps = 100000;

milliseconds to_milliseconds(double seconds) {
    return milliseconds(std::llround(seconds * 1000.0));
}

class Day {
public:
    Day(const Place& place, const SunOptions& options, Instant local_midnight)
        : place_(place), options_{.refraction = {}, .dut1_s = options.dut1_s} {
        noon_ = noon_after(local_midnight);
        for (Instant t = noon_ - kDay / 2; t <= noon_ + kDay / 2; t += kSearchStep) {
            samples_.push_back({t, elevation_deg(t)});
        }
    }

    Instant noon() const { return noon_; }

    struct Arc {
        Daylight daylight = Daylight::polar_night;
        Instant begin, end;
        bool rises = false, sets = false;
    };

    Arc arc_above(double horizon_deg) const {
        const auto highest = std::max_element(
            samples_.begin(), samples_.end(),
            [](const Sample& a, const Sample& b) { return a.elevation_deg < b.elevation_deg; });
        if (highest->elevation_deg <= horizon_deg) return {.begin = noon_, .end = noon_};

        const auto is_down = [&](const Sample& s) { return s.elevation_deg <= horizon_deg; };
        const auto up_end = std::find_if(highest, samples_.end(), is_down);
        const auto up_begin =
            std::find_if(std::make_reverse_iterator(highest), samples_.rend(), is_down).base();
        Arc arc{Daylight::polar_day, samples_.front().time, samples_.back().time};
        arc.rises = up_begin != samples_.begin();
        arc.sets = up_end != samples_.end();
        if (arc.rises) arc.begin = crossing((up_begin - 1)->time, up_begin->time, horizon_deg);
        if (arc.sets) arc.end = crossing(up_end->time, (up_end - 1)->time, horizon_deg);
        if (arc.rises || arc.sets) arc.daylight = Daylight::day;
        return arc;
    }

private:
    struct Sample {
        Instant time;
        double elevation_deg;
    };

    double elevation_deg(Instant t) const {
        return solar::position_at(place_, t, options_).elevation_deg;
    }

    // The first upper transit at or after `t`.
    Instant noon_after(Instant t) const {
        // Days from noon to noon differ from 24 h by 30 s, so three steps reach the millisecond.
        constexpr int kNewtonSteps = 3;
        const auto turns = [&](Instant at) {
            return solar::position_at(place_, at, options_).hour_angle_deg / 360.0;
        };
        const double passed = turns(t);
        Instant noon = t + to_milliseconds((passed > 0.0 ? 1.0 - passed : -passed) * 86400.0);
        for (int i = 0; i < kNewtonSteps; ++i) {
            noon -= to_milliseconds(turns(noon) * 86400.0);
        }
        return noon;
    }

    // The first millisecond next to `down` that is up.
    Instant crossing(Instant down, Instant up, double horizon_deg) const {
        while (std::abs((up - down).count()) > 1) {
            const Instant middle = down + (up - down) / 2;
            (elevation_deg(middle) > horizon_deg ? up : down) = middle;
        }
        return up;
    }

    Place place_;
    SunOptions options_;  // without refraction
    Instant noon_;
    std::vector<Sample> samples_;
};

SunTimes times_of(const Day::Arc& arc, minutes utc_offset) {
    SunTimes times;
    times.daylight = arc.daylight;
    times.daylight_s = duration<double>(arc.end - arc.begin).count();
    if (arc.rises) times.sunrise = CivilTime{arc.begin, utc_offset};
    if (arc.sets) times.sunset = CivilTime{arc.end, utc_offset};
    return times;
}

std::string summary_of(const SunPath& path, double horizon_deg) {
    const std::string where = fmt::format("{:.3g} degrees", horizon_deg);
    const std::string noon = fmt::format("solar noon {} at {:.2f} degrees", to_string(path.noon),
                                         path.noon_sun.elevation_deg);
    if (path.times.daylight == Daylight::polar_night) {
        return fmt::format("polar night: the sun stays below {} all day; {}", where, noon);
    }
    if (path.times.daylight == Daylight::polar_day) {
        return fmt::format("polar day: the sun stays above {} all day; {}", where, noon);
    }
    const auto text = [](const std::optional<CivilTime>& time) {
        return time ? to_string(*time) : std::string("none within 12 h of noon");
    };
    return fmt::format("sunrise {}, sunset {} (centre at {}); {}", text(path.times.sunrise),
                       text(path.times.sunset), where, noon);
}

void require_path_options(const SunPathOptions& options) {
    solar::require_options(options.sun);
    if (!(std::abs(options.horizon_deg) <= kMaxHorizonDeg)) {
        fail_input("horizon_deg is {}; it must be -{} to {} degrees", options.horizon_deg,
                   kMaxHorizonDeg, kMaxHorizonDeg);
    }
    if (options.steps < 1 || options.steps > kMaxSteps) {
        fail_input("steps is {}; it must be 1 to {}", options.steps, kMaxSteps);
    }
    if (!(std::abs(options.frame.north_deg) <= 360.0)) {
        fail_input("north_deg is {}; it must be -360 to 360 degrees", options.frame.north_deg);
    }
}

}  // namespace

SunPath sun_path(const Place& place, year_month_day date, minutes utc_offset,
                 const SunPathOptions& options) {
    solar::require_place(place);
    const CivilTime midnight = civil_time(date, {}, utc_offset);
    require_path_options(options);

    const Day day(place, options.sun, midnight.utc);
    const Day::Arc arc = day.arc_above(options.horizon_deg);
    SunPath path;
    path.noon = {day.noon(), utc_offset};
    path.noon_sun = solar::position_at(place, day.noon(), options.sun);
    path.times = times_of(arc, utc_offset);
    path.geometric_times = times_of(day.arc_above(0.0), utc_offset);
    path.standard_times = times_of(day.arc_above(kStandardHorizonDeg), utc_offset);
    path.pole_ws = sky_direction_ws(0.0, place.latitude_deg, options.frame);
    path.summary = summary_of(path, options.horizon_deg);
    if (arc.daylight == Daylight::polar_night) return path;

    for (const double s :
         even_times(0.0, path.times.daylight_s, options.steps, options.placement)) {
        SunStep step;
        step.time = {arc.begin + to_milliseconds(s), utc_offset};
        step.sun = solar::position_at(place, step.time.utc, options.sun);
        step.to_sun_ws =
            sky_direction_ws(step.sun.azimuth_deg, step.sun.elevation_deg, options.frame);
        path.steps.push_back(step);
    }
    return path;
}

}  // namespace gnomon
