#pragma once

#include <gnomon/scene.h>

#include "visibility/light_fit.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/ext/vector_double4.hpp>

#include <array>
#include <span>
#include <vector>

namespace gnomon::psm {

/// The camera in whose post-projective space a map is made: the view camera, or one behind it.
struct VirtualCamera {
    glm::dmat4 view_from_world{1.0};
    double near_m = 0.1, far_m = 1.0;
    double tan_half_x = 1.0, tan_half_y = 1.0;

    /// To a cube of x, y and z from -1 to 1.
    glm::dmat4 clip_from_world() const;
    /// The cube's corners in the world.
    std::vector<DVec3> corners_ws() const;
    /// What becomes the plane at infinity, through the eye: (unit normal to what is seen, offset).
    glm::dvec4 infinity_ws() const;
};

/// The view camera with the given near and far planes.
VirtualCamera virtual_camera(const Camera& camera, Extent size, DepthRange range);

/// Slid back by `slide_m`, its near plane still where it was: near and far receivers share the
/// texels more evenly.
VirtualCamera slid(const VirtualCamera& camera, double slide_m);

/// Slid back until all of `bounds` is in its view: the original cure for casters behind the camera.
VirtualCamera slid_behind(const VirtualCamera& camera, const Box3& bounds);

/// A projection along the light's rays: x / w and y / w of a point are its place in the map. w does
/// not change along a ray of a light at infinity, and grows along one of a light within the world,
/// so that no caster is behind it, were it behind the camera: it sees beyond infinity.
struct Projection {
    glm::dvec4 x, y, w;             ///< rows, to be multiplied with points of the world
    std::vector<DVec3> corners_ws;  ///< of a face: those of the square from -1 to 1 in the world

    /// With a row for depth, for fit_image().
    glm::dmat4 image_from_world(const glm::dvec4& depth) const;
    /// The four sides of the square from -1 to 1, as planes (unit normal inwards, offset).
    std::array<glm::dvec4, 4> planes() const;
    /// 0 at a light within the world, less than 0 behind the light's camera.
    double along(const DVec3& p_ws) const { return glm::dot(w, glm::dvec4(p_ws, 1.0)); }
};

/// `light_ws`: (direction to the light, 0) or (its position, 1). The light's camera looks along the
/// axis of the narrowest cone around what it must see, and is turned so that this fills its
/// smallest rectangle.
Projection light_camera(const VirtualCamera& camera, const glm::dvec4& light_ws,
                        std::span<const DVec3> seen_ws);

/// From the light to the faces of the cube that it does not see from outside: three to five, or all
/// six when it is inside. A point belongs to the face with the greatest w.
std::vector<Projection> cube_faces(const VirtualCamera& camera, const glm::dvec4& light_ws);

/// Axis of a cone around unit vectors that is as narrow as any, to a hundredth.
DVec3 narrowest_cone_axis(std::span<const DVec3> directions);

}  // namespace gnomon::psm
