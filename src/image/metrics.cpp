#include <gnomon/metrics.h>

#include "base/check.h"
#include "image/distance.h"

#include <glm/common.hpp>
#include <glm/ext/vector_double2.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace gnomon {

namespace {

// The classes of the truth and the margins that make a pixel false (metrics.h).
constexpr float kLitAbove = 0.5f;
constexpr float kSurelyLit = 0.9f;
constexpr float kSurelyShadow = 0.1f;

constexpr double kStrayFloor_px = 2.0;
constexpr double kStrayShareOfHeight = 0.01;

// A sample may be off by half a texel at either end of an edge and by half in the filter's
// centring.
constexpr double kTexelsBeyondFilter = 1.5;

// An edge moved by less than a pixel makes false pixels that touch the other class, at up to √2
// pixels on the diagonal; the next distance there is is 2. However fine the texels, these are
// aliasing.
constexpr double kAliasing_px = 1.5;

// Neighbours of which a texel's slant differs by more than this part are of another plane.
constexpr double kSameSlant = 0.5;

void check_image(std::string_view name, const Image& image, Extent size, int channels = 1) {
    if (image.size() != size) {
        fail_input("compare: {} is {}x{} pixels but visibility is {}x{}; give images of one size",
                   name, image.width(), image.height(), size.width, size.height);
    }
    if (image.channels() != channels) {
        fail_input("compare: {} has {} channels; it must have {}", name, image.channels(),
                   channels);
    }
}

void check_finite(std::string_view name, const Image& image) {
    const std::span<const float> values = image.pixels();
    const auto bad = std::find_if_not(values.begin(), values.end(),
                                      [](float value) { return std::isfinite(value); });
    if (bad == values.end()) return;
    const std::size_t index = static_cast<std::size_t>(bad - values.begin());
    fail_input("compare: {} is {} at pixel ({}, {}); it must be finite", name, *bad,
               index % image.width(), index / image.width());
}

/// One kind of false pixel, and how far from the truth's other class its members lie.
struct FalsePixels {
    std::vector<std::size_t> pixels;
    std::vector<std::uint8_t> other_class;  // 1 where the truth has the class they pretend to be

    explicit FalsePixels(std::size_t count) : other_class(count, 0) {}
};

/// The distance in pixels beyond which a false pixel is an artefact.
class ArtefactThreshold {
public:
    ArtefactThreshold(const Image& texel_size_m, const Image& pixel_size_m, double filter_radius,
                      double stray_px)
        : texel_size_m_(texel_size_m.pixels()),
          pixel_size_m_(pixel_size_m.pixels()),
          reach_texels_(filter_radius + kTexelsBeyondFilter),
          stray_px_(stray_px) {}

    double at(std::size_t pixel) const {
        if (texel_size_m_.empty()) return stray_px_;
        const double texel_m = texel_size_m_[pixel];
        const double pixel_m = pixel_size_m_[pixel];
        const bool known =
            std::isfinite(texel_m) && std::isfinite(pixel_m) && texel_m > 0.0 && pixel_m > 0.0;
        return known ? std::max(reach_texels_ * texel_m / pixel_m, kAliasing_px) : stray_px_;
    }

private:
    std::span<const float> texel_size_m_;
    std::span<const float> pixel_size_m_;
    double reach_texels_;
    double stray_px_;
};

/// Texels as they lie on receivers that the light meets aslant.
class Slants {
public:
    Slants(const Image& texel_slant_px, double filter_radius)
        : slants_px_(texel_slant_px.pixels()),
          size_(texel_slant_px.size()),
          reach_texels_(filter_radius + kTexelsBeyondFilter) {}

    /// Whether, going along the light from a false pixel by no more than its texels reach and
    /// staying on its plane, some pixel is as near to the other class as `threshold_px`.
    bool explain(std::size_t pixel, std::span<const double> squared_px2,
                 double threshold_px) const {
        if (slants_px_.empty()) return false;
        const glm::dvec2 reach_px = reach_texels_ * slant_px(pixel);
        const double steps = std::ceil(glm::length(reach_px));
        if (!(steps > threshold_px) || !std::isfinite(steps)) return false;
        const glm::dvec2 from(static_cast<double>(pixel % size_.width),
                              static_cast<double>(pixel / size_.width));
        for (const double side : {-1.0, 1.0}) {
            for (double k = 1.0; k <= steps; ++k) {
                const glm::dvec2 at = glm::round(from + side * k / steps * reach_px);
                if (!(at.x >= 0.0 && at.x < size_.width && at.y >= 0.0 && at.y < size_.height))
                    break;
                const std::size_t there =
                    static_cast<std::size_t>(at.y) * size_.width + static_cast<std::size_t>(at.x);
                if (!alike(pixel, there)) break;
                if (std::sqrt(squared_px2[there]) <= threshold_px) return true;
            }
        }
        return false;
    }

private:
    glm::dvec2 slant_px(std::size_t pixel) const {
        return {slants_px_[2 * pixel], slants_px_[2 * pixel + 1]};
    }
    bool alike(std::size_t a, std::size_t b) const {
        return glm::length(slant_px(b) - slant_px(a)) <= kSameSlant * glm::length(slant_px(a));
    }

    std::span<const float> slants_px_;
    Extent size_;
    double reach_texels_;
};

struct Fractions {
    double all = 0.0;
    double stray = 0.0;
    double artefact = 0.0;
};

Fractions judge(const FalsePixels& found, Extent size, double stray_px,
                const ArtefactThreshold& artefact_px, const Slants& slants, double pixels) {
    if (found.pixels.empty()) return {};
    const std::vector<double> squared = image::squared_distance_px2(found.other_class, size);
    std::size_t stray = 0;
    std::size_t artefacts = 0;
    for (const std::size_t pixel : found.pixels) {
        const double distance_px = std::sqrt(squared[pixel]);
        stray += distance_px > stray_px ? 1 : 0;
        const double near_px = artefact_px.at(pixel);
        const bool near = distance_px <= near_px || slants.explain(pixel, squared, near_px);
        artefacts += near ? 0 : 1;
    }
    return {static_cast<double>(found.pixels.size()) / pixels, static_cast<double>(stray) / pixels,
            static_cast<double>(artefacts) / pixels};
}

void check_arguments(const Image& visibility, const Image& truth, const ComparisonMask& mask,
                     const Image& texel_size_m, float filter_radius_texels,
                     const Image& texel_slant_px) {
    const Extent size = visibility.size();
    if (visibility.empty()) fail_input("compare: visibility is an empty image");
    check_image("visibility", visibility, size);
    check_image("truth", truth, size);
    check_image("mask.facing", mask.facing, size);
    if (!texel_size_m.empty()) {
        check_image("texel_size_m", texel_size_m, size);
        check_image("mask.pixel_size_m", mask.pixel_size_m, size);
    }
    if (!texel_slant_px.empty()) check_image("texel_slant_px", texel_slant_px, size, 2);
    check_finite("visibility", visibility);
    check_finite("truth", truth);
    if (!std::isfinite(filter_radius_texels) || filter_radius_texels < 0.0f) {
        fail_input("compare: filter_radius_texels is {}; it must be 0 or more",
                   filter_radius_texels);
    }
}

}  // namespace

Comparison compare(const Image& visibility, const Image& truth, const ComparisonMask& mask,
                   const Image& texel_size_m, float filter_radius_texels,
                   const Image& texel_slant_px) {
    check_arguments(visibility, truth, mask, texel_size_m, filter_radius_texels, texel_slant_px);
    const std::size_t count = visibility.pixels().size();
    FalsePixels lit(count);
    FalsePixels shadow(count);
    Comparison result;
    double absolute_sum = 0.0;
    double square_sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        if (!(mask.facing.pixels()[i] > 0.0f)) continue;
        const float v = visibility.pixels()[i];
        const float t = truth.pixels()[i];
        const double difference = static_cast<double>(v) - t;
        absolute_sum += std::abs(difference);
        square_sum += difference * difference;
        ++result.pixels;
        (t > kLitAbove ? lit : shadow).other_class[i] = 1;
        if (t < kSurelyShadow && v > kLitAbove) lit.pixels.push_back(i);
        if (t > kSurelyLit && v < kLitAbove) shadow.pixels.push_back(i);
    }
    if (result.pixels == 0) return result;

    const double pixels = static_cast<double>(result.pixels);
    result.mae = absolute_sum / pixels;
    result.rmse = std::sqrt(square_sum / pixels);
    const double stray_px = std::max(kStrayFloor_px, kStrayShareOfHeight * visibility.height());
    const ArtefactThreshold artefact_px(texel_size_m, mask.pixel_size_m, filter_radius_texels,
                                        stray_px);
    const Slants slants(texel_slant_px, filter_radius_texels);
    const Fractions lit_share =
        judge(lit, visibility.size(), stray_px, artefact_px, slants, pixels);
    result.false_lit = lit_share.all;
    result.stray_lit = lit_share.stray;
    result.artefact_lit = lit_share.artefact;
    const Fractions shadow_share =
        judge(shadow, visibility.size(), stray_px, artefact_px, slants, pixels);
    result.false_shadow = shadow_share.all;
    result.stray_shadow = shadow_share.stray;
    result.artefact_shadow = shadow_share.artefact;
    return result;
}

}  // namespace gnomon
