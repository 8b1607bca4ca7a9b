#pragma once

#include <gnomon/sun.h>

// Not `sun`, which is a function.
namespace gnomon::solar {

// Of the ephemeris (erfa's eraEpv00); the days around them, which paths reach into, are as good.
inline constexpr int kFirstYear = 1900;
inline constexpr int kLastYear = 2099;

inline constexpr std::chrono::minutes kMaxUtcOffset{18 * 60};

inline constexpr double kMinHeightM = -500.0;  // below the shores of the Dead Sea
inline constexpr double kMaxHeightM = 10000.0;

using Instant = std::chrono::sys_time<std::chrono::milliseconds>;

/// Each throws Error{input} naming the member, its value and its range.
void require_place(const Place& place);
void require_date(std::chrono::year_month_day date);
void require_utc_offset(std::chrono::minutes utc_offset);
void require_options(const SunOptions& options);

/// sun_position for members that are known to be in range.
SunPosition position_at(const Place& place, Instant utc, const SunOptions& options);

}  // namespace gnomon::solar
