// What clocks of a place's zone show, by the machine's copy of the IANA time zone database, read by
// H. Hinnant's library: https://github.com/HowardHinnant/date.
#include <gnomon/sun.h>

#include "base/check.h"
#include "base/file.h"
#include "base/text.h"
#include "sun/posix_rule.h"
#include "sun/solar.h"

#include <date/tz.h>

#include <algorithm>
#include <cctype>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

namespace gnomon {

namespace {

using namespace std::chrono;

const date::tzdb& database(std::string_view flag, std::string_view name) {
    try {
        const date::tzdb& found = date::get_tzdb();
        if (!found.zones.empty()) return found;
    } catch (const std::exception&) {
    }
    fail_machine(
        "{}: \"{}\": this machine has no time zones: install its package tzdata, or give an "
        "offset such as +02:00",
        flag, name);
}

std::string lower_case(std::string_view text) {
    std::string lower(text);
    std::ranges::transform(lower, lower.begin(), [](char c) {
        return c == ' ' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    });
    return lower;
}

/// The likely zone for what is none: letters of any case and a city alone are understood here.
std::string suggested(std::string_view name, const date::tzdb& zones) {
    const std::string wanted = lower_case(name);
    std::vector<std::string> whole, cities;
    for (const date::time_zone& zone : zones.zones) {
        whole.push_back(lower_case(zone.name()));
        cities.push_back(whole.back().substr(whole.back().rfind('/') + 1));
    }
    for (const std::vector<std::string>* words : {&whole, &cities}) {
        const std::vector<std::string_view> candidates(words->begin(), words->end());
        const std::string_view nearest = nearest_name(wanted, candidates);
        if (nearest.empty()) continue;
        const auto at = std::ranges::find(candidates, nearest) - candidates.begin();
        return fmt::format(", did you mean \"{}\"?",
                           zones.zones[static_cast<std::size_t>(at)].name());
    }
    return {};
}

const date::time_zone& find_zone(std::string_view flag, std::string_view name) {
    const date::tzdb& zones = database(flag, name);
    const auto found = std::ranges::find(zones.zones, name, &date::time_zone::name);
    if (found == zones.zones.end()) {
        fail_input(
            "{}: \"{}\" is no time zone{}; give a name such as Europe/Berlin, or a UTC offset of "
            "-18:00 to +18:00, such as +02:00, or Z for UTC",
            flag, name, suggested(name, zones));
    }
    return *found;
}

/// The rule that ends the zone's file (RFC 9636): of all times after the last change that it lists,
/// which the library takes for the last. Files of many systems list changes until 2037.
std::string rule_of(const date::time_zone& zone) {
    constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 20;
    const auto path = std::filesystem::path("/usr/share/zoneinfo") / zone.name();
    const std::vector<std::uint8_t> bytes = read_file(path, kMaxFileBytes);
    std::string text(bytes.begin(), bytes.end());
    if (!text.ends_with('\n')) return {};
    text.pop_back();
    return text.substr(text.rfind('\n') + 1);
}

seconds offset_at(const date::time_zone& zone, date::local_seconds noon) {
    constexpr sys_days kNoChange = 2200y / January / 1;  // beyond all that is listed
    const date::sys_info listed = zone.get_info(noon).first;
    if (listed.end < kNoChange) return listed.offset;
    const std::string rule = rule_of(zone);
    if (rule.empty()) return listed.offset;
    return solar::rule_utc_offset(rule, noon.time_since_epoch().count());
}

}  // namespace

minutes zone_utc_offset(std::string_view flag, std::string_view zone, year_month_day date) {
    solar::require_date(date);
    const date::local_seconds noon((sys_days(date) + 12h).time_since_epoch());
    const date::time_zone& found = find_zone(flag, zone);
    try {
        return round<minutes>(offset_at(found, noon));
    } catch (const std::exception& error) {
        fail_machine("{}: \"{}\": this machine's time zones cannot be read: {}", flag, zone,
                     error.what());
    }
}

}  // namespace gnomon
