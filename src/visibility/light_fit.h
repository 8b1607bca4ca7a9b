#pragma once

#include <gnomon/scene.h>

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/ext/vector_double4.hpp>

#include <limits>
#include <span>
#include <vector>

namespace gnomon {

/// Distances from the camera, along its axis, between which something is of interest.
struct DepthRange {
    double near_m = 0.0;
    double far_m = std::numeric_limits<double>::infinity();
};

/// The number in the picture's depth buffer at a distance along the camera's axis, and back.
float depth_at(const Camera& camera, Extent size, double distance_m);
double distance_at(const Camera& camera, Extent size, float depth);

/// Corners of the part of `bounds` that the camera sees between two distances, on the inner side of
/// all planes (unit normal inwards, offset) of `within`: a convex polytope, empty when there is
/// none. All receivers of the frame that are there lie within it.
std::vector<DVec3> visible_corners(const Camera& camera, Extent size, const Box3& bounds,
                                   DepthRange range = {}, std::span<const glm::dvec4> within = {});

/// Planes (unit normal inwards, offset) around the same part of `bounds`; none when it is empty.
std::vector<glm::dvec4> visible_planes(const Camera& camera, Extent size, const Box3& bounds,
                                       DepthRange range = {});

/// How far a box reaches to the inner side of such a plane, in metres.
double reach(const glm::dvec4& plane, const Box3& box);

/// Texels along a side of a map between its margins; half of it at least.
double used_texels(unsigned size_texels, float margin_texels);

/// From a texel to the next ones, in metres of the world, across the light.
struct TexelSteps {
    Vec3 u_ws{0.0f}, v_ws{0.0f};
};

/// A light's square map: where its texels are.
struct LightFit {
    glm::dmat4 clip_from_world{1.0};  ///< reversed Z: 1 nearest to the light
    unsigned size_texels = 1;         ///< of a side
    bool affine = true;               ///< all texels are of one size
    /// Casters nearer than the near plane are clamped to it, as a light at infinity wants; else
    /// they are not seen.
    bool clamps_near = true;
    double far_m = 0.0;  ///< of a light within the world: to the farthest of the scene; else 0
    /// Of such a light: x and y are at right angles, over the distance along the axis. Else
    /// contents hold distances along the axis, not from the light.
    bool is_view = false;

    /// Side of a texel at a point of the world, in metres, across the light; the longer one where
    /// the map stretches it. 0 behind a light.
    float texel_size_m(Vec3 p_ws) const;
    /// Of an affine map of a light at infinity.
    TexelSteps texel_steps() const;
};

/// A map whose texels cover `receivers_ws` and `margin_texels` around them, with every caster of
/// the scene of these `bounds` between its near and far planes: the smallest rectangle that holds
/// them across the light. W. Reeves et al., "Rendering Antialiased Shadows with Depth Maps",
/// SIGGRAPH 1987, fitted to receivers.
LightFit fit_directional(const DirectionalLight& light, std::span<const DVec3> receivers_ws,
                         const Box3& bounds, unsigned size_texels, float margin_texels);

/// A map around the sphere around all of the camera's frustum in `range`, whose texels stay where
/// they are in the world while the camera moves and turns: M. Valient, "Stable Rendering of
/// Cascaded Shadow Maps", ShaderX6, 2008. It moves by `step_texels` at once, for which it spends as
/// many of its texels.
LightFit fit_directional_stable(const DirectionalLight& light, const Camera& camera, Extent size,
                                DepthRange range, const Box3& bounds, unsigned size_texels,
                                float margin_texels, int step_texels = 1);

/// A map around the image of `receivers_ws`, none of which is behind the image's eye. Its depth
/// range is theirs: casters above it are clamped to the near plane, which keeps them in front of
/// everything and spends no precision on them.
LightFit fit_image(const glm::dmat4& image_from_world, std::span<const DVec3> receivers_ws,
                   unsigned size_texels, float margin_texels);

}  // namespace gnomon
