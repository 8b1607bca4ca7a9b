#include "scene/gltf_animation.h"

#include "base/check.h"
#include "scene/gltf_accessor.h"

#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

namespace gnomon::scene {

namespace {

// Values of a cubic key.
constexpr std::size_t kInTangent = 0;
constexpr std::size_t kValue = 1;
constexpr std::size_t kOutTangent = 2;
constexpr std::size_t kCubicParts = 3;

Interpolation interpolation_of(const std::string& name) {
    if (name == "LINEAR" || name.empty()) return Interpolation::linear;
    if (name == "STEP") return Interpolation::step;
    if (name == "CUBICSPLINE") return Interpolation::cubic_spline;
    fail_input("its interpolation \"{}\" is unknown", quotable(name));
}

struct Keys {
    std::vector<float> times_s;
    std::vector<float> values;
    std::size_t width = 0;
    Interpolation interpolation = Interpolation::linear;
};

// `width`: numbers of a value; 0 = whatever divides evenly (morph weights).
Keys read_keys(GltfDocument& document, const tinygltf::AnimationSampler& sampler,
               std::size_t width) {
    Keys keys;
    keys.interpolation = interpolation_of(sampler.interpolation);
    keys.times_s = read_floats(document, sampler.input, 1);
    const int components = width == 0 ? 1 : static_cast<int>(width);
    keys.values = read_floats(document, sampler.output, components);
    if (keys.times_s.empty()) fail_input("it has no keys");
    // Written so that NaN fails.
    for (std::size_t i = 0; i < keys.times_s.size(); ++i) {
        const bool fine =
            i == 0 ? std::isfinite(keys.times_s[i]) : keys.times_s[i] > keys.times_s[i - 1];
        if (!fine) fail_input("the times of its keys do not increase");
    }
    const std::size_t parts = keys.interpolation == Interpolation::cubic_spline ? kCubicParts : 1;
    const std::size_t slots = keys.times_s.size() * parts;
    keys.width = width != 0 ? width : keys.values.size() / slots;
    if (keys.width == 0 || keys.values.size() != slots * keys.width) {
        fail_input("it has {} numbers for {} keys", keys.values.size(), keys.times_s.size());
    }
    return keys;
}

std::vector<double> slerp(const std::vector<double>& a, const std::vector<double>& b, double t) {
    const glm::dquat q =
        glm::slerp(glm::dquat(a[3], a[0], a[1], a[2]), glm::dquat(b[3], b[0], b[1], b[2]), t);
    return {q.x, q.y, q.z, q.w};
}

void move_node(GltfDocument& document, const tinygltf::Animation& animation,
               const tinygltf::AnimationChannel& channel, double time_s, Pose& pose) {
    constexpr std::size_t kVectorWidth = 3;
    constexpr std::size_t kQuaternionWidth = 4;
    if (static_cast<std::size_t>(channel.sampler) >= animation.samplers.size()) {
        fail_input("its sampler is {}, but there are {}", channel.sampler,
                   animation.samplers.size());
    }
    const auto node = static_cast<std::size_t>(channel.target_node);
    NodeTransform& transform = pose.transforms[node];
    const std::string& path = channel.target_path;
    const bool is_rotation = path == "rotation";
    const bool is_weights = path == "weights";
    if (!is_weights && !is_rotation && path != "translation" && path != "scale") {
        fail_input("its path \"{}\" is unknown", quotable(path));
    }
    if (!is_weights && transform.matrix) fail_input("its node has a matrix");
    const std::size_t width = is_weights ? 0 : is_rotation ? kQuaternionWidth : kVectorWidth;
    const Keys keys =
        read_keys(document, animation.samplers[static_cast<std::size_t>(channel.sampler)], width);
    const std::vector<double> value =
        sample_keys(keys.times_s, keys.values, keys.width, keys.interpolation, is_rotation, time_s);
    if (!std::all_of(value.begin(), value.end(), [](double v) { return std::isfinite(v); })) {
        fail_input("it has values that are not finite");
    }
    if (is_weights) pose.morph_weights[node] = value;
    if (is_rotation) transform.rotation = glm::dquat(value[3], value[0], value[1], value[2]);
    if (path == "translation") transform.translation = {value[0], value[1], value[2]};
    if (path == "scale") transform.scale = {value[0], value[1], value[2]};
}

}  // namespace

std::vector<double> sample_keys(const std::vector<float>& times_s, const std::vector<float>& values,
                                std::size_t width, Interpolation interpolation, bool is_rotation,
                                double time_s) {
    const bool cubic = interpolation == Interpolation::cubic_spline;
    const std::size_t parts = cubic ? kCubicParts : 1;
    const auto part_at = [&](std::size_t key, std::size_t part) {
        const auto first =
            values.begin() + static_cast<std::ptrdiff_t>((key * parts + part) * width);
        return std::vector<double>(first, first + static_cast<std::ptrdiff_t>(width));
    };
    const auto value_at = [&](std::size_t key) { return part_at(key, cubic ? kValue : 0); };

    const auto after = std::upper_bound(times_s.begin(), times_s.end(), time_s,
                                        [](double t, float key_s) { return t < double{key_s}; });
    if (after == times_s.begin()) return value_at(0);
    const auto key = static_cast<std::size_t>(after - times_s.begin()) - 1;
    if (after == times_s.end() || interpolation == Interpolation::step) return value_at(key);

    const double span_s = double{times_s[key + 1]} - times_s[key];
    const double t = (time_s - times_s[key]) / span_s;
    const std::vector<double> a = value_at(key);
    const std::vector<double> b = value_at(key + 1);
    if (is_rotation && !cubic) return slerp(a, b, t);
    std::vector<double> result(width);
    if (!cubic) {
        for (std::size_t i = 0; i < width; ++i)
            result[i] = std::lerp(a[i], b[i], t);
        return result;
    }
    const std::vector<double> out = part_at(key, kOutTangent);
    const std::vector<double> in = part_at(key + 1, kInTangent);
    const double t2 = t * t;
    const double t3 = t2 * t;
    for (std::size_t i = 0; i < width; ++i) {
        result[i] = (2.0 * t3 - 3.0 * t2 + 1.0) * a[i] + span_s * (t3 - 2.0 * t2 + t) * out[i] +
                    (3.0 * t2 - 2.0 * t3) * b[i] + span_s * (t3 - t2) * in[i];
    }
    return result;
}

void animate(GltfDocument& document, const tinygltf::Animation& animation, LoadContext& context,
             Pose& pose) {
    const std::vector<std::string>& used = document.model().extensionsUsed;
    if (std::find(used.begin(), used.end(), "KHR_animation_pointer") != used.end()) {
        context.warnings.add(
            "animations of other things than nodes (KHR_animation_pointer) are left out");
    }
    for (std::size_t i = 0; i < animation.channels.size(); ++i) {
        const tinygltf::AnimationChannel& channel = animation.channels[i];
        const std::string name = fmt::format("\"{}\" channels[{}]", animation.name, i);
        if (channel.target_node < 0) continue;
        try {
            move_node(document, animation, channel, context.options.animation_time_s, pose);
        } catch (const Error& error) {
            context.warnings.add("a damaged animation channel is left out",
                                 fmt::format("{}: {}", name, error.what()));
        }
    }
}

}  // namespace gnomon::scene
