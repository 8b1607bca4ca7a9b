#pragma once

#include <gnomon/math.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// The small grammars of the command line's values. All is pure: text in, values out. Every
/// function throws Error{input} that names the flag (`flag`, as the user writes it), the value and
/// what is allowed.
namespace gnomon::cli {

/// Inclusive.
struct Range {
    double min = 0.0;
    double max = 0.0;
    std::string_view unit;  ///< "degrees"; may be empty
};

inline constexpr unsigned kMaxSidePx = 16384;  ///< Frame::size

/// `, did you mean "x"?` for the candidate nearest to `word`, or empty when none is near.
std::string suggestion(std::string_view word, std::span<const std::string_view> candidates);

/// "a, b, c".
std::string join(std::span<const std::string_view> words);

/// The pieces between `separator`s; one empty piece for an empty text.
std::vector<std::string_view> split(std::string_view text, char separator);

/// One of `allowed`; otherwise the error lists them.
std::string_view parse_word(std::string_view flag, std::string_view text,
                            std::span<const std::string_view> allowed);

double parse_number(std::string_view flag, std::string_view text, Range range);

/// A whole number; no fraction, no exponent.
long long parse_integer(std::string_view flag, std::string_view text, Range range);

/// "x,y,z", each within `range`.
DVec3 parse_vector(std::string_view flag, std::string_view text, Range range);

/// "x" (a grey) or "r,g,b", each within `range`.
Vec3 parse_color(std::string_view flag, std::string_view text, Range range);

/// "10:30", "9:30", "10:30:15" or "10:30:15.25" in seconds since midnight; hours up to 99, for
/// clocks that go on.
double parse_clock(std::string_view flag, std::string_view text);

/// "10:30:15"; of a time before midnight that of the day before.
std::string clock_text(double clock_s);

/// "1280x720": each side 1 to kMaxSidePx.
Extent parse_size(std::string_view flag, std::string_view text);

/// "a,b,c" without empty or repeated words.
std::vector<std::string> parse_list(std::string_view flag, std::string_view text);

/// What may be said once: a key of a value such as "eye=1,2,3,target=0,0,0".
struct Key {
    std::string_view name;
    bool required = false;
};

/// The keys and values of "key=value,key=value". A value runs until the next ",key=", so that
/// vectors need no brackets.
class KeyValues {
public:
    /// `context` starts every message: "--light sun". `example` ends the one on a missing key.
    KeyValues(std::string context, std::string_view text, std::span<const Key> keys,
              std::string_view example);

    bool has(std::string_view key) const;
    std::string text(std::string_view key, std::string_view otherwise) const;
    double number(std::string_view key, Range range, double otherwise) const;
    DVec3 vector(std::string_view key, Range range) const;
    Vec3 color(std::string_view key, Range range, Vec3 otherwise) const;

    /// "--light sun: radius", to name a value in a message.
    std::string label(std::string_view key) const;

private:
    struct Pair {
        std::string key, value;
    };
    const std::string* find(std::string_view key) const;

    std::string context_;
    std::vector<Pair> pairs_;
};

/// A technique's parameter on the command line: --shadow_map.map_size 1024.
struct ParamFlag {
    std::string technique;             ///< underscores, not dashes
    std::string param;                 ///< likewise
    std::optional<std::string> value;  ///< none: a switch without a value, turned on
    std::string written;               ///< the flag as the user wrote it, without its value

    bool operator==(const ParamFlag&) const = default;
};

/// Takes the flags with a dot in their name out of `args` (before a "--"), with their values, so
/// that the rest can be parsed by commands that know no techniques. `is_switch` says whether a
/// parameter may stand without a value; it may throw for one that does not exist.
std::vector<ParamFlag> take_param_flags(std::vector<std::string>& args,
                                        bool (*is_switch)(const ParamFlag&));

}  // namespace gnomon::cli
