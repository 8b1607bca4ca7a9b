#include "report/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::report {

namespace {

// The scale's ends in OKLCh. Both sides share the lightnesses, and the hues lie on either side of
// the confusion lines of protanopes, deuteranopes and tritanopes.
constexpr float kNeutralLightness = 0.96f;
constexpr float kEndLightness = 0.50f;
constexpr float kTooDarkHue = radians(257.0f);
constexpr float kTooDarkChroma = 0.17f;
constexpr float kTooBrightHue = radians(47.0f);
constexpr float kTooBrightChroma = 0.135f;
// Chroma grows faster than the difference, so that faint differences have a hue at all.
constexpr float kChromaExponent = 0.7f;

constexpr float kHatchLight = 0.78f;  // sRGB greys of pixels that are not judged
constexpr float kHatchDark = 0.70f;
constexpr unsigned kHatchPerHeight = 60;  // stripes per image height, so that thumbnails show them
constexpr unsigned kHatchLeastPeriod_px = 6;

/// OKLab to linear sRGB, the published matrices.
Vec3 linear_from_oklab(float lightness, float a, float b) {
    const float l = lightness + 0.3963377774f * a + 0.2158037573f * b;
    const float m = lightness - 0.1055613458f * a - 0.0638541728f * b;
    const float s = lightness - 0.0894841775f * a - 1.2914855480f * b;
    const Vec3 lms(l * l * l, m * m * m, s * s * s);
    return {glm::dot(lms, Vec3(4.0767416621f, -3.3077115913f, 0.2309699292f)),
            glm::dot(lms, Vec3(-1.2684380046f, 2.6097574011f, -0.3413193965f)),
            glm::dot(lms, Vec3(-0.0041960863f, -0.7034186147f, 1.7076147010f))};
}

void set_rgb(Image& image, unsigned x, unsigned y, Vec3 color) {
    for (int channel = 0; channel < 3; ++channel)
        image.at(x, y, channel) = color[channel];
}

}  // namespace

Vec3 difference_color(float difference) {
    const float amount = std::min(std::abs(difference), 1.0f);
    const float hue = difference < 0.0f ? kTooDarkHue : kTooBrightHue;
    const float full_chroma = difference < 0.0f ? kTooDarkChroma : kTooBrightChroma;
    const float chroma = full_chroma * std::pow(amount, kChromaExponent);
    const float lightness = kNeutralLightness + (kEndLightness - kNeutralLightness) * amount;
    const Vec3 linear =
        linear_from_oklab(lightness, chroma * std::cos(hue), chroma * std::sin(hue));
    Vec3 srgb;
    for (int i = 0; i < 3; ++i)
        srgb[i] = srgb_from_linear(std::clamp(linear[i], 0.0f, 1.0f));
    return srgb;
}

std::string difference_gradient_css() {
    constexpr int kStopsPerSide = 10;
    std::string stops;
    for (int i = -kStopsPerSide; i <= kStopsPerSide; ++i) {
        const Vec3 color = 255.0f * difference_color(static_cast<float>(i) / kStopsPerSide);
        stops += fmt::format("{}rgb({:.0f} {:.0f} {:.0f})", stops.empty() ? "" : ", ", color.x,
                             color.y, color.z);
    }
    return stops;
}

Image difference_image(const Image& visibility, const Image& truth, const Image& facing) {
    constexpr int kSteps = 255;  // a step is what an 8-bit visibility can tell apart
    std::array<Vec3, 2 * kSteps + 1> palette;
    for (int i = -kSteps; i <= kSteps; ++i) {
        palette[static_cast<std::size_t>(i + kSteps)] =
            difference_color(static_cast<float>(i) / kSteps);
    }
    const unsigned period_px = std::max(kHatchLeastPeriod_px, truth.height() / kHatchPerHeight);
    Image image(truth.size(), 3);
    for (unsigned y = 0; y < image.height(); ++y) {
        for (unsigned x = 0; x < image.width(); ++x) {
            if (!(facing.at(x, y) > 0.0f)) {
                const bool light = (x + y) % period_px < period_px / 2;
                set_rgb(image, x, y, Vec3(light ? kHatchLight : kHatchDark));
                continue;
            }
            const float difference = std::clamp(visibility.at(x, y) - truth.at(x, y), -1.0f, 1.0f);
            const long step = std::lround(difference * kSteps);
            set_rgb(image, x, y, palette[static_cast<std::size_t>(step + kSteps)]);
        }
    }
    return image;
}

Window worst_window(const Image& visibility, const Image& truth, const Image& facing,
                    unsigned side) {
    const auto [width, height] = truth.size();
    // sums[y * stride + x]: over the pixels above and left of (x, y). F. C. Crow, "Summed-area
    // tables for texture mapping", 1984.
    const std::size_t stride = width + 1;
    std::vector<double> sums(stride * (height + 1), 0.0);
    for (unsigned y = 0; y < height; ++y) {
        double row = 0.0;
        for (unsigned x = 0; x < width; ++x) {
            if (facing.at(x, y) > 0.0f) {
                row += std::abs(static_cast<double>(visibility.at(x, y)) - truth.at(x, y));
            }
            sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1] + row;
        }
    }
    Window best{0, 0, std::min(side, width), std::min(side, height), 0.0};
    for (unsigned y = 0; y + best.height <= height; ++y) {
        for (unsigned x = 0; x + best.width <= width; ++x) {
            const double* top = &sums[y * stride + x];
            const double* bottom = top + best.height * stride;
            const double sum = bottom[best.width] - bottom[0] - top[best.width] + top[0];
            // Differences of sums carry rounding errors: a tie must not move the window.
            constexpr double kTie = 1e-9;
            if (sum > best.error_sum * (1.0 + kTie) + kTie) {
                best.x = x;
                best.y = y;
                best.error_sum = sum;
            }
        }
    }
    return best;
}

Image worst_strip(const Image& visibility, const Image& truth, const Image& difference,
                  const Window& window, unsigned scale, unsigned gap) {
    const std::array<const Image*, 3> parts = {&truth, &visibility, &difference};
    const auto count = static_cast<unsigned>(parts.size());
    const unsigned step = window.width * scale + gap;
    Image strip({count * step - gap, window.height * scale}, 4);
    for (unsigned part = 0; part < count; ++part) {
        const Image& source = *parts[part];
        for (unsigned y = 0; y < strip.height(); ++y) {
            for (unsigned x = 0; x < window.width * scale; ++x) {
                for (int channel = 0; channel < 3; ++channel) {
                    strip.at(part * step + x, y, channel) =
                        source.at(window.x + x / scale, window.y + y / scale,
                                  source.channels() == 1 ? 0 : channel);
                }
                strip.at(part * step + x, y, 3) = 1.0f;
            }
        }
    }
    return strip;
}

}  // namespace gnomon::report
