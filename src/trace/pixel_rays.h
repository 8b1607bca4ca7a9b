#pragma once

#include <gnomon/scene.h>

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/matrix.hpp>

#include <cmath>

namespace gnomon::trace {

/// Rays through points of a camera's picture, in double.
class PixelRays {
public:
    PixelRays(const Camera& camera, Extent size)
        : world_from_view_(glm::inverse(glm::dmat4(camera.view_from_world))),
          parallel_(camera.ortho_height_m > 0.0f),
          half_height_(parallel_ ? 0.5 * camera.ortho_height_m : std::tan(0.5 * camera.fov_y_rad)),
          size_(size) {}

    struct Ray {
        DVec3 origin_ws, direction_ws;  ///< of length 1 along the view axis: t is the view depth
    };
    /// From the upper left corner of the picture, in pixels: their centres are at halves.
    Ray operator()(double x_px, double y_px) const {
        const double side = 2.0 * half_height_ / size_.height;  // of a pixel, at view depth 1
        const glm::dvec4 place((x_px - 0.5 * size_.width) * side,
                               (0.5 * size_.height - y_px) * side, parallel_ ? 0.0 : -1.0,
                               parallel_ ? 1.0 : 0.0);
        const DVec3 in_world(world_from_view_ * place);
        if (parallel_) return {in_world, -DVec3(world_from_view_[2])};
        return {DVec3(world_from_view_[3]), in_world};
    }

private:
    glm::dmat4 world_from_view_;
    bool parallel_;
    double half_height_;  ///< in metres if parallel, else at view depth 1
    Extent size_;
};

}  // namespace gnomon::trace
