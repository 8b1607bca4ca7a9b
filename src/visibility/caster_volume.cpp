#include "visibility/caster_volume.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>

namespace gnomon {

namespace {

/// Of the scene's size: what touches the receivers' volume by no more lies in its boundary, as does
/// a flat ground under everything, and casts no shadow into it.
constexpr double kTouching = 1e-6;

/// Of a texel's side, along the light: the bias moves receivers as far, past what is no higher.
constexpr double kTouchingTexels = 0.25;

}  // namespace

CasterVolume::CasterVolume(const LightFit& fit) {
    keep_within(fit, whole_map(fit.size_texels));
}

CasterVolume::CasterVolume(const LightFit& fit, DVec3 to_light_ws,
                           std::span<const glm::dvec4> planes_ws, double scene_size_m) {
    double texel_m = 0.0;
    if (fit.affine) {
        const TexelSteps steps = fit.texel_steps();
        texel_m = static_cast<double>(std::min(glm::length(steps.u_ws), glm::length(steps.v_ws)));
    }
    for (const glm::dvec4& plane : planes_ws) {
        const double cosine = glm::dot(DVec3(plane), glm::normalize(to_light_ws));
        if (cosine < 0.0) continue;
        sides_.push_back(
            {plane, std::max(kTouching * scene_size_m, kTouchingTexels * texel_m * cosine)});
    }
    keep_within(fit, whole_map(fit.size_texels));
}

CasterVolume::CasterVolume(const LightFit& fit, std::span<const glm::dvec4> planes_ws,
                           DVec3 light_ws) {
    for (const glm::dvec4& plane : planes_ws) {
        if (glm::dot(DVec3(plane), light_ws) + plane.w >= 0.0) sides_.push_back({plane});
    }
    keep_within(fit, whole_map(fit.size_texels));
}

// low <= x / w <= high, and y so, in the map's clip space, as planes of the world.
void CasterVolume::keep_within(const LightFit& fit, const TexelRect& texels) {
    const glm::dmat4 rows = glm::transpose(fit.clip_from_world);
    const double ndc_per_texel = 2.0 / fit.size_texels;
    const glm::dvec2 low = ndc_per_texel * glm::dvec2(texels.x, texels.y) - 1.0;
    const glm::dvec2 high = low + ndc_per_texel * glm::dvec2(texels.width, texels.height);
    for (const glm::dvec4& plane : {high.x * rows[3] - rows[0], rows[0] - low.x * rows[3],
                                    high.y * rows[3] - rows[1], rows[1] - low.y * rows[3]}) {
        const double length = glm::length(DVec3(plane));
        if (length > 0.0) sides_.push_back({plane / length});
    }
}

bool CasterVolume::holds(const Box3& box_ws) const {
    return std::ranges::all_of(
               sides_,
               [&](const Side& side) { return reach(side.plane, box_ws) > side.touching_m; }) &&
           receivers_.is_before_any(box_ws);
}

}  // namespace gnomon
