// Lights that move by key frames. Great circles: K. Shoemake, "Animating rotation with quaternion
// curves", 1985, for vectors.
#include <gnomon/light_path.h>

#include "base/check.h"
#include "base/file.h"
#include "base/text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon {

namespace {

using Json = nlohmann::json;

constexpr int kMaxSteps = 100000;
constexpr std::uint64_t kMaxFileBytes = 64u << 20;
// Radians. Nearer to opposite than this, rounding decides which way a direction goes.
constexpr double kOppositeTolerance = 1e-6;
// Radians. Below it the sine of the angle is the angle to the last bit, and straight lines are as
// good.
constexpr double kSmallAngle = 1e-8;

bool finite(DVec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Of unit vectors; exact for small angles and for nearly opposite ones, where the arc cosine is
// not.
double angle_between(DVec3 a, DVec3 b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

DVec3 spherical(DVec3 a, DVec3 b, double t) {
    const double angle = angle_between(a, b);
    if (angle < kSmallAngle) return glm::normalize(glm::mix(a, b, t));
    return glm::normalize((std::sin((1.0 - t) * angle) * a + std::sin(t * angle) * b) /
                          std::sin(angle));
}

template <typename Enum, std::size_t count>
Enum enum_of(std::string_view where, const Json& value,
             const std::array<std::string_view, count>& words) {
    const std::string word = value.is_string() ? value.get<std::string>() : value.dump();
    const auto found = std::find(words.begin(), words.end(), word);
    if (!value.is_string() || found == words.end()) {
        fail_input("{}: unknown value \"{}\"{}; allowed: {}", where, word, suggestion(word, words),
                   fmt::join(words, ", "));
    }
    return static_cast<Enum>(found - words.begin());
}

// In the order of the enumerations.
constexpr std::array<std::string_view, 2> kKinds = {"direction", "position"};
constexpr std::array<std::string_view, 2> kInterpolations = {"spherical", "linear"};

/// Throws unless `value` is an object of these members alone, `required` of them there.
template <std::size_t count>
void require_members(std::string_view where, const Json& value,
                     const std::array<std::string_view, count>& members,
                     std::initializer_list<std::string_view> required) {
    if (!value.is_object()) fail_input("{}: must be an object {{...}}", where);
    for (const auto& [name, unused] : value.items()) {
        if (std::find(members.begin(), members.end(), name) == members.end()) {
            fail_input("{}: unknown member \"{}\"{}; allowed: {}", where, name,
                       suggestion(name, members), fmt::join(members, ", "));
        }
    }
    for (const std::string_view name : required) {
        if (!value.contains(name)) fail_input("{}: \"{}\" is missing", where, name);
    }
}

LightKey key_of(std::string_view where, const Json& value) {
    constexpr std::array<std::string_view, 2> kMembers = {"time", "value"};
    require_members(where, value, kMembers, {"time", "value"});
    const Json& time = value["time"];
    const Json& vector = value["value"];
    if (!time.is_number()) fail_input("{}: time must be a number, in seconds", where);
    const bool numbers = vector.is_array() && vector.size() == 3 &&
                         std::all_of(vector.begin(), vector.end(),
                                     [](const Json& number) { return number.is_number(); });
    if (!numbers) fail_input("{}: value must be three numbers [x, y, z]", where);
    return {time.get<double>(),
            {vector[0].get<double>(), vector[1].get<double>(), vector[2].get<double>()}};
}

Json json_of(std::string_view text, std::string_view name) {
    try {
        return Json::parse(text);
    } catch (const Json::parse_error& error) {
        // The parser's own message tells what it expected, but runs over lines.
        const auto stop =
            text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
        fail_input("{}: no valid JSON at line {}", name, 1 + std::count(text.begin(), stop, '\n'));
    } catch (const Json::exception&) {
        fail_input("{}: holds a number that is too large", name);  // all that parsing can find else
    }
}

}  // namespace

std::vector<double> even_times(double begin_s, double end_s, int count, StepPlacement placement) {
    if (count < 1 || count > kMaxSteps) {
        fail_input("steps is {}; it must be 1 to {}", count, kMaxSteps);
    }
    const bool middles = placement == StepPlacement::middles;
    const double first = middles ? 0.5 : 0.0;
    const double parts = middles ? count : std::max(1, count - 1);
    std::vector<double> times_s;
    for (int i = 0; i < count; ++i) {
        times_s.push_back(begin_s + (end_s - begin_s) * ((i + first) / parts));
    }
    return times_s;
}

LightPath::LightPath(LightPathKind kind, Interpolation interpolation, std::vector<LightKey> keys)
    : kind_(kind), interpolation_(interpolation), keys_(std::move(keys)) {
    if (keys_.empty()) fail_input("light path: has no keys; it must have one or more");
    const bool directions = kind == LightPathKind::direction;
    if (!directions && interpolation == Interpolation::spherical) {
        fail_input("light path: positions cannot be spherical; use linear");
    }
    for (std::size_t i = 0; i < keys_.size(); ++i) {
        auto& [time_s, value] = keys_[i];
        if (!std::isfinite(time_s) || !finite(value)) {
            fail_input("light path: key {} is not finite: {} s, ({}, {}, {})", i, time_s, value.x,
                       value.y, value.z);
        }
        if (i > 0 && !(time_s > keys_[i - 1].time_s)) {
            fail_input("light path: key {} is at {} s; it must be later than key {} at {} s", i,
                       time_s, i - 1, keys_[i - 1].time_s);
        }
        if (!directions) continue;
        const double length = glm::length(value);
        if (!(length > 0.0) || !std::isfinite(length)) {
            fail_input("light path: key {} is ({}, {}, {}), which is no direction", i, value.x,
                       value.y, value.z);
        }
        value /= length;
        if (i > 0 && angle_between(-value, keys_[i - 1].value_ws) < kOppositeTolerance) {
            fail_input(
                "light path: keys {} and {} are opposite; put a key between them to say "
                "which way to go",
                i - 1, i);
        }
    }
}

DVec3 LightPath::at(double time_s) const {
    const auto next =
        std::upper_bound(keys_.begin(), keys_.end(), time_s,
                         [](double t, const LightKey& key) { return t < key.time_s; });
    if (next == keys_.begin()) return keys_.front().value_ws;
    if (next == keys_.end()) return keys_.back().value_ws;
    const LightKey& a = *(next - 1);
    const LightKey& b = *next;
    const double t = (time_s - a.time_s) / (b.time_s - a.time_s);
    if (interpolation_ == Interpolation::spherical) return spherical(a.value_ws, b.value_ws, t);
    const DVec3 straight = glm::mix(a.value_ws, b.value_ws, t);
    return kind_ == LightPathKind::direction ? glm::normalize(straight) : straight;
}

std::vector<LightKey> LightPath::steps(int count, StepPlacement placement) const {
    std::vector<LightKey> steps;
    for (const double time_s : even_times(begin_s(), end_s(), count, placement)) {
        steps.push_back({time_s, at(time_s)});
    }
    return steps;
}

LightPath parse_light_path(std::string_view json, std::string_view name) {
    const Json root = json_of(json, name);
    constexpr std::array<std::string_view, 3> kMembers = {"kind", "interpolation", "keys"};
    require_members(name, root, kMembers, {"kind", "keys"});
    const auto kind = enum_of<LightPathKind>(fmt::format("{}: kind", name), root["kind"], kKinds);
    Interpolation interpolation =
        kind == LightPathKind::direction ? Interpolation::spherical : Interpolation::linear;
    if (root.contains("interpolation")) {
        interpolation = enum_of<Interpolation>(fmt::format("{}: interpolation", name),
                                               root["interpolation"], kInterpolations);
    }
    if (!root["keys"].is_array()) fail_input("{}: keys must be an array [...]", name);
    std::vector<LightKey> keys;
    for (const Json& key : root["keys"]) {
        keys.push_back(key_of(fmt::format("{}: key {}", name, keys.size()), key));
    }
    try {
        return LightPath(kind, interpolation, std::move(keys));
    } catch (const Error& error) {
        fail_input("{}: {}", name, error.what());
    }
}

LightPath read_light_path(const std::filesystem::path& path) {
    const std::vector<std::uint8_t> bytes = read_file(path, kMaxFileBytes);
    return parse_light_path({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                            path.string());
}

}  // namespace gnomon
