// "Averaged L bump mapping": S. Dietrich, "More on Shadowing", developer's journal, GameDev.net,
// undated.
//
// The journal says that the bump term exaggerates or dims the vertex' colour, not how; here it is
// the ratio to the flat surface's term, which leaves flat surfaces as they are. Its light vectors
// are scaled by occlusion and attenuation; here by the light's luminance as well, as it says that
// the direction follows lights that are turned on and off. With lights that have extent a vector is
// the mean towards what is seen of the light.

#include "lighting/averaged_light.h"

#include <gnomon/vertex_lighting.h>

#include "base/check.h"
#include "base/parallel.h"
#include "trace/light_sample.h"

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

using trace::LightSample;
using trace::Receiver;

constexpr Vec3 kLuminance{0.2126f, 0.7152f, 0.0722f};  // Rec. 709
constexpr std::size_t kVerticesPerTask = 256;

float falloff(Vec3 from_light) {
    const float distance2_m2 = glm::dot(from_light, from_light);
    return distance2_m2 > 0.0f ? 1.0f / distance2_m2 : 0.0f;
}

/// The same of a light that shines to one side, by the cosine.
float one_sided(Vec3 from_light, Vec3 normal_ws) {
    const float height_m = glm::dot(from_light, normal_ws);
    return height_m > 0.0f ? falloff(from_light) * height_m / glm::length(from_light) : 0.0f;
}

struct Attenuation {
    Vec3 p_ws;

    float operator()(const DirectionalLight&) const { return 1.0f; }
    float operator()(const PointLight& light) const { return falloff(p_ws - light.position_ws); }
    float operator()(const SpotLight& light) const {
        const Vec3 from_light = p_ws - light.position_ws;
        const float length_m = glm::length(from_light);
        if (!(length_m > 0.0f)) return 0.0f;
        // Between the cones as KHR_lights_punctual has it.
        const float inner = std::cos(light.inner_angle_rad);
        const float outer = std::cos(light.outer_angle_rad);
        const float cosine = glm::dot(from_light, light.direction_ws) / length_m;
        const float cone =
            std::clamp((cosine - outer) / std::max(inner - outer, 1e-4f), 0.0f, 1.0f);
        return falloff(from_light) * cone * cone;
    }
    float operator()(const SphereLight& light) const { return falloff(p_ws - light.center_ws); }
    float operator()(const DiscLight& light) const {
        return one_sided(p_ws - light.center_ws, light.normal_ws);
    }
    float operator()(const RectLight& light) const {
        return one_sided(p_ws - light.center_ws,
                         normalize(glm::cross(light.half_u_ws, light.half_v_ws)));
    }
};

struct ToStrength {
    Vec3 operator()(const DirectionalLight& light) const { return light.irradiance; }
    Vec3 operator()(const PointLight& light) const { return light.intensity; }
    Vec3 operator()(const SpotLight& light) const { return light.intensity; }
    Vec3 operator()(const SphereLight& light) const {
        return light.radiance * (kPi * light.radius_m * light.radius_m);
    }
    Vec3 operator()(const DiscLight& light) const {
        return light.radiance * (kPi * light.radius_m * light.radius_m);
    }
    Vec3 operator()(const RectLight& light) const {
        return light.radiance *
               (4.0f * glm::length(light.half_u_ws) * glm::length(light.half_v_ws));
    }
};

Vec3 unit_or_zero(Vec3 v) {
    const float length = glm::length(v);
    return length > 0.0f ? v / length : Vec3(0.0f);
}

/// The rays of a vertex; those that start below its horizon count for nothing.
template <typename LightType>
VertexLight bake_vertex(const trace::Tracer& tracer, const Receiver& vertex, const LightType& light,
                        const trace::Strata& strata, std::uint32_t index, unsigned seed) {
    constexpr bool kDirectional = std::is_same_v<LightType, DirectionalLight>;
    std::vector<trace::ShadowRay> rays;
    std::vector<float> weights;
    for (int sample = 0; sample < strata.count(); ++sample) {
        const Vec2 jitter = trace::random_2d(index, static_cast<std::uint32_t>(sample), seed);
        const LightSample place = sample_light(vertex, light, strata.point(sample, jitter));
        if (!(place.weight > 0.0f)) continue;
        rays.push_back({&vertex, place.direction_ws, kDirectional});
        weights.push_back(place.weight);
    }
    std::vector<std::uint8_t> blocked(rays.size());
    tracer.blocked(rays, blocked);
    Vec3 towards(0.0f);
    float seen = 0.0f, all = 0.0f;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        all += weights[i];
        if (blocked[i] != 0) continue;
        seen += weights[i];
        towards += weights[i] * normalize(rays[i].direction_ws);
    }
    if (!(seen > 0.0f)) return {};
    return {unit_or_zero(towards), seen / all * light_attenuation(light, vertex.position_ws)};
}

float luminance(const StrongVertexLight& lit) {
    return lighting::luminance(lit.strength) * lit.light.share;
}

}  // namespace

float light_attenuation(const Light& light, Vec3 p_ws) {
    return std::visit(Attenuation{p_ws}, light);
}

namespace lighting {

std::vector<VertexLight> trace_vertex_light(const trace::Tracer& tracer,
                                            std::span<const Receiver> vertices, const Light& light,
                                            int samples, unsigned seed, Progress& progress) {
    std::vector<VertexLight> lights(vertices.size());
    const trace::Strata strata(has_extent(light) ? samples : 1);
    parallel_for(
        vertices.size(), kVerticesPerTask,
        [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                if (!trace::faces_light(vertices[i], light)) continue;
                lights[i] = std::visit(
                    [&](const auto& kind) {
                        return bake_vertex(tracer, vertices[i], kind, strata,
                                           static_cast<std::uint32_t>(i), seed);
                    },
                    light);
            }
        },
        "baking vertices", &progress);
    return lights;
}

float luminance(Vec3 linear_rgb) {
    return glm::dot(kLuminance, linear_rgb);
}

void check_samples(int samples) {
    constexpr int kMostSamples = 65536;
    if (samples < 1 || samples > kMostSamples)
        fail_input("vertex lighting: samples is {}; it must be 1 to {}", samples, kMostSamples);
}

}  // namespace lighting

std::vector<std::vector<VertexLight>> trace_vertex_lights(const Scene& scene,
                                                          std::span<const SurfacePoint> points,
                                                          std::span<const Light> lights,
                                                          int samples, Progress& progress) {
    lighting::check_samples(samples);
    for (const Light& light : lights)
        validate(light);
    const trace::Tracer tracer(scene, false, progress);
    std::vector<Receiver> vertices;
    for (const SurfacePoint& point : points)
        vertices.push_back({point.position_ws, point.normal_ws, {trace::kNoSurface, 0}});
    std::vector<std::vector<VertexLight>> result;
    for (const Light& light : lights) {
        result.push_back(lighting::trace_vertex_light(tracer, vertices, light, samples,
                                                      lighting::kVertexSeed, progress));
    }
    return result;
}

Vec3 light_strength(const Light& light) {
    return std::visit(ToStrength{}, light);
}

float light_reach_m(Vec3 greatest_intensity, float least_irradiance) {
    const float greatest =
        std::max({greatest_intensity.x, greatest_intensity.y, greatest_intensity.z});
    return std::sqrt(greatest / least_irradiance);
}

Vec3 vertex_irradiance(std::span<const StrongVertexLight> lights, Vec3 normal_ws) {
    Vec3 irradiance(0.0f);
    for (const StrongVertexLight& lit : lights) {
        const float cosine = std::max(0.0f, glm::dot(normal_ws, lit.light.to_light_ws));
        irradiance += lit.strength * (lit.light.share * cosine);
    }
    return irradiance;
}

Vec3 averaged_light_ts(std::span<const StrongVertexLight> lights, const TangentFrame& frame,
                       float full_luminance) {
    Vec3 sum_ws(0.0f);
    for (const StrongVertexLight& lit : lights)
        sum_ws += luminance(lit) / full_luminance * lit.light.to_light_ws;
    const Vec3 sum_ts(glm::dot(frame.tangent_ws, sum_ws), glm::dot(frame.bitangent_ws, sum_ws),
                      glm::dot(frame.normal_ws, sum_ws));
    // Lights that a vertex sees are above its face, so that the sum has no negative height but by
    // a normal that is not the face's.
    return normalize(Vec3(sum_ts.x, sum_ts.y, std::max(sum_ts.z, 0.0f) + kAveragedLightBias));
}

float bump_factor(Vec3 averaged_ts, Vec3 bump_ts) {
    const float bumped = std::max(0.0f, glm::dot(bump_ts, averaged_ts));
    return std::min(bumped / averaged_ts.z, kMostBumpFactor);
}

}  // namespace gnomon
