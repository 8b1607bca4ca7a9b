#include "bake/sun_days.h"

#include "base/check.h"
#include "base/parallel.h"
#include "interval/path.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace gnomon::bake {

namespace {

using namespace std::chrono;

/// The sun takes two minutes to pass its own disc's width: finer steps have nothing to find. A day
/// of them fits one interval::DayPath.
constexpr double kMinStep_minutes = 2.0;
constexpr double kMaxStep_minutes = 60.0;
constexpr int kMaxEveryDays = 366;
constexpr double kMinHorizonDeg = -1.0;  // just below the almanac's; from there no light comes
constexpr double kMaxHorizonDeg = 18.0;

/// Days are grouped up to so many steps: masks are then filled, and the sun's declination differs
/// little within a group.
constexpr std::size_t kGroupSteps = 128;
static_assert(kGroupSteps <= interval::DayPath::kMaxSteps);

/// A day by itself.
struct Day {
    SunPath path;  ///< its steps are not used
    std::vector<DVec3> to_sun_ws;
    std::vector<double> hour_angles_deg;
    double step_h = 0.0;
};

void check(const SunHoursOptions& options) {
    if (!options.from.ok() || !options.to.ok() || sys_days(options.to) < sys_days(options.from)) {
        fail_input("sun hours: the period must begin and end on dates, in this order");
    }
    if (options.every_days < 1 || options.every_days > kMaxEveryDays) {
        fail_input("sun hours: every_days is {}; it must be 1 to {}", options.every_days,
                   kMaxEveryDays);
    }
    const double step = options.step_minutes;
    if (!(step >= kMinStep_minutes && step <= kMaxStep_minutes)) {
        fail_input("sun hours: step_minutes is {}; it must be {} to {}", step, kMinStep_minutes,
                   kMaxStep_minutes);
    }
    if (!(options.horizon_deg >= kMinHorizonDeg && options.horizon_deg <= kMaxHorizonDeg)) {
        fail_input("sun hours: horizon_deg is {}; it must be {} to {} degrees", options.horizon_deg,
                   kMinHorizonDeg, kMaxHorizonDeg);
    }
}

Day make_day(const SunHoursOptions& options, year_month_day date) {
    constexpr double kMinutesPerDay = 24.0 * 60.0;
    const SceneFrame frame{UpAxis::y, options.north_deg};
    Day day;
    const minutes utc_offset = options.time_zone.empty() ? options.utc_offset
                                                         : zone_utc_offset("sun hours: time_zone",
                                                                           options.time_zone, date);
    day.path = sun_path(options.place, date, utc_offset,
                        {.frame = frame, .horizon_deg = options.horizon_deg, .steps = 1});
    const SunTimes& times = day.path.times;
    if (day.path.steps.empty()) return day;
    const double daylight_minutes = std::min(times.daylight_s / 60.0, kMinutesPerDay);
    const int count =
        std::max(1, static_cast<int>(std::ceil(daylight_minutes / options.step_minutes)));
    day.step_h = times.daylight_s / 3600.0 / count;
    // An arc that does not begin with a sunrise begins 12 h before noon.
    const auto begin = times.sunrise ? times.sunrise->utc : day.path.noon.utc - 12h;
    for (const double offset_s : even_times(0.0, times.daylight_s, count, StepPlacement::middles)) {
        const milliseconds offset(std::llround(1000.0 * offset_s));
        const SunPosition sun = sun_position(options.place, {begin + offset, utc_offset},
                                             {.refraction = options.refraction});
        day.to_sun_ws.push_back(sky_direction_ws(sun.azimuth_deg, sun.elevation_deg, frame));
        day.hour_angles_deg.push_back(sun.hour_angle_deg);
    }
    return day;
}

std::vector<Day> make_days(const SunHoursOptions& options, Progress& progress) {
    const auto span = (sys_days(options.to) - sys_days(options.from)).count();
    std::vector<Day> days(static_cast<std::size_t>(span / options.every_days) + 1);
    parallel_for(
        days.size(), 1,
        [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const auto offset = std::chrono::days(static_cast<int>(i) * options.every_days);
                days[i] = make_day(options, sys_days(options.from) + offset);
            }
        },
        "finding the sun", &progress);
    return days;
}

DayGroup make_group(std::span<const Day> days) {
    DayGroup group;
    std::vector<double> hour_angles_deg;
    for (const Day& day : days) {
        group.to_sun_ws.insert(group.to_sun_ws.end(), day.to_sun_ws.begin(), day.to_sun_ws.end());
        hour_angles_deg.insert(hour_angles_deg.end(), day.hour_angles_deg.begin(),
                               day.hour_angles_deg.end());
    }
    std::vector<std::uint16_t> order(hour_angles_deg.size()), rank(order.size());
    std::iota(order.begin(), order.end(), std::uint16_t{0});
    std::ranges::stable_sort(order, {}, [&](std::uint16_t i) { return hour_angles_deg[i]; });
    const std::vector<DVec3> unsorted = group.to_sun_ws;
    for (std::size_t i = 0; i < order.size(); ++i) {
        group.to_sun_ws[i] = unsorted[order[i]];
        rank[order[i]] = static_cast<std::uint16_t>(i);
    }
    auto next = rank.begin();
    for (const Day& day : days) {
        const auto end = next + static_cast<std::ptrdiff_t>(day.to_sun_ws.size());
        group.days.push_back({day.step_h, {next, end}});
        next = end;
    }
    return group;
}

std::vector<DayGroup> make_groups(std::span<const Day> days) {
    std::vector<DayGroup> groups;
    while (!days.empty()) {
        std::size_t count = 1, steps = days[0].to_sun_ws.size();
        while (count < days.size() && steps + days[count].to_sun_ws.size() <= kGroupSteps)
            steps += days[count++].to_sun_ws.size();
        groups.push_back(make_group(days.first(count)));
        days = days.subspan(count);
    }
    return groups;
}

SunDays facts_of(const SunHoursOptions& options, std::span<const Day> days) {
    SunDays facts;
    facts.period = static_cast<int>((sys_days(options.to) - sys_days(options.from)).count()) + 1;
    facts.sampled = static_cast<int>(days.size());
    facts.shortest_h = 24.0;
    for (const Day& day : days) {
        const double daylight_h = day.path.times.daylight_s / 3600.0;
        facts.polar_days += day.path.times.daylight == Daylight::polar_day ? 1 : 0;
        facts.polar_nights += day.path.times.daylight == Daylight::polar_night ? 1 : 0;
        facts.step_minutes = std::max(facts.step_minutes, 60.0 * day.step_h);
        facts.possible_h += daylight_h / static_cast<double>(days.size());
        facts.shortest_h = std::min(facts.shortest_h, daylight_h);
        facts.longest_h = std::max(facts.longest_h, daylight_h);
    }
    if (days.size() == 1) {
        facts.summary = days[0].path.summary;
    } else {
        facts.summary = fmt::format("the sun is up for {:.2f} h a day, {:.2f} to {:.2f}",
                                    facts.possible_h, facts.shortest_h, facts.longest_h);
        if (facts.polar_nights > 0) {
            fmt::format_to(std::back_inserter(facts.summary), "; {} of {} days are polar night",
                           facts.polar_nights, facts.sampled);
        }
        if (facts.polar_days > 0) {
            fmt::format_to(std::back_inserter(facts.summary), "; {} of {} days are polar day",
                           facts.polar_days, facts.sampled);
        }
    }
    return facts;
}

}  // namespace

SunCalendar make_calendar(const SunHoursOptions& options, Progress& progress) {
    check(options);
    const std::vector<Day> days = make_days(options, progress);
    return {facts_of(options, days), days.front().path.pole_ws, make_groups(days)};
}

void HourSums::add(const DayGroup& group, interval::Mask lit) {
    const bool dark = std::ranges::all_of(lit, [](std::uint64_t word) { return word == 0; });
    for (const GroupedDay& day : group.days) {
        int steps = 0, run = 0, longest = 0;
        if (!dark) {
            for (const std::uint16_t step : day.steps) {
                run = interval::is_lit(lit, step) ? run + 1 : 0;
                steps += run > 0 ? 1 : 0;
                longest = std::max(longest, run);
            }
        }
        const auto step_h = static_cast<float>(day.step_h);
        add(static_cast<float>(steps) * step_h, static_cast<float>(longest) * step_h);
    }
}

void HourSums::add(float sun_h, float longest_h) {
    sun_h_ += sun_h;
    longest_h_ += longest_h;
    worst_h_ = any_ ? std::min(worst_h_, sun_h) : sun_h;
    longest_worst_h_ = any_ ? std::min(longest_worst_h_, longest_h) : longest_h;
    any_ = true;
}

SunHours HourSums::of_days(int sampled) const {
    const auto days = static_cast<float>(sampled);
    return {sun_h_ / days, worst_h_, longest_h_ / days, longest_worst_h_};
}

}  // namespace gnomon::bake
