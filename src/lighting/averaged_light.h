#pragma once

// One direction of light a vertex, whatever the number of lights, for surfaces with bump maps. Pure
// mathematics but for the rays of bake_vertex_lights(): colours and bumps are the caller's.

#include <gnomon/light.h>
#include <gnomon/progress.h>

#include "trace/tracer.h"

#include <span>
#include <vector>

namespace gnomon::lighting {

/// What a vertex keeps of a light that stands still.
struct VertexLight {
    /// Mean of the unit vectors towards what is seen of the light, weighted as its irradiance and
    /// made a unit vector again; zero when nothing is seen.
    Vec3 to_light_ws{0.0f};
    /// Visibility * attenuation: irradiance on a surface that faces the light / its strength
    /// (irradiance, intensity, or radiance * area).
    float share = 0.0f;
};

/// Irradiance at `p_ws` on a surface that faces the light / the light's strength, if nothing is in
/// the way and all of the light were at its centre. 1 for directional lights, else per m².
float attenuation(const Light& light, Vec3 p_ws);

/// Of one light at `vertices`, in their order. `samples` rays each for lights with extent, others
/// take one. Throws Error{cancelled}.
std::vector<VertexLight> bake_vertex_lights(const trace::Tracer& tracer,
                                            std::span<const trace::Receiver> vertices,
                                            const Light& light, int samples, unsigned seed,
                                            Progress& progress);

/// How far a light reaches that gives `least_irradiance` there: at its greatest intensity, so that
/// no vertex that was left out ever needs it. Colours must not exceed what was told here.
float reach_m(Vec3 greatest_intensity, float least_irradiance);

/// A vertex' light with the strength that it has now.
struct Lit {
    VertexLight light;
    Vec3 strength{0.0f};  ///< linear RGB, in the unit of VertexLight::share
};

/// Irradiance on the surface as it is without bumps: the colour that the vertex hands on.
Vec3 vertex_irradiance(std::span<const Lit> lights, Vec3 normal_ws);

/// Orthonormal; columns of world_from_tangent.
struct TangentFrame {
    Vec3 tangent_ws{1, 0, 0}, bitangent_ws{0, 1, 0}, normal_ws{0, 0, 1};
};

/// Of the sum of all light vectors, each as long as the light is bright here, so that without light
/// the average is straight up and never is zero.
inline constexpr float kUpwardBias = 0.1f;

/// The unit vector, in tangent space, from which light comes on average. `full_luminance`: how
/// bright a light is whose vector has the length 1, beside which kUpwardBias is slight; above 0.
Vec3 averaged_light_ts(std::span<const Lit> lights, const TangentFrame& frame,
                       float full_luminance);

/// The most by which a bump exaggerates the vertex' colour: what cards of the journal's time
/// doubled a product to.
inline constexpr float kMostExaggeration = 2.0f;

/// The factor on the vertex' colour where the bump map's unit normal is `bump_ts`: how much more or
/// less that faces the average light than the flat surface (0, 0, 1) does, for which it is 1; in
/// [0, kMostExaggeration].
float bump_factor(Vec3 averaged_ts, Vec3 bump_ts);

}  // namespace gnomon::lighting
