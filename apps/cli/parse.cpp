#include "parse.h"

#include "fail.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numeric>

namespace gnomon::cli {

namespace {

/// V. Levenshtein, "Binary codes capable of correcting deletions, insertions, and reversals", 1966.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

std::string range_text(Range range) {
    const std::string unit = range.unit.empty() ? "" : fmt::format(" {}", range.unit);
    return fmt::format("{} to {}{}", range.min, range.max, unit);
}

template <typename Number>
Number parse_as(std::string_view flag, std::string_view text, Range range, std::string_view kind) {
    Number value{};
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    const bool overflow = error == std::errc::result_out_of_range && stop == end;
    if (!overflow && (error != std::errc{} || stop != end)) {
        fail_usage("{}: \"{}\" is not {}; {} is allowed", flag, text, kind, range_text(range));
    }
    const double number = static_cast<double>(value);
    if (overflow || !std::isfinite(number) || number < range.min || number > range.max) {
        fail_usage("{}: {} is out of range; {} is allowed", flag, text, range_text(range));
    }
    return value;
}

std::string underscored(std::string_view name) {
    std::string result(name);
    std::replace(result.begin(), result.end(), '-', '_');
    return result;
}

bool is_switch_value(std::string_view text) {
    constexpr std::string_view kValues[] = {"true", "false", "on", "off", "yes", "no", "1", "0"};
    return std::find(std::begin(kValues), std::end(kValues), text) != std::end(kValues);
}

/// --technique.param or --technique.param=value; the dot must come before the value.
std::optional<ParamFlag> as_param_flag(std::string_view arg) {
    if (!arg.starts_with("--")) return std::nullopt;
    const std::size_t equals = arg.find('=');
    const std::string_view written = arg.substr(0, equals);
    const std::size_t dot = written.find('.');
    if (dot == std::string_view::npos) return std::nullopt;
    ParamFlag flag;
    flag.technique = underscored(written.substr(2, dot - 2));
    flag.param = underscored(written.substr(dot + 1));
    flag.written = written;
    if (equals != std::string_view::npos) flag.value = arg.substr(equals + 1);
    return flag;
}

}  // namespace

std::string suggestion(std::string_view word, std::span<const std::string_view> candidates) {
    // More than a third of the word wrong, and more than two letters, is another word.
    std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
    std::string_view best;
    for (const std::string_view candidate : candidates) {
        const std::size_t distance = edit_distance(word, candidate);
        if (distance < best_distance) {
            best_distance = distance;
            best = candidate;
        }
    }
    return best.empty() ? std::string() : fmt::format(", did you mean \"{}\"?", best);
}

std::string join(std::span<const std::string_view> words) {
    return fmt::format("{}", fmt::join(words, ", "));
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> pieces;
    for (std::size_t start = 0;;) {
        const std::size_t end = text.find(separator, start);
        pieces.push_back(text.substr(start, end - start));
        if (end == std::string_view::npos) return pieces;
        start = end + 1;
    }
}

std::string_view parse_word(std::string_view flag, std::string_view text,
                            std::span<const std::string_view> allowed) {
    const auto found = std::find(allowed.begin(), allowed.end(), text);
    if (found == allowed.end()) {
        fail_usage("{}: unknown value \"{}\"{}; allowed: {}", flag, text, suggestion(text, allowed),
                   join(allowed));
    }
    return *found;
}

double parse_number(std::string_view flag, std::string_view text, Range range) {
    return parse_as<double>(flag, text, range, "a number");
}

long long parse_integer(std::string_view flag, std::string_view text, Range range) {
    return parse_as<long long>(flag, text, range, "a whole number");
}

DVec3 parse_vector(std::string_view flag, std::string_view text, Range range) {
    constexpr std::size_t kComponents = 3;
    const std::vector<std::string_view> parts = split(text, ',');
    if (parts.size() != kComponents) {
        fail_usage("{}: \"{}\" is not three numbers x,y,z", flag, text);
    }
    return {parse_number(flag, parts[0], range), parse_number(flag, parts[1], range),
            parse_number(flag, parts[2], range)};
}

Vec3 parse_color(std::string_view flag, std::string_view text, Range range) {
    const std::size_t parts = split(text, ',').size();
    if (parts == 1) return Vec3(static_cast<float>(parse_number(flag, text, range)));
    if (parts == 3) return Vec3(parse_vector(flag, text, range));
    fail_usage("{}: \"{}\" is not one number or three r,g,b", flag, text);
}

double parse_clock(std::string_view flag, std::string_view text) {
    constexpr double kMinute_s = 60.0;
    const std::vector<std::string_view> parts = split(text, ':');
    const auto fail = [&] {
        fail_usage("{}: \"{}\" is no time, as in 10:30 or 10:30:15", flag, text);
    };
    if (parts.size() < 2 || parts.size() > 3) fail();
    double clock_s = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string_view part = i < parts.size() ? parts[i] : "00";
        const std::size_t digits = i == 0 ? std::min<std::size_t>(part.size(), 2) : 2;
        const bool has_digits = digits > 0 && part.size() >= digits &&
                                std::ranges::all_of(part.substr(0, digits), [](unsigned char c) {
                                    return std::isdigit(c) != 0;
                                });
        const bool has_more = part.size() > 2 && (i < 2 || part[2] != '.');
        if (!has_digits || has_more) fail();
        double value = 0.0;
        const char* const end = part.data() + part.size();
        if (std::from_chars(part.data(), end, value, std::chars_format::fixed).ptr != end) fail();
        if (i > 0 && value >= kMinute_s) fail();
        clock_s = kMinute_s * clock_s + value;
    }
    return clock_s;
}

std::string clock_text(double clock_s) {
    constexpr long long kDay_s = 86400;
    long long seconds = std::llround(clock_s);
    if (seconds < 0) seconds += kDay_s;
    return fmt::format("{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60);
}

Extent parse_size(std::string_view flag, std::string_view text) {
    const std::vector<std::string_view> sides = split(text, 'x');
    const auto side = [](std::string_view digits) -> unsigned {
        unsigned px = 0;
        const char* const end = digits.data() + digits.size();
        const auto [stop, error] = std::from_chars(digits.data(), end, px);
        return error == std::errc{} && stop == end && px <= kMaxSidePx ? px : 0;
    };
    const Extent size = sides.size() == 2 ? Extent{side(sides[0]), side(sides[1])} : Extent{};
    if (size.width == 0 || size.height == 0) {
        fail_usage("{}: \"{}\" is not WIDTHxHEIGHT with sides of 1 to {} pixels, such as 1280x720",
                   flag, text, kMaxSidePx);
    }
    return size;
}

std::vector<std::string> parse_list(std::string_view flag, std::string_view text) {
    std::vector<std::string> words;
    for (const std::string_view word : split(text, ',')) {
        if (word.empty()) fail_usage("{}: \"{}\" has an empty name", flag, text);
        if (std::find(words.begin(), words.end(), word) != words.end()) {
            fail_usage("{}: \"{}\" is named twice", flag, word);
        }
        words.emplace_back(word);
    }
    return words;
}

KeyValues::KeyValues(std::string context, std::string_view text, std::span<const Key> keys,
                     std::string_view example)
    : context_(std::move(context)) {
    std::vector<std::string_view> names;
    for (const Key& key : keys)
        names.push_back(key.name);
    for (const std::string_view piece : split(text, ',')) {
        const std::size_t equals = piece.find('=');
        if (equals == std::string_view::npos) {
            if (text.empty()) break;
            if (pairs_.empty()) {
                fail_usage("{}: \"{}\" is not key=value; keys: {}", context_, piece, join(names));
            }
            pairs_.back().value.append(1, ',').append(piece);
            continue;
        }
        const std::string_view key = piece.substr(0, equals);
        if (std::find(names.begin(), names.end(), key) == names.end()) {
            fail_usage("{}: unknown key \"{}\"{}; keys: {}", context_, key, suggestion(key, names),
                       join(names));
        }
        if (has(key)) fail_usage("{}: {} is given twice", context_, key);
        pairs_.push_back({std::string(key), std::string(piece.substr(equals + 1))});
    }
    for (const Key& key : keys) {
        if (key.required && !has(key.name)) {
            fail_usage("{}: {} is missing, as in {}", context_, key.name, example);
        }
    }
    for (const Pair& pair : pairs_) {
        if (pair.value.empty()) fail_usage("{}: {} has no value", context_, pair.key);
    }
}

const std::string* KeyValues::find(std::string_view key) const {
    const auto pair = std::find_if(pairs_.begin(), pairs_.end(),
                                   [&](const Pair& candidate) { return candidate.key == key; });
    return pair == pairs_.end() ? nullptr : &pair->value;
}

bool KeyValues::has(std::string_view key) const {
    return find(key) != nullptr;
}

std::string KeyValues::label(std::string_view key) const {
    return fmt::format("{}: {}", context_, key);
}

std::string KeyValues::text(std::string_view key, std::string_view otherwise) const {
    const std::string* const value = find(key);
    return value == nullptr ? std::string(otherwise) : *value;
}

double KeyValues::number(std::string_view key, Range range, double otherwise) const {
    const std::string* const value = find(key);
    return value == nullptr ? otherwise : parse_number(label(key), *value, range);
}

DVec3 KeyValues::vector(std::string_view key, Range range) const {
    return parse_vector(label(key), text(key, ""), range);
}

Vec3 KeyValues::color(std::string_view key, Range range, Vec3 otherwise) const {
    const std::string* const value = find(key);
    return value == nullptr ? otherwise : parse_color(label(key), *value, range);
}

namespace {

/// "-o" and "--quiet" are, "-2.5" is not.
bool is_flag(std::string_view arg) {
    return arg.size() > 1 && arg[0] == '-' &&
           (arg[1] == '-' || std::isalpha(static_cast<unsigned char>(arg[1])) != 0);
}

}  // namespace

std::vector<ParamFlag> take_param_flags(std::vector<std::string>& args,
                                        bool (*is_switch)(const ParamFlag&)) {
    std::vector<ParamFlag> flags;
    std::vector<std::string> rest;
    for (std::size_t i = 0; i < args.size(); ++i) {
        if (args[i] == "--") {
            rest.insert(rest.end(), args.begin() + static_cast<std::ptrdiff_t>(i), args.end());
            break;
        }
        std::optional<ParamFlag> flag = as_param_flag(args[i]);
        if (!flag) {
            rest.push_back(args[i]);
            continue;
        }
        if (!flag->value) {
            const bool followed = i + 1 < args.size() && !is_flag(args[i + 1]);
            const bool may_stand_alone = is_switch(*flag);
            if (followed && (!may_stand_alone || is_switch_value(args[i + 1]))) {
                flag->value = args[++i];
            } else if (!may_stand_alone) {
                fail_usage("{}: a value is missing", flag->written);
            }
        }
        flags.push_back(std::move(*flag));
    }
    args = std::move(rest);
    return flags;
}

}  // namespace gnomon::cli
