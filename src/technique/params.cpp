#include <gnomon/technique.h>

#include "base/check.h"
#include "base/text.h"
#include "technique/param_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace gnomon {

namespace {

std::string allowed(const ParamInfo& info) {
    switch (info.type) {
        case ParamType::boolean:
            return "true or false";
        case ParamType::integer:
            return fmt::format("a whole number in [{}, {}]", info.min, info.max);
        case ParamType::number:
            return fmt::format("a number in [{}, {}]", info.min, info.max);
        case ParamType::choice:
            break;
    }
    return fmt::format("one of {}", fmt::join(info.choices, ", "));
}

[[noreturn]] void fail_value(std::string_view technique, const ParamInfo& info,
                             std::string_view value) {
    fail_input("{}.{}: \"{}\" is not {}", technique, info.name, value, allowed(info));
}

template <typename T>
bool parse_whole(std::string_view text, T& value) {
    const char* const end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data(), end, value);
    return parsed.ec == std::errc() && parsed.ptr == end;
}

bool in_range(const ParamInfo& info, double value) {
    return value >= info.min && value <= info.max;  // false for NaN
}

}  // namespace

std::string to_string(const ParamValue& value) {
    if (const bool* b = std::get_if<bool>(&value)) return *b ? "true" : "false";
    if (const std::string* word = std::get_if<std::string>(&value)) return *word;
    if (const int* whole = std::get_if<int>(&value)) return fmt::format("{}", *whole);
    return fmt::format("{}", std::get<double>(value));
}

ParamValue checked_value(std::string_view technique, const ParamInfo& info,
                         const ParamValue& value) {
    const int* whole = std::get_if<int>(&value);
    switch (info.type) {
        case ParamType::boolean:
            if (std::holds_alternative<bool>(value)) return value;
            break;
        case ParamType::integer:
            if (whole != nullptr && in_range(info, *whole)) return value;
            break;
        case ParamType::number: {
            const double* number = std::get_if<double>(&value);
            if (whole != nullptr && in_range(info, *whole)) return static_cast<double>(*whole);
            if (number != nullptr && in_range(info, *number)) return value;
            break;
        }
        case ParamType::choice: {
            const std::string* word = std::get_if<std::string>(&value);
            if (word != nullptr &&
                std::count(info.choices.begin(), info.choices.end(), *word) > 0) {
                return value;
            }
            break;
        }
    }
    fail_value(technique, info, to_string(value));
}

ParamValue parse_param(std::string_view technique, const ParamInfo& info, std::string_view text) {
    ParamValue value = std::string(text);
    int whole = 0;
    double number = 0.0;
    switch (info.type) {
        case ParamType::boolean:
            if (text == "true" || text == "false") value = text == "true";
            break;
        case ParamType::integer:
            if (parse_whole(text, whole)) value = whole;
            break;
        case ParamType::number:
            if (parse_whole(text, number)) value = number;
            break;
        case ParamType::choice:
            break;
    }
    return checked_value(technique, info, value);
}

const ParamInfo& find_param(std::string_view technique, std::span<const ParamInfo> params,
                            std::string_view name) {
    std::string wanted(name);
    std::replace(wanted.begin(), wanted.end(), '-', '_');
    std::vector<std::string_view> names;
    for (const ParamInfo& info : params) {
        if (info.name == wanted) return info;
        names.push_back(info.name);
    }
    if (names.empty()) {
        fail_input("{}: has no parameter \"{}\"; it has none at all", technique, name);
    }
    const std::string nearest = suggestion(wanted, names);
    fail_input("{}: has no parameter \"{}\"{}; it has {}", technique, name, nearest,
               fmt::join(names, ", "));
}

}  // namespace gnomon
