#pragma once

#include <gnomon/image.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gnomon {

/// How far a technique's visibility V is from the truth T, over the pixels that have a receiver
/// facing the light (`pixels` of them). Fractions are of these pixels; 0 when there are none.
struct Comparison {
    double mae = 0.0;              ///< mean |V - T|
    double rmse = 0.0;             ///< root of the mean (V - T)²
    double false_lit = 0.0;        ///< T < 0.1 and V > 0.5
    double false_shadow = 0.0;     ///< T > 0.9 and V < 0.5
    double stray_lit = 0.0;        ///< of false_lit: far from the truth's lit pixels
    double stray_shadow = 0.0;     ///< of false_shadow: far from the truth's shadow pixels
    double artefact_lit = 0.0;     ///< of false_lit: farther than the technique's texels explain
    double artefact_shadow = 0.0;  ///< of false_shadow: likewise
    std::uint64_t pixels = 0;
};

/// Looks for the truth's edges where its picture shows none: those of shadows narrower than a
/// pixel, and those that what casts them hides.
class EdgeProbe {
public:
    struct Place {
        std::size_t pixel = 0;  ///< index into the picture, row-major, top row first
        double reach_m = 0.0;   ///< above 0
    };

    virtual ~EdgeProbe() = default;
    /// At which places the truth is of the class, lit or in shadow, somewhere within the reach of
    /// the pixel's receiver, across the light: one number for each, in their order; 1 for those,
    /// else 0. Pixels must be of the picture that the probe was made for, and have receivers.
    virtual std::vector<std::uint8_t> find(std::span<const Place> places, bool lit) const = 0;
};

/// Which pixels count. 1 channel: above 0 where a receiver faces the light, by more than a
/// ten-thousandth of a radian. `pixel_size_m`: side of a pixel in metres at its receiver, 1
/// channel, for the artefact distances. `edges` may be null.
struct ComparisonMask {
    Image facing;
    Image pixel_size_m;
    std::shared_ptr<const EdgeProbe> edges;
};

/// "Far" for stray pixels is max(2 px, 1 % of the height), for artefacts (filter radius + 1.5)
/// texels as projected to pixels at the receiver, but no less than the 1.5 px that aliasing
/// explains alone; distances are exact Euclidean ones to the nearest pixel that counts and is of
/// the other class of the truth (T > 0.5 for lit, else shadow), infinite when there is none. No
/// artefact either is a pixel where `mask.edges` finds that class within so many texels of its
/// receiver. Artefacts are judged as stray where `texel_size_m` or the pixel size is not positive
/// and finite, and everywhere when `texel_size_m` is empty; `mask.pixel_size_m` may then be empty
/// too. Throws Error{input} when sizes differ, an image has more than 1 channel, or a visibility or
/// truth is not finite.
Comparison compare(const Image& visibility, const Image& truth, const ComparisonMask& mask,
                   const Image& texel_size_m = {}, float filter_radius_texels = 0.0f);

/// NVIDIA FLIP for low-dynamic-range pictures: 3 channels, sRGB-encoded, clamped to [0, 1].
/// 1-channel map in [0, 1] per pixel. P. Andersson et al., "FLIP: A Difference Evaluator for
/// Alternating Images", HPG 2020. Throws Error{input} when sizes differ, a value is NaN, or
/// `pixels_per_degree` is outside 1 to 10,000.
Image flip_map(const Image& reference_srgb, const Image& test_srgb,
               float pixels_per_degree = 67.0f);

/// Mean of flip_map.
double flip(const Image& reference_srgb, const Image& test_srgb, float pixels_per_degree = 67.0f);

}  // namespace gnomon
