#pragma once

#include <gnomon/progress.h>
#include <gnomon/sun_hours.h>

#include "interval/mask.h"

#include <cstdint>
#include <vector>

namespace gnomon::bake {

/// A day's steps among those of its group.
struct GroupedDay {
    double step_h = 0.0;               ///< what each step stands for
    std::vector<std::uint16_t> steps;  ///< numbers in the group, in order of time
};

/// Days that are baked together. Their steps are sorted by the sun's hour angle, so that the paths
/// of neighbouring days are nearly one circle with more steps.
struct DayGroup {
    std::vector<DVec3> to_sun_ws;
    std::vector<GroupedDay> days;  ///< polar nights have no steps
};

/// The steps of a period.
struct SunCalendar {
    SunDays days;
    DVec3 pole_ws{0.0};
    std::vector<DayGroup> groups;
};

/// Throws Error{input} for options out of range, Error{cancelled}.
SunCalendar make_calendar(const SunHoursOptions& options, Progress& progress);

/// A point's hours, day after day.
class HourSums {
public:
    /// The lit steps of a group's days.
    void add(const DayGroup& group, interval::Mask lit);
    SunHours of_days(int sampled) const;

private:
    void add(float sun_h, float longest_h);

    float sun_h_ = 0.0f, worst_h_ = 0.0f;
    float longest_h_ = 0.0f, longest_worst_h_ = 0.0f;
    bool any_ = false;
};

}  // namespace gnomon::bake
