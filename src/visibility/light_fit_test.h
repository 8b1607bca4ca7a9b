#pragma once

/// What tests of light's maps share.

#include "visibility/light_fit.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/ext/vector_double4.hpp>

#include <cmath>
#include <random>

namespace gnomon::test {

inline constexpr unsigned kViews = 400;

inline constexpr unsigned kMapSize = 1024;
inline constexpr float kMarginTexels = 3.0f;

/// Greatest |x| and |y| of what must be within the margin.
inline constexpr double kInnerNdc = 1.0 - 2.0 * kMarginTexels / kMapSize;

/// A point in a light's map, and how far rounding the map's matrix to float may have moved it.
struct Projected {
    DVec3 ndc;
    DVec3 rounding;
};

inline Projected project(const LightFit& fit, DVec3 p_ws) {
    constexpr double kRoundoff = 1.0 / (1 << 24);
    const glm::dmat4 clip(fit.clip_from_world);
    const glm::dvec4 p = clip * glm::dvec4(p_ws, 1.0);
    glm::dvec4 rounding(0.0);
    for (int column = 0; column < 4; ++column) {
        rounding += glm::abs(clip[column]) * (column < 3 ? std::abs(p_ws[column]) : 1.0);
    }
    rounding *= kRoundoff;
    return {DVec3(p) / p.w,
            (DVec3(rounding) + glm::abs(DVec3(p)) / p.w * rounding.w) / std::abs(p.w)};
}

inline bool is_finite(const LightFit& fit) {
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            if (!std::isfinite(fit.clip_from_world[column][row])) return false;
        }
    }
    return true;
}

class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    float uniform(float low, float high) {
        return std::uniform_real_distribution<float>(low, high)(engine_);
    }
    Vec3 point(Vec3 low, Vec3 high) {
        return {uniform(low.x, high.x), uniform(low.y, high.y), uniform(low.z, high.z)};
    }
    Vec3 direction() {
        for (;;) {
            const Vec3 v = point(Vec3(-1), Vec3(1));
            const float length = glm::length(v);
            if (length > 0.1f && length < 1.0f) return v / length;
        }
    }

private:
    std::mt19937 engine_;
};

/// How many texels the map's image of p moves when p moves by `step_ws`.
inline double texels_moved(const LightFit& fit, DVec3 p_ws, DVec3 step_ws) {
    const DVec3 moved = project(fit, p_ws + step_ws).ndc - project(fit, p_ws).ndc;
    return 0.5 * kMapSize * std::hypot(moved.x, moved.y);
}

}  // namespace gnomon::test
