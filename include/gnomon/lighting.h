#pragma once

#include <gnomon/visibility.h>

#include <span>

namespace gnomon {

/// How visibility and light make a picture.
enum class Compose {
    additive,     ///< ambient + sum of light * visibility: right
    subtractive,  ///< (ambient + sum of light) * product of visibilities, as the classical methods
                  ///< did
};

struct LightingOptions {
    Vec3 ambient{-1.0f};    ///< radiance from everywhere; negative = 12 % of the mean light
    float exposure = 0.0f;  ///< factor on radiance before sRGB; 0 = bright parts of the fully lit
                            ///< picture become white
    Compose compose = Compose::additive;
    Vec3 background_srgb{0.16f, 0.18f, 0.21f};  ///< where nothing is seen
};

/// One light and how much of it each receiver sees.
struct LitBy {
    Light light;
    const Visibility* visibility = nullptr;
};

/// The picture of a scene: ambient + Lambert + Blinn-Phong over the base colour, lights summed,
/// exposed, sRGB-encoded: 3 channels in [0, 1]. Only `frame.scene`, `camera`, `size` and
/// `ignore_alpha` are read. Throws Error{input} when a visibility has another size.
Image light_picture(Context& context, const Frame& frame, std::span<const LitBy> lights,
                    const LightingOptions& options = {});

}  // namespace gnomon
