// Points from CSV as spreadsheets write it: quotes as in RFC 4180, and between values its comma, or
// a semicolon or a tab.

#include <gnomon/sun_hours.h>

#include "base/check.h"
#include "base/file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

namespace gnomon {

namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 30;
constexpr std::array<std::string_view, 6> kColumns = {"x", "y", "z", "nx", "ny", "nz"};
constexpr std::size_t kPlaceColumns = 3;  ///< the rest are of the normal
constexpr std::size_t kMostTold = 60;     ///< bytes of a line or a value, in an error
constexpr std::string_view kLineIs = "a line is x,y,z,nx,ny,nz, or x,y,z to face up";
constexpr std::string_view kHeadingIs = "columns are x, y, z, and nx, ny, nz or none of these";

/// What the values of lines are, by their numbers in kColumns.
using Columns = std::vector<std::size_t>;

bool is_space(unsigned char c) {
    return std::isspace(c) != 0;
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_space(static_cast<unsigned char>(text.front())))
        text.remove_prefix(1);
    while (!text.empty() && is_space(static_cast<unsigned char>(text.back())))
        text.remove_suffix(1);
    return text;
}

std::string beginning(std::string_view text) {
    if (text.size() <= kMostTold) return std::string(text);
    std::size_t end = kMostTold;
    while (end > 0 && (static_cast<unsigned char>(text[end]) >> 6) == 2)
        --end;  // not within a letter of UTF-8
    return std::string(text.substr(0, end)) + "..";
}

/// A line and where it is, for errors.
struct Line {
    std::string_view name, text;
    std::size_t number;

    [[noreturn]] void fail(std::string_view fault, std::string_view mend) const {
        fail_input("{}, line {}: {} in: {}; {}", name, number, fault, beginning(text), mend);
    }
};

/// What is between values: a comma only where there is nothing else, because in files with others
/// it is a decimal point.
char separator_of(std::string_view text) {
    bool quoted = false;
    char found = ',';
    for (const char c : text) {
        if (c == '"') quoted = !quoted;
        if (quoted) continue;
        if (c == ';') return c;
        if (c == '\t') found = c;
    }
    return found;
}

/// Takes a value in quotes, which begins `rest`, from it.
std::string take_quoted(const Line& line, std::string_view& rest) {
    std::string value;
    for (std::size_t i = 1; i < rest.size(); ++i) {
        if (rest[i] != '"') {
            value += rest[i];
        } else if (i + 1 < rest.size() && rest[i + 1] == '"') {
            value += rest[++i];
        } else {
            rest.remove_prefix(i + 1);
            return value;
        }
    }
    line.fail("a quote is not closed", "end it with \"");
}

std::vector<std::string> values_of(const Line& line) {
    const char separator = separator_of(line.text);
    std::vector<std::string> values;
    std::string_view rest = line.text;
    for (bool more = true; more;) {
        while (!rest.empty() && rest.front() == ' ')
            rest.remove_prefix(1);
        const bool quoted = rest.starts_with('"');
        std::string value = quoted ? take_quoted(line, rest) : std::string();
        const std::size_t end = std::min(rest.find(separator), rest.size());
        const std::string_view plain = trimmed(rest.substr(0, end));
        if (quoted && !plain.empty())
            line.fail("there is more after a quote",
                      "put the whole value in quotes, or none of it");
        values.emplace_back(quoted ? trimmed(value) : plain);
        more = end < rest.size();
        rest.remove_prefix(more ? end + 1 : end);
    }
    return values;
}

std::optional<std::size_t> column_of(std::string value) {
    std::ranges::transform(value, value.begin(), [](unsigned char c) { return std::tolower(c); });
    const auto found = std::ranges::find(kColumns, value);
    if (found == kColumns.end()) return std::nullopt;
    return static_cast<std::size_t>(found - kColumns.begin());
}

/// The columns that a heading names; nothing when the line is none, and names no column.
Columns heading_of(const Line& line, const std::vector<std::string>& values) {
    if (std::ranges::none_of(values, [](const auto& v) { return column_of(v).has_value(); }))
        return {};
    Columns columns;
    for (const std::string& value : values) {
        const auto column = column_of(value);
        if (!column) line.fail(fmt::format("\"{}\" is no column", beginning(value)), kHeadingIs);
        if (std::ranges::find(columns, *column) != columns.end())
            line.fail(fmt::format("\"{}\" is there twice", value), kHeadingIs);
        columns.push_back(*column);
    }
    const auto places = std::ranges::count_if(columns, [](auto c) { return c < kPlaceColumns; });
    const bool whole = columns.size() == kPlaceColumns || columns.size() == kColumns.size();
    if (places != kPlaceColumns || !whole) line.fail("columns are missing", kHeadingIs);
    return columns;
}

double number_of(const Line& line, std::string_view value) {
    std::string_view digits = value;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    double number = 0.0;
    const char* const end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, number);
    if (error != std::errc{} || stop != end || !std::isfinite(number)) {
        const bool comma = value.find(',') != std::string_view::npos;
        line.fail(fmt::format("\"{}\" is no finite number", beginning(value)),
                  comma ? "decimals take a point, as in 1.5" : kLineIs);
    }
    return number;
}

/// `columns`: of the heading, or empty.
SunSensor sensor_of(const Line& line, const std::vector<std::string>& values,
                    const Columns& columns, DVec3 up) {
    const std::size_t count = values.size();
    const bool whole = columns.empty() ? count == kPlaceColumns || count == kColumns.size()
                                       : count == columns.size();
    std::array<double, kColumns.size()> numbers{};
    for (std::size_t i = 0; i < std::min(count, kColumns.size()); ++i)
        numbers[columns.empty() || !whole ? i : columns[i]] = number_of(line, values[i]);
    if (!whole) {
        line.fail(fmt::format("there are {} values", count),
                  columns.empty() ? std::string(kLineIs)
                                  : fmt::format("the heading names {}", columns.size()));
    }
    const DVec3 position(numbers[0], numbers[1], numbers[2]);
    if (count == kPlaceColumns) return {position, up};
    const DVec3 normal(numbers[3], numbers[4], numbers[5]);
    if (!(glm::length(normal) > 0.0))
        line.fail("the normal 0,0,0 faces nowhere", "give it any length but 0");
    return {position, normal};
}

}  // namespace

std::vector<SunSensor> parse_sun_sensors(std::string_view text, std::string_view name, DVec3 up) {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
    std::vector<SunSensor> sensors;
    Columns columns;
    bool is_first = true;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const Line line{name, trimmed(text.substr(0, end)), number};
        text.remove_prefix(std::min(end + 1, text.size()));
        if (line.text.empty() || line.text.starts_with('#')) continue;
        const std::vector<std::string> values = values_of(line);
        if (is_first) columns = heading_of(line, values);
        if (!is_first || columns.empty()) sensors.push_back(sensor_of(line, values, columns, up));
        is_first = false;
    }
    if (sensors.empty()) fail_input("{}: has no points; {}", name, kLineIs);
    return sensors;
}

std::vector<SunSensor> read_sun_sensors(const std::filesystem::path& path, DVec3 up) {
    const std::vector<std::uint8_t> bytes = read_file(path, kMaxFileBytes);
    return parse_sun_sensors({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                             path.string(), up);
}

}  // namespace gnomon
