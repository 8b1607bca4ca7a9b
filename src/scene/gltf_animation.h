#pragma once

#include "scene/gltf_pose.h"

namespace gnomon::scene {

/// Moves the transforms and morph weights of `pose` to where `animation` has them at the options'
/// time, clamped to each channel's first and last key. Channels that are damaged or do not move
/// nodes (KHR_animation_pointer) are left out with a warning.
void animate(GltfDocument& document, const tinygltf::Animation& animation, LoadContext& context,
             Pose& pose);

/// What to do between two keys.
enum class Interpolation { step, linear, cubic_spline };

/// The value of a channel at `time_s`. `times_s` increase; `values` has `width` numbers for each
/// time, or for cubic_spline three times as many (in-tangent, value, out-tangent), as glTF 2.0,
/// appendix C has it. `is_rotation`: values are unit quaternions x, y, z, w, and linear
/// interpolation goes along the shorter arc.
std::vector<double> sample_keys(const std::vector<float>& times_s, const std::vector<float>& values,
                                std::size_t width, Interpolation interpolation, bool is_rotation,
                                double time_s);

}  // namespace gnomon::scene
