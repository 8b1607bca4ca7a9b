#include "report/format.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace gnomon::report {

std::string short_number(double value) {
    constexpr double kLeastShown = 0.001;
    if (value == 0.0) return "0";
    if (value < kLeastShown) return "<0.001";
    // Half a unit below each power of ten, so that 9.996 is "10.0" and not "10.00".
    if (value < 0.9995) return fmt::format("{:.3f}", value);
    if (value < 9.995) return fmt::format("{:.2f}", value);
    if (value < 99.95) return fmt::format("{:.1f}", value);
    return fmt::format("{:.0f}", value);
}

std::string short_percent(double fraction) {
    return short_number(100.0 * fraction);
}

std::string short_bytes(std::uint64_t bytes) {
    constexpr std::array<std::string_view, 4> kUnits = {"B", "KiB", "MiB", "GiB"};
    constexpr double kStep = 1024.0;
    double value = static_cast<double>(bytes);
    std::size_t unit = 0;
    while (value >= kStep && unit + 1 < kUnits.size()) {
        value /= kStep;
        ++unit;
    }
    return unit == 0 ? fmt::format("{} B", bytes)
                     : fmt::format("{} {}", short_number(value), kUnits[unit]);
}

std::string grouped(std::uint64_t count) {
    std::string digits = std::to_string(count);
    constexpr std::size_t kGroup = 3;
    for (std::size_t end = digits.size(); end > kGroup; end -= kGroup) {
        digits.insert(end - kGroup, "\u202f");
    }
    return digits;
}

std::string printable(std::string_view text) {
    std::string result(text);
    for (std::size_t i = 0; i < result.size(); ++i) {
        const auto byte = static_cast<unsigned char>(result[i]);
        if (byte < 0x20 || byte == 0x7f) result[i] = '?';
        // C1 control characters are U+0080 to U+009F: 0xC2 and one byte more.
        const bool after_c2 = i > 0 && static_cast<unsigned char>(text[i - 1]) == 0xc2;
        if (after_c2 && byte >= 0x80 && byte < 0xa0) result.replace(--i, 2, "?");
    }
    return result;
}

std::size_t columns(std::string_view text) {
    return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
        return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
    }));
}

}  // namespace gnomon::report
