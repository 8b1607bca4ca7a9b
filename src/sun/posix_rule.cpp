// Compiled as C++17, as date/ptz.h of 3.0.1 (Debian 12) and later takes hh_mm_ss for its own, which
// in C++20 is std::chrono's as well.
#include "sun/posix_rule.h"

#include <date/ptz.h>

namespace gnomon::solar {

std::chrono::seconds rule_utc_offset(const std::string& rule, std::int64_t local_s) {
    const date::local_seconds time{std::chrono::seconds(local_s)};
    return Posix::time_zone(rule).get_info(time).first.offset;
}

}  // namespace gnomon::solar
