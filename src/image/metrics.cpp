#include <gnomon/metrics.h>

#include "base/check.h"
#include "image/distance.h"

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

void check_image(std::string_view name, const Image& image, Extent size) {
    if (image.size() != size) {
        fail_input("compare: {} is {}x{} pixels but visibility is {}x{}; give images of one size",
                   name, image.width(), image.height(), size.width, size.height);
    }
    if (image.channels() != 1) {
        fail_input("compare: {} has {} channels; it must have 1", name, image.channels());
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

/// One kind of false pixel, light or shadow, and how far from the truth's other class its members
/// lie.
struct FalsePixels {
    std::vector<std::size_t> pixels;
    std::vector<std::uint8_t> other_class;  // 1 where the truth has the class they pretend to be

    bool lit;

    FalsePixels(std::size_t count, bool lit_ones) : other_class(count, 0), lit(lit_ones) {}
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
        return is_known(pixel) ? std::max(reach_m(pixel) / pixel_size_m_[pixel], kAliasing_px)
                               : stray_px_;
    }
    bool is_known(std::size_t pixel) const {
        return !texel_size_m_.empty() && is_size(texel_size_m_[pixel]) &&
               is_size(pixel_size_m_[pixel]);
    }
    double reach_m(std::size_t pixel) const { return reach_texels_ * texel_size_m_[pixel]; }

private:
    static bool is_size(float side_m) { return std::isfinite(side_m) && side_m > 0.0f; }

    std::span<const float> texel_size_m_;
    std::span<const float> pixel_size_m_;
    double reach_texels_;
    double stray_px_;
};

struct Fractions {
    double all = 0.0;
    double stray = 0.0;
    double artefact = 0.0;
};

Fractions judge(const FalsePixels& found, Extent size, double stray_px,
                const ArtefactThreshold& artefact_px, const EdgeProbe* edges, double pixels) {
    if (found.pixels.empty()) return {};
    const std::vector<double> squared = image::squared_distance_px2(found.other_class, size);
    std::size_t stray = 0;
    std::size_t artefacts = 0;
    std::vector<EdgeProbe::Place> doubtful;
    for (const std::size_t pixel : found.pixels) {
        const double distance_px = std::sqrt(squared[pixel]);
        stray += distance_px > stray_px ? 1 : 0;
        if (distance_px <= artefact_px.at(pixel)) continue;
        ++artefacts;
        if (artefact_px.is_known(pixel)) doubtful.push_back({pixel, artefact_px.reach_m(pixel)});
    }
    if (edges != nullptr && !doubtful.empty()) {
        const std::vector<std::uint8_t> explained = edges->find(doubtful, found.lit);
        if (explained.size() != doubtful.size()) {
            fail_input("compare: mask.edges answered {} of {} places; it must answer each",
                       explained.size(), doubtful.size());
        }
        artefacts -= static_cast<std::size_t>(std::ranges::count(explained, 1));
    }
    return {static_cast<double>(found.pixels.size()) / pixels, static_cast<double>(stray) / pixels,
            static_cast<double>(artefacts) / pixels};
}

void check_arguments(const Image& visibility, const Image& truth, const ComparisonMask& mask,
                     const Image& texel_size_m, float filter_radius_texels) {
    const Extent size = visibility.size();
    if (visibility.empty()) fail_input("compare: visibility is an empty image");
    check_image("visibility", visibility, size);
    check_image("truth", truth, size);
    check_image("mask.facing", mask.facing, size);
    if (!texel_size_m.empty()) {
        check_image("texel_size_m", texel_size_m, size);
        check_image("mask.pixel_size_m", mask.pixel_size_m, size);
    }
    check_finite("visibility", visibility);
    check_finite("truth", truth);
    if (!std::isfinite(filter_radius_texels) || filter_radius_texels < 0.0f) {
        fail_input("compare: filter_radius_texels is {}; it must be 0 or more",
                   filter_radius_texels);
    }
}

}  // namespace

Comparison compare(const Image& visibility, const Image& truth, const ComparisonMask& mask,
                   const Image& texel_size_m, float filter_radius_texels) {
    check_arguments(visibility, truth, mask, texel_size_m, filter_radius_texels);
    const std::size_t count = visibility.pixels().size();
    FalsePixels lit(count, true);
    FalsePixels shadow(count, false);
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
    const Fractions lit_share =
        judge(lit, visibility.size(), stray_px, artefact_px, mask.edges.get(), pixels);
    result.false_lit = lit_share.all;
    result.stray_lit = lit_share.stray;
    result.artefact_lit = lit_share.artefact;
    const Fractions shadow_share =
        judge(shadow, visibility.size(), stray_px, artefact_px, mask.edges.get(), pixels);
    result.false_shadow = shadow_share.all;
    result.stray_shadow = shadow_share.stray;
    result.artefact_shadow = shadow_share.artefact;
    return result;
}

}  // namespace gnomon
