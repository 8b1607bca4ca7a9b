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
#include <span>
#include <string>

namespace gnomon {

namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 30;
constexpr std::size_t kMostTold = 60;  ///< bytes of a line or a value, in an error
constexpr std::size_t kPlaceColumns = 3;
constexpr std::size_t kMostColumns = 9;
constexpr std::size_t kMaxPlanes = 1000;  ///< pictures look for each pixel's

/// What lines hold: all columns, or the first of them, a place, alone.
struct Format {
    std::span<const std::string_view> columns;
    bool place_alone;
    std::string_view things, line_is, heading_is;
};

constexpr std::array<std::string_view, 6> kSensorColumns = {"x", "y", "z", "nx", "ny", "nz"};
constexpr Format kSensors{.columns = kSensorColumns,
                          .place_alone = true,
                          .things = "points",
                          .line_is = "a line is x,y,z,nx,ny,nz, or x,y,z to face up",
                          .heading_is = "columns are x, y, z, and nx, ny, nz or none of these"};
constexpr std::array<std::string_view, 9> kPlaneColumns = {"x",  "y",  "z",  "ux", "uy",
                                                           "uz", "vx", "vy", "vz"};
constexpr Format kPlanes{.columns = kPlaneColumns,
                         .place_alone = false,
                         .things = "planes",
                         .line_is = "a line is x,y,z,ux,uy,uz,vx,vy,vz, a corner and two edges",
                         .heading_is = "columns are x, y, z, ux, uy, uz, vx, vy, vz"};

/// What the values of lines are, by their numbers in Format::columns.
using Columns = std::vector<std::size_t>;
using Numbers = std::array<double, kMostColumns>;

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

std::optional<std::size_t> column_of(const Format& format, std::string value) {
    std::ranges::transform(value, value.begin(), [](unsigned char c) { return std::tolower(c); });
    const auto found = std::ranges::find(format.columns, value);
    if (found == format.columns.end()) return std::nullopt;
    return static_cast<std::size_t>(found - format.columns.begin());
}

bool is_whole(const Format& format, std::size_t count) {
    return count == format.columns.size() || (format.place_alone && count == kPlaceColumns);
}

/// The columns that a heading names; nothing when the line is none, and names no column.
Columns heading_of(const Format& format, const Line& line, const std::vector<std::string>& values) {
    if (std::ranges::none_of(values,
                             [&](const auto& v) { return column_of(format, v).has_value(); }))
        return {};
    Columns columns;
    for (const std::string& value : values) {
        const auto column = column_of(format, value);
        if (!column)
            line.fail(fmt::format("\"{}\" is no column", beginning(value)), format.heading_is);
        if (std::ranges::find(columns, *column) != columns.end())
            line.fail(fmt::format("\"{}\" is there twice", value), format.heading_is);
        columns.push_back(*column);
    }
    const auto places = std::ranges::count_if(columns, [](auto c) { return c < kPlaceColumns; });
    if (places != kPlaceColumns || !is_whole(format, columns.size()))
        line.fail("columns are missing", format.heading_is);
    return columns;
}

double number_of(const Format& format, const Line& line, std::string_view value) {
    std::string_view digits = value;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    double number = 0.0;
    const char* const end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, number);
    if (error != std::errc{} || stop != end || !std::isfinite(number)) {
        const bool comma = value.find(',') != std::string_view::npos;
        line.fail(fmt::format("\"{}\" is no finite number", beginning(value)),
                  comma ? "decimals take a point, as in 1.5" : format.line_is);
    }
    return number;
}

/// The values of a line, in the format's order. `columns`: of the heading, or empty.
Numbers numbers_of(const Format& format, const Line& line, const std::vector<std::string>& values,
                   const Columns& columns) {
    const std::size_t count = values.size();
    const bool whole = columns.empty() ? is_whole(format, count) : count == columns.size();
    Numbers numbers{};
    for (std::size_t i = 0; i < std::min(count, format.columns.size()); ++i)
        numbers[columns.empty() || !whole ? i : columns[i]] = number_of(format, line, values[i]);
    if (!whole) {
        line.fail(fmt::format("there are {} values", count),
                  columns.empty() ? std::string(format.line_is)
                                  : fmt::format("the heading names {}", columns.size()));
    }
    return numbers;
}

/// Calls take(line, numbers, how many of them) for each line but headings and comments.
template <typename Take>
void read_lines(const Format& format, std::string_view text, std::string_view name,
                const Take& take) {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
    Columns columns;
    bool is_first = true, any = false;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const Line line{name, trimmed(text.substr(0, end)), number};
        text.remove_prefix(std::min(end + 1, text.size()));
        if (line.text.empty() || line.text.starts_with('#')) continue;
        const std::vector<std::string> values = values_of(line);
        if (is_first) columns = heading_of(format, line, values);
        if (!is_first || columns.empty()) {
            take(line, numbers_of(format, line, values, columns), values.size());
            any = true;
        }
        is_first = false;
    }
    if (!any) fail_input("{}: has no {}; {}", name, format.things, format.line_is);
}

DVec3 vector_of(const Numbers& numbers, std::size_t first) {
    return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

std::string text_of(const std::filesystem::path& path) {
    const std::vector<std::uint8_t> bytes = read_file(path, kMaxFileBytes);
    return {bytes.begin(), bytes.end()};
}

}  // namespace

std::vector<SunSensor> parse_sun_sensors(std::string_view text, std::string_view name, DVec3 up) {
    std::vector<SunSensor> sensors;
    read_lines(kSensors, text, name,
               [&](const Line& line, const Numbers& numbers, std::size_t count) {
                   const DVec3 normal = count == kPlaceColumns ? up : vector_of(numbers, 3);
                   if (!(glm::length(normal) > 0.0))
                       line.fail("the normal 0,0,0 faces nowhere", "give it any length but 0");
                   sensors.push_back({vector_of(numbers, 0), normal});
               });
    return sensors;
}

std::vector<SunSensor> read_sun_sensors(const std::filesystem::path& path, DVec3 up) {
    return parse_sun_sensors(text_of(path), path.string(), up);
}

std::vector<SunPlane> parse_sun_planes(std::string_view text, std::string_view name) {
    std::vector<SunPlane> planes;
    read_lines(kPlanes, text, name, [&](const Line& line, const Numbers& numbers, std::size_t) {
        const SunPlane plane{vector_of(numbers, 0), vector_of(numbers, 3), vector_of(numbers, 6)};
        try {
            make_sun_grid(plane, glm::length(plane.u_ws) + glm::length(plane.v_ws));
        } catch (const Error&) {
            line.fail("the edges make no rectangle",
                      "ux,uy,uz and vx,vy,vz must have a length and be at right angles");
        }
        if (planes.size() == kMaxPlanes)
            line.fail("there are too many planes", fmt::format("{} can be counted", kMaxPlanes));
        planes.push_back(plane);
    });
    return planes;
}

std::vector<SunPlane> read_sun_planes(const std::filesystem::path& path) {
    return parse_sun_planes(text_of(path), path.string());
}

}  // namespace gnomon
