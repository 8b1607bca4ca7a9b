#pragma once

#include <gnomon/scene.h>

#include <vector>

namespace gnomon {

/// Corners of the part of `bounds` that the camera sees: a convex polytope, empty when it sees
/// none. All receivers of the frame lie within it.
std::vector<DVec3> visible_corners(const Camera& camera, Extent size, const Box3& bounds);

/// A light's map: where its texels are.
struct LightFit {
    Mat4 clip_from_world{1.0f};  ///< reversed Z: 1 nearest to the light
    float texel_m = 0.0f;        ///< side of a texel; of perspective maps at 1 m along the axis
    Vec3 eye_ws{0.0f};           ///< perspective maps: the light
    Vec3 axis_ws{0.0f};          ///< perspective maps: unit vector into the map
    bool perspective = false;

    /// Side of a texel at a point of the world, in metres.
    float texel_size_m(Vec3 p_ws) const;
};

/// A square map of `size_texels` whose texels cover what the camera sees of the scene and
/// `margin_texels` around it, with every caster between its near and far planes. W. Reeves et al.,
/// "Rendering Antialiased Shadows with Depth Maps", SIGGRAPH 1987, fitted to receivers.
LightFit fit_directional(const DirectionalLight& light, const Camera& camera, Extent size,
                         const Box3& bounds, unsigned size_texels, float margin_texels);

/// A square map around a spot's cone. Throws Error{input} when the cone is wider than 160°.
LightFit fit_spot(const SpotLight& light, const Box3& bounds, unsigned size_texels,
                  float margin_texels);

}  // namespace gnomon
