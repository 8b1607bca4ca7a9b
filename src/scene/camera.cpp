#include <gnomon/scene.h>

#include "base/check.h"

#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

// The near plane of cameras that we make, as a fraction of what they look at. With reversed Z in
// float the precision does not depend on it; it only must not cut what is close.
constexpr float kNearFraction = 1e-3f;

constexpr float kMinFovRad = radians(0.1f);
constexpr float kMaxFovRad = radians(179.0f);
constexpr float kRigidTolerance = 1e-3f;

}  // namespace

Vec3 Camera::eye_ws() const {
    return Vec3(glm::inverse(view_from_world)[3]);
}

Mat4 Camera::clip_from_view(Extent size) const {
    const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
    Mat4 clip(0.0f);
    if (ortho_height_m > 0.0f) {
        clip[0][0] = 2.0f / (ortho_height_m * aspect);
        clip[1][1] = -2.0f / ortho_height_m;
        clip[2][2] = 1.0f / (ortho_depth_m - near_m);
        clip[3][2] = ortho_depth_m / (ortho_depth_m - near_m);
        clip[3][3] = 1.0f;
        return clip;
    }
    const float scale = 1.0f / std::tan(0.5f * fov_y_rad);
    clip[0][0] = scale / aspect;
    clip[1][1] = -scale;
    clip[3][2] = near_m;
    clip[2][3] = -1.0f;
    return clip;
}

Mat4 Camera::clip_from_world(Extent size) const {
    return clip_from_view(size) * view_from_world;
}

void Camera::validate() const {
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            if (!std::isfinite(view_from_world[column][row])) {
                fail_input("camera \"{}\": view_from_world is not finite", name);
            }
        }
    }
    const glm::mat3 rotation(view_from_world);
    const glm::mat3 error = glm::transpose(rotation) * rotation - glm::mat3(1.0f);
    for (int column = 0; column < 3; ++column) {
        if (glm::length(error[column]) > kRigidTolerance) {
            fail_input("camera \"{}\": view_from_world is not rigid; it must only turn and move",
                       name);
        }
    }
    if (!(near_m > 0.0f) || !std::isfinite(near_m)) {
        fail_input("camera \"{}\": near_m is {}; it must be above 0", name, near_m);
    }
    if (ortho_height_m != 0.0f) {
        if (!(ortho_height_m > 0.0f) || !std::isfinite(ortho_height_m)) {
            fail_input("camera \"{}\": ortho_height_m is {}; it must be above 0", name,
                       ortho_height_m);
        }
        if (!(ortho_depth_m > near_m) || !std::isfinite(ortho_depth_m)) {
            fail_input("camera \"{}\": ortho_depth_m is {}; it must be above near_m = {}", name,
                       ortho_depth_m, near_m);
        }
    } else if (!(fov_y_rad >= kMinFovRad && fov_y_rad <= kMaxFovRad)) {
        fail_input("camera \"{}\": the field of view is {}°; it must be in [0.1, 179]", name,
                   degrees(fov_y_rad));
    }
}

Camera look_at(Vec3 eye_ws, Vec3 target_ws, float fov_y_rad) {
    const Vec3 forward = target_ws - eye_ws;
    const float distance_m = glm::length(forward);
    if (!(distance_m > 0.0f) || !std::isfinite(distance_m)) {
        fail_input("camera: eye ({}, {}, {}) and target ({}, {}, {}) must be finite and apart",
                   eye_ws.x, eye_ws.y, eye_ws.z, target_ws.x, target_ws.y, target_ws.z);
    }
    const bool vertical = std::abs(forward.y) > 0.9999f * distance_m;
    const Vec3 up = vertical ? Vec3(0.0f, 0.0f, -1.0f) : Vec3(0.0f, 1.0f, 0.0f);
    Camera camera;
    camera.view_from_world = glm::lookAtRH(eye_ws, target_ws, up);
    camera.fov_y_rad = fov_y_rad;
    camera.near_m = kNearFraction * distance_m;
    return camera;
}

Camera framing_camera(const Box3& bounds, Extent size) {
    constexpr float kFovRad = radians(45.0f);
    // Three-quarter view: a little more from the front than from the side, 25° above.
    const Vec3 from_target = normalize(Vec3(0.55f, 0.46f, 0.83f));
    const Box3 box = bounds.empty() ? Box3{Vec3(-1.0f), Vec3(1.0f)} : bounds;
    const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
    const float half_y = std::tan(0.5f * kFovRad);
    const float half_x = half_y * aspect;

    // The least distance at which every corner of the box is within the picture.
    const Vec3 right = normalize(glm::cross(Vec3(0, 1, 0), from_target));
    const Vec3 up = glm::cross(from_target, right);
    float distance_m = 0.0f;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p((corner & 1) != 0 ? box.max.x : box.min.x,
                     (corner & 2) != 0 ? box.max.y : box.min.y,
                     (corner & 4) != 0 ? box.max.z : box.min.z);
        const Vec3 d = p - box.center();
        const float side =
            std::max(std::abs(glm::dot(d, right)) / half_x, std::abs(glm::dot(d, up)) / half_y);
        distance_m = std::max(distance_m, side + glm::dot(d, from_target));
    }
    if (!(distance_m > 0.0f)) distance_m = 1.0f;  // a single point
    Camera camera = look_at(box.center() + distance_m * from_target, box.center(), kFovRad);
    camera.name = "framing";
    return camera;
}

}  // namespace gnomon
