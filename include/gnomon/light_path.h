#pragma once

#include <gnomon/math.h>

#include <filesystem>
#include <string_view>
#include <vector>

namespace gnomon {

/// Where even steps lie in a span of time.
enum class StepPlacement {
    middles,  ///< in the middle of equal parts: each stands for as much time
    ends,     ///< the first and the last at the span's ends; a single step at its start
};

/// What a light's path goes through.
enum class LightPathKind {
    direction,  ///< unit vectors towards a light that is far away
    position,   ///< points in the scene, metres
};

enum class Interpolation {
    spherical,  ///< along great circles at an even pace; directions only
    linear,     ///< along straight lines; directions are made unit vectors again
};

struct LightKey {
    double time_s = 0.0;
    DVec3 value_ws{0.0};
};

/// Times from `begin_s` to `end_s`, `count` of them, placed evenly.
std::vector<double> even_times(double begin_s, double end_s, int count, StepPlacement placement);

/// The path of a light by key frames.
class LightPath {
public:
    /// Directions are normalized. Throws Error{input} naming the key: no keys, times that do not
    /// rise, numbers that are not finite, a direction of no length, neighbouring directions that
    /// are opposite (no one way leads from one to the other), positions with spherical
    /// interpolation.
    LightPath(LightPathKind kind, Interpolation interpolation, std::vector<LightKey> keys);

    LightPathKind kind() const { return kind_; }
    Interpolation interpolation() const { return interpolation_; }
    const std::vector<LightKey>& keys() const { return keys_; }
    double begin_s() const { return keys_.front().time_s; }
    double end_s() const { return keys_.back().time_s; }

    /// The direction or position at `time_s`; before the first key the first, after the last the
    /// last.
    DVec3 at(double time_s) const;

    /// `count` even steps from the first key to the last, 1 to 100000. Throws Error{input}.
    std::vector<LightKey> steps(int count, StepPlacement placement = StepPlacement::middles) const;

private:
    LightPathKind kind_;
    Interpolation interpolation_;
    std::vector<LightKey> keys_;
};

/// A path from JSON, `name` being what errors call it:
///
///     {"kind": "direction",
///      "interpolation": "spherical",
///      "keys": [{"time": 0, "value": [0, 1, 0]}, {"time": 60, "value": [1, 1, 0]}]}
///
/// `kind` is "direction" or "position"; `interpolation` "spherical" or "linear" and may be left
/// out: directions are then spherical, positions linear. Times are seconds and rise from key to
/// key; values are in the scene's frame, positions in metres, directions of any length but 0.
/// Throws Error{input} naming the file, the key and the fault.
LightPath parse_light_path(std::string_view json, std::string_view name);

/// parse_light_path of a file of at most 64 MiB.
LightPath read_light_path(const std::filesystem::path& path);

}  // namespace gnomon
