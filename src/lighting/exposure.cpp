#include "lighting/exposure.h"

#include <algorithm>
#include <vector>

namespace gnomon::lighting {

namespace {

constexpr Vec3 kLuminance{0.2126f, 0.7152f, 0.0722f};  // Rec. 709
constexpr double kBrightShare = 0.98;
constexpr float kAmbientShare = 0.12f;  // of the mean light: shadows stay readable, and dark
constexpr float kBrightTarget = 0.85f;  // linear display value of the bright parts

}  // namespace

LightLevel measure(std::span<const Vec4> full) {
    std::vector<float> luminances;
    double irradiance = 0.0;
    for (const Vec4& pixel : full) {
        if (!(pixel.w > 0.0f)) continue;
        luminances.push_back(glm::dot(Vec3(pixel), kLuminance));
        irradiance += pixel.w;
    }
    if (luminances.empty()) return {};
    const auto bright =
        static_cast<std::ptrdiff_t>(kBrightShare * static_cast<double>(luminances.size() - 1));
    std::nth_element(luminances.begin(), luminances.begin() + bright, luminances.end());
    return {static_cast<float>(irradiance / static_cast<double>(luminances.size())),
            luminances[static_cast<std::size_t>(bright)]};
}

Vec3 default_ambient(const LightLevel& level) {
    return Vec3(kAmbientShare * level.mean_irradiance_over_pi);
}

float default_exposure(const LightLevel& level, Vec3 ambient) {
    const float bright = level.bright_luminance + glm::dot(ambient, kLuminance);
    return bright > 0.0f ? kBrightTarget / bright : 1.0f;
}

}  // namespace gnomon::lighting
