#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace gnomon::solar {

/// What clocks are ahead of UTC by a rule such as "CET-1CEST,M3.5.0,M10.5.0/3" (POSIX.1, TZ) when
/// they show a time, given in seconds since 1970. Throws std::exception for what is no rule.
std::chrono::seconds rule_utc_offset(const std::string& rule, std::int64_t local_s);

}  // namespace gnomon::solar
