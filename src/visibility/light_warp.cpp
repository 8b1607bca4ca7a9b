// Perspective maps in light space. The world is turned so that z points to the light and y along
// the view as the light sees it; then a perspective along y, whose eye is at some distance before
// the receivers, magnifies what is near. Light stays parallel to z, so nothing is ever behind the
// eye that can cast on a receiver, and depths are well-behaved: that is what sets these maps off
// from perspective shadow maps. Departure: the depth range is that of the receivers (fit_image).

#include "visibility/light_warp.h"

#include <glm/common.hpp>
#include <glm/ext/matrix_double4x4.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace gnomon {

namespace {

using DVec4 = glm::dvec4;

/// Less than this between view and light gains nothing: a tenth of a degree.
constexpr double kLeastSine = 2e-3;

/// The trapezoid's focus gets four fifths of the map, as Martin and Tan propose.
constexpr double kFocusShare = 0.8;

struct Bounds {
    DVec3 low{std::numeric_limits<double>::infinity()};
    DVec3 high{-std::numeric_limits<double>::infinity()};
    void include(DVec3 p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
};

/// Rotation, and the camera's eye to the origin.
glm::dmat4 light_from_world(DVec3 to_light, DVec3 forward, DVec3 eye) {
    const DVec3 along = glm::normalize(forward - glm::dot(forward, to_light) * to_light);
    const glm::dmat3 axes(glm::cross(along, to_light), along, to_light);
    const glm::dmat3 rotation = glm::transpose(axes);
    glm::dmat4 matrix(rotation);
    matrix[3] = DVec4(-(rotation * eye), 1.0);
    return matrix;
}

/// x, y, z to (x n, the perspective depth of y, z n) / (y's distance from the eye at y0 - n).
glm::dmat4 perspective_along_y(double near_m, double far_m, double y0, double z_middle) {
    glm::dmat4 matrix(0.0);
    matrix[0][0] = near_m;
    matrix[1][1] = (far_m + near_m) / (far_m - near_m);
    matrix[2][2] = near_m;
    matrix[1][3] = 1.0;
    const double eye_y = y0 - near_m;
    matrix[3] = {0.0, -matrix[1][1] * eye_y - 2.0 * far_m * near_m / (far_m - near_m),
                 -near_m * z_middle, -eye_y};
    return matrix;
}

/// Points between receivers, on each line as many in each octave of distances from the camera.
std::vector<DVec3> along_the_view(std::span<const DVec3> receivers_ws, const glm::dmat4& view) {
    constexpr double kShares[] = {1.0 / 6.0, 0.5, 5.0 / 6.0};
    const auto distance_m = [&](const DVec3& p) { return -(view * DVec4(p, 1.0)).z; };
    std::vector<DVec3> points_ws;
    for (std::size_t i = 0; i < receivers_ws.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const double from_m = distance_m(receivers_ws[i]), to_m = distance_m(receivers_ws[j]);
            for (const double share : kShares) {
                const double ratio = to_m / from_m;
                // Of the way, where the distance is from_m * ratio^share.
                const bool is_far = from_m > 0.0 && to_m > 0.0 && std::abs(ratio - 1.0) > 1e-6;
                const double way = is_far ? (std::pow(ratio, share) - 1.0) / (ratio - 1.0) : share;
                points_ws.push_back(glm::mix(receivers_ws[i], receivers_ws[j], way));
            }
        }
    }
    return points_ws;
}

/// A picture wants texels that grow with the distance, so that their logarithms count alike near
/// and far.
double mean_log_texel(const LightFit& fit, std::span<const DVec3> points_ws) {
    double sum = 0.0;
    for (const DVec3& p : points_ws)
        sum += std::log(static_cast<double>(fit.texel_size_m(Vec3(p))));
    return points_ws.empty() ? 0.0 : sum / static_cast<double>(points_ws.size());
}

}  // namespace

double warp_near_m(Warp warp, double focus, double near_m, double far_m, double sine,
                   double length_m) {
    if (warp == Warp::lispsm && sine > kLeastSine) {
        return (near_m + std::sqrt(near_m * far_m)) / sine;
    }
    if (warp == Warp::trapezoidal) {
        const double focus_m = sine * focus * (far_m - near_m);
        const double rest_m = kFocusShare * length_m - focus_m;
        if (focus_m > 0.0 && rest_m > 0.0) {
            return length_m * focus_m * (1.0 - kFocusShare) / rest_m;
        }
    }
    return std::numeric_limits<double>::infinity();
}

LightFit fit_warped(Warp warp, double focus, const DirectionalLight& light, const Camera& camera,
                    std::span<const DVec3> receivers_ws, const Box3& bounds, unsigned size_texels,
                    float margin_texels) {
    const DVec3 to_light = glm::normalize(DVec3(light.to_light_ws));
    const glm::dmat4 view(camera.view_from_world);
    const glm::dmat4 world_from_view = glm::inverse(view);
    const DVec3 forward = -DVec3(world_from_view[2]);
    const double sine = glm::length(glm::cross(forward, to_light));
    const auto uniform = [&] {
        return fit_directional(light, receivers_ws, bounds, size_texels, margin_texels);
    };
    // In a parallel view near and far want the same texels.
    const bool parallel = camera.ortho_height_m > 0.0f;
    if (warp == Warp::none || parallel || receivers_ws.empty() || sine < kLeastSine) {
        return uniform();
    }

    const glm::dmat4 light_space = light_from_world(to_light, forward, DVec3(world_from_view[3]));
    Bounds body, distances;
    for (const DVec3& p : receivers_ws) {
        body.include(DVec3(light_space * DVec4(p, 1.0)));
        distances.include(DVec3(-(view * DVec4(p, 1.0)).z));
    }
    const double length_m = body.high.y - body.low.y;
    // Of a triangle whose corners are farther away than this times the eye, rasterisers' floats
    // leave too few bits of the depth near it.
    constexpr double kFarthestCorner = 2000.0;
    const double least_m = static_cast<double>(bounds.diagonal()) / kFarthestCorner;
    const double strongest_m =
        std::max(warp_near_m(warp, focus, distances.low.x, distances.high.x, sine, length_m), 0.0);
    LightFit best = uniform();
    if (!(length_m > 0.0) || strongest_m < least_m) return best;

    // Ten times the length away a perspective is as good as none.
    constexpr double kFarthestEye = 10.0;
    const std::vector<DVec3> samples_ws = along_the_view(receivers_ws, view);
    double least_texel = mean_log_texel(best, samples_ws);
    constexpr double kWeaker = 2.0;
    for (double near_m = strongest_m; near_m < kFarthestEye * length_m; near_m *= kWeaker) {
        const glm::dmat4 warped = perspective_along_y(near_m, near_m + length_m, body.low.y,
                                                      0.5 * (body.low.z + body.high.z)) *
                                  light_space;
        const LightFit fit = fit_image(warped, receivers_ws, size_texels, margin_texels);
        const double texel = mean_log_texel(fit, samples_ws);
        if (texel >= least_texel) continue;
        least_texel = texel;
        best = fit;
    }
    return best;
}

}  // namespace gnomon
