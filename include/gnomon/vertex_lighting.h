#pragma once

#include <gnomon/lighting.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

/// Lighting that is kept at vertices, for lights and casters that stand still: occlusion times
/// attenuation, traced once, and "averaged L" bump mapping. S. Dietrich, "More on Shadowing",
/// developer's journal, GameDev.net, undated. techniques/vertex_occlusion/README.md tells of it.
namespace gnomon {

/// What a vertex keeps of a light.
struct VertexLight {
    /// Mean of the unit vectors towards what is seen of the light, weighted as its irradiance and
    /// made a unit vector again; zero when nothing is seen.
    Vec3 to_light_ws{0.0f};
    /// Visibility * attenuation: irradiance on a surface that faces the light / its strength
    /// (irradiance, intensity, or radiance * area).
    float share = 0.0f;
};

/// A point of a surface.
struct SurfacePoint {
    Vec3 position_ws{0.0f};
    Vec3 normal_ws{0.0f};  ///< unit vector; what is behind it is not seen
};

/// Irradiance at `p_ws` on a surface that faces the light / the light's strength, if nothing is in
/// the way and all of the light were at its centre. 1 for directional lights, else per m².
float light_attenuation(const Light& light, Vec3 p_ws);

/// A light's irradiance, intensity, or radiance * area: linear RGB.
Vec3 light_strength(const Light& light);

/// How far a light reaches that gives `least_irradiance` there: at its greatest intensity, so that
/// no vertex that was left out ever needs it.
float light_reach_m(Vec3 greatest_intensity, float least_irradiance);

/// Of each light at the points of a scene, in their order, lights one after the other. `samples`
/// rays each for lights with extent, 1 to 65,536; others take one. The same for any number of
/// threads. Throws Error{input} for lights or samples out of range, Error{cancelled}.
std::vector<std::vector<VertexLight>> trace_vertex_lights(const Scene& scene,
                                                          std::span<const SurfacePoint> points,
                                                          std::span<const Light> lights,
                                                          int samples, Progress& progress);

/// A vertex' light with the strength that the light has now.
struct StrongVertexLight {
    VertexLight light;
    Vec3 strength{0.0f};
};

/// Irradiance on the surface as it is without bumps: the colour that the vertex hands on.
Vec3 vertex_irradiance(std::span<const StrongVertexLight> lights, Vec3 normal_ws);

/// Orthonormal; columns of world_from_tangent.
struct TangentFrame {
    Vec3 tangent_ws{1, 0, 0}, bitangent_ws{0, 1, 0}, normal_ws{0, 0, 1};
};

/// Of the sum of all light vectors, each as long as the light is bright here, so that without light
/// the average is straight up and never is zero.
inline constexpr float kAveragedLightBias = 0.1f;

/// "Averaged L": the unit vector, in tangent space, from which light comes on average.
/// `full_luminance`: how bright a light is whose vector has the length 1, beside which the bias is
/// slight; above 0.
Vec3 averaged_light_ts(std::span<const StrongVertexLight> lights, const TangentFrame& frame,
                       float full_luminance);

/// The most by which a bump exaggerates the vertex' colour: what cards of the journal's time
/// doubled a product to.
inline constexpr float kMostBumpFactor = 2.0f;

/// The factor on the vertex' colour where the bump's unit normal is `bump_ts`: how much more or
/// less that faces the average light than the flat surface (0, 0, 1) does, for which it is 1; in
/// [0, kMostBumpFactor].
float bump_factor(Vec3 averaged_ts, Vec3 bump_ts);

struct VertexLightingOptions {
    double edge_m = 0.03;  ///< triangles are cut until no edge is longer; 0: the mesh as it is
    std::uint64_t most_vertices = 1'000'000;  ///< of triangles that are cut: else edges stay longer
    int samples = 32;                         ///< of trace_vertex_lights()
    /// Where a light with a place gives less, vertices are left out; 0: nowhere.
    float least_irradiance = 0.0f;
    bool walls = true;  ///< receivers take nothing from vertices that something stands before
    bool ignore_alpha = false;
};

/// The lights of a scene at its vertices. A vertex has values for each triangle that it belongs to
/// and for each side of that. Holds 32 bytes for each vertex and light.
class VertexLighting {
public:
    /// `lights` in their greatest strength. Throws Error{input} for lights or options out of range,
    /// Error{cancelled}.
    VertexLighting(const Scene& scene, std::span<const Light> lights,
                   const VertexLightingOptions& options, Progress& progress);
    ~VertexLighting();
    VertexLighting(VertexLighting&&) noexcept;
    VertexLighting& operator=(VertexLighting&&) noexcept;

    std::uint64_t vertices() const;
    double edge_m() const;  ///< of cut triangles, as afforded
    std::uint64_t memory_bytes() const;

    class Impl;
    const Impl& impl() const { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

enum class VertexShading {
    averaged,  ///< vertices' colours times the bump factor of their averaged light
    flat,      ///< the colours alone
};

/// light_picture() by what vertices keep: their diffuse light, interpolated over triangles; no
/// highlights. `lights` are those of `lighting` in the strength that they have now, nowhere above
/// that which they had. As materials have no normal maps, the bump is the shading normal of the
/// mesh's vertices above the triangle's own. Ambient and exposure are chosen as for the same lights
/// by light_picture(). Throws Error{input} for another scene, for lights at other places, of other
/// kinds or stronger, and for subtractive composition, which has no visibility here.
Image vertex_lit_picture(Context& context, const Frame& frame, const VertexLighting& lighting,
                         std::span<const Light> lights, const LightingOptions& options = {},
                         VertexShading shading = VertexShading::averaged);

}  // namespace gnomon
