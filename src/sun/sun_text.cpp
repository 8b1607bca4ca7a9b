// Places, dates, times and offsets as people write them: ISO 8601 where it has a form for it.
#include "base/check.h"
#include "sun/solar.h"

#include <cctype>
#include <charconv>
#include <cmath>

namespace gnomon {

namespace {

using namespace std::chrono;

/// What is left to read of a text. Readers return nothing and move nowhere when it is not there.
class Reader {
public:
    explicit Reader(std::string_view text) : rest_(text) {}

    bool empty() const { return rest_.empty(); }

    bool take(char c) {
        if (!rest_.starts_with(c)) return false;
        rest_.remove_prefix(1);
        return true;
    }

    /// Exactly `count` digits.
    std::optional<int> digits(std::size_t count) {
        if (rest_.size() < count) return std::nullopt;
        int value = 0;
        for (const char c : rest_.substr(0, count)) {
            if (c < '0' || c > '9') return std::nullopt;
            value = 10 * value + (c - '0');
        }
        rest_.remove_prefix(count);
        return value;
    }

    /// One digit or more, as a fraction of 1.
    std::optional<double> fraction() {
        double value = 0.0;
        double weight = 0.1;
        bool any = false;
        for (; !rest_.empty() && rest_[0] >= '0' && rest_[0] <= '9'; rest_.remove_prefix(1)) {
            value += weight * (rest_[0] - '0');
            weight *= 0.1;
            any = true;
        }
        return any ? std::optional(value) : std::nullopt;
    }

    std::string_view rest() const { return rest_; }

private:
    std::string_view rest_;
};

[[noreturn]] void fail_date(std::string_view flag, std::string_view text) {
    fail_input("{}: \"{}\" is not YEAR-MONTH-DAY, such as 2026-06-21", flag, text);
}

double number_of(std::string_view flag, std::string_view text, std::string_view piece,
                 std::string_view what, double min, double max) {
    double value = 0.0;
    const char* const end = piece.data() + piece.size();
    const auto [stop, error] = std::from_chars(piece.data(), end, value);
    if (piece.empty() || error != std::errc{} || stop != end) {
        fail_input(
            "{}: \"{}\": \"{}\" is no {}; write LATITUDE,LONGITUDE[,HEIGHT], such as "
            "48.137,11.575,520",
            flag, text, piece, what);
    }
    if (!(value >= min && value <= max)) {
        fail_input("{}: {} {} is out of range; {} to {} is allowed", flag, what, piece, min, max);
    }
    return value;
}

std::optional<minutes> read_offset(Reader& reader) {
    if (reader.take('Z') || reader.take('z')) return minutes(0);
    const bool west = reader.take('-');
    if (!west && !reader.take('+')) return std::nullopt;
    std::optional<int> hour = reader.digits(2);
    if (!hour) hour = reader.digits(1);
    if (!hour) return std::nullopt;
    int minute = 0;
    if (reader.take(':') || !reader.empty()) {
        const std::optional<int> read = reader.digits(2);
        if (!read || *read >= 60) return std::nullopt;
        minute = *read;
    }
    const minutes offset = hours(*hour) + minutes(minute);
    if (!reader.empty() || offset > solar::kMaxUtcOffset) return std::nullopt;
    return west ? -offset : offset;
}

year_month_day read_date(Reader& reader, std::string_view flag, std::string_view text) {
    const std::optional<int> y = reader.digits(4);
    if (!y || !reader.take('-')) fail_date(flag, text);
    const std::optional<int> m = reader.digits(2);
    if (!m || !reader.take('-')) fail_date(flag, text);
    const std::optional<int> d = reader.digits(2);
    if (!d) fail_date(flag, text);
    const year_month_day date{year(*y), month(static_cast<unsigned>(*m)),
                              day(static_cast<unsigned>(*d))};
    if (!date.year().ok() || !date.month().ok()) {
        fail_input("{}: \"{}\" does not exist: months are 01 to 12", flag, text);
    }
    const auto last = static_cast<unsigned>((date.year() / date.month() / std::chrono::last).day());
    if (!date.ok()) {
        fail_input("{}: \"{}\" does not exist: {:04}-{:02} has the days 01 to {}", flag, text, *y,
                   *m, last);
    }
    if (*y < solar::kFirstYear || *y > solar::kLastYear) {
        fail_input("{}: \"{}\" is out of range; years {} to {} are allowed", flag, text,
                   solar::kFirstYear, solar::kLastYear);
    }
    return date;
}

// Hours, minutes and, if given, seconds with a fraction.
std::optional<milliseconds> read_clock(Reader& reader) {
    const std::optional<int> hour = reader.digits(2);
    if (!hour || *hour > 23 || !reader.take(':')) return std::nullopt;
    const std::optional<int> minute = reader.digits(2);
    if (!minute || *minute > 59) return std::nullopt;
    double second = 0.0;
    if (reader.take(':')) {
        const std::optional<int> whole = reader.digits(2);
        if (!whole || *whole > 59) return std::nullopt;
        second = *whole;
        if (reader.take('.')) {
            const std::optional<double> part = reader.fraction();
            if (!part) return std::nullopt;
            second += *part;
        }
    }
    return hours(*hour) + minutes(*minute) + milliseconds(std::llround(second * 1000.0));
}

}  // namespace

CivilTime civil_time(year_month_day date, milliseconds since_midnight, minutes utc_offset) {
    solar::require_date(date);
    solar::require_utc_offset(utc_offset);
    return {sys_days(date) + since_midnight - utc_offset, utc_offset};
}

std::string utc_offset_text(minutes utc_offset) {
    const auto size = std::abs(utc_offset.count());
    return fmt::format("{}{:02}:{:02}", utc_offset.count() < 0 ? '-' : '+', size / 60, size % 60);
}

std::string to_string(const CivilTime& time) {
    const auto local = round<seconds>(time.utc + time.utc_offset);
    const auto midnight = floor<days>(local);
    const year_month_day date{midnight};
    const hh_mm_ss<seconds> clock(local - midnight);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}{}", static_cast<int>(date.year()),
                       static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                       clock.hours().count(), clock.minutes().count(), clock.seconds().count(),
                       utc_offset_text(time.utc_offset));
}

Place parse_place(std::string_view flag, std::string_view text) {
    std::vector<std::string_view> pieces;
    for (std::size_t start = 0; start <= text.size();) {
        const std::size_t end = std::min(text.find(',', start), text.size());
        pieces.push_back(text.substr(start, end - start));
        start = end + 1;
    }
    if (pieces.size() < 2 || pieces.size() > 3) {
        fail_input(
            "{}: \"{}\" is not LATITUDE,LONGITUDE[,HEIGHT] in degrees north, degrees east "
            "and metres, such as 48.137,11.575,520",
            flag, text);
    }
    Place place;
    place.latitude_deg = number_of(flag, text, pieces[0], "latitude", -90.0, 90.0);
    place.longitude_deg = number_of(flag, text, pieces[1], "longitude", -180.0, 180.0);
    if (pieces.size() == 3) {
        place.height_m =
            number_of(flag, text, pieces[2], "height", solar::kMinHeightM, solar::kMaxHeightM);
    }
    return place;
}

year_month_day parse_date(std::string_view flag, std::string_view text) {
    Reader reader(text);
    const year_month_day date = read_date(reader, flag, text);
    if (!reader.empty()) fail_date(flag, text);
    return date;
}

minutes parse_utc_offset(std::string_view flag, std::string_view text) {
    Reader reader(text);
    const std::optional<minutes> offset = read_offset(reader);
    if (!offset) {
        fail_input(
            "{}: \"{}\" is no UTC offset; -18:00 to +18:00 is allowed, such as +02:00, or Z "
            "for UTC",
            flag, text);
    }
    return *offset;
}

bool is_utc_offset(std::string_view text) {
    const bool is_letter = !text.empty() && std::isalpha(static_cast<unsigned char>(text[0])) != 0;
    return !is_letter || text == "Z" || text == "z";
}

minutes clock_utc_offset(std::string_view flag, std::string_view text, year_month_day date) {
    return is_utc_offset(text) ? parse_utc_offset(flag, text) : zone_utc_offset(flag, text, date);
}

CivilTime parse_time(std::string_view flag, std::string_view text,
                     std::optional<minutes> otherwise) {
    Reader reader(text);
    const year_month_day date = read_date(reader, flag, text);
    const bool separated = reader.take('T') || reader.take('t') || reader.take(' ');
    const std::optional<milliseconds> clock = separated ? read_clock(reader) : std::nullopt;
    if (!clock) {
        fail_input(
            "{}: \"{}\" is no time; write a date, T and 00:00:00 to 23:59:59, such as "
            "2003-10-17T12:30:30-07:00",
            flag, text);
    }
    if (reader.empty() && !otherwise) {
        fail_input("{}: \"{}\" has no UTC offset; add one, such as {}+02:00, or Z for UTC", flag,
                   text, text);
    }
    return civil_time(date, *clock,
                      reader.empty() ? *otherwise : parse_utc_offset(flag, reader.rest()));
}

minutes nearest_utc_offset(const Place& place) {
    solar::require_place(place);
    constexpr double kDegPerHour = 15.0;
    return hours(std::lround(place.longitude_deg / kDegPerHour));
}

}  // namespace gnomon
