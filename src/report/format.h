#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace gnomon::report {

/// A number >= 0 to about three significant digits: "0", "<0.001", "0.034", "1.25", "34.1", "1250".
/// Exactly 0 is told apart from what is merely small.
std::string short_number(double value);

/// A fraction in percent, without the sign: 0.0034 is "0.340".
std::string short_percent(double fraction);

/// "0 B", "512 KiB", "16.0 MiB".
std::string short_bytes(std::uint64_t bytes);

/// "1 234 567", with narrow spaces that do not break.
std::string grouped(std::uint64_t count);

/// `text` with each control character as "?": names come from scene files, and a terminal would
/// obey them.
std::string printable(std::string_view text);

/// How many columns UTF-8 text takes on a terminal, one per code point.
std::size_t columns(std::string_view text);

}  // namespace gnomon::report
