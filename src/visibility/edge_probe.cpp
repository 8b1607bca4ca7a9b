#include "visibility/edge_probe.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

namespace gnomon {

namespace {

/// Around a receiver: an edge that lies as far as half its reach is between some of them.
constexpr int kPoints = 64;

/// Places that are looked at together: enough for all threads.
constexpr std::size_t kBatch = 1024;

/// Of the light on a plane, at 89.4°: steeper ones are followed by no filter, which look up what is
/// beside them instead (map_bias.glsl).
constexpr float kMinCosine = 0.01f;

/// Of the reach: what hides a point of the plane less far above it may be a neighbour on a surface
/// that bends, up to 18° within the reach. Of sharper hollows the map's texels mix both sides.
constexpr float kRaised = 1.0f / 3.0f;

/// The light without extent, where it has a middle that stands for it.
std::optional<Light> middle_of(const Light& light) {
    if (!has_extent(light)) return light;
    if (const auto* sphere = std::get_if<SphereLight>(&light))
        return PointLight{.position_ws = sphere->center_ws};
    const auto* sun = std::get_if<DirectionalLight>(&light);
    if (sun == nullptr) return std::nullopt;
    DirectionalLight middle = *sun;
    middle.angular_diameter_rad = 0.0f;
    return middle;
}

Vec3 direction_to(const Light& middle, Vec3 p_ws) {
    if (const auto* sun = std::get_if<DirectionalLight>(&middle)) return sun->to_light_ws;
    if (const auto* spot = std::get_if<SpotLight>(&middle))
        return glm::normalize(spot->position_ws - p_ws);
    return glm::normalize(std::get<PointLight>(middle).position_ws - p_ws);
}

/// Points that fill a disc of radius 1 evenly. H. Vogel, "A Better Way to Construct the Sunflower
/// Head", Mathematical Biosciences 44, 1979.
Vec2 on_disc(int point) {
    const float radius = std::sqrt((static_cast<float>(point) + 0.5f) / kPoints);
    const float angle_rad = static_cast<float>(point) * std::numbers::pi_v<float> *
                            (3.0f - std::sqrt(5.0f));  // the golden angle
    return radius * Vec2(std::cos(angle_rad), std::sin(angle_rad));
}

class RayEdgeProbe : public EdgeProbe {
public:
    RayEdgeProbe(std::shared_ptr<const trace::Tracer> tracer,
                 std::span<const trace::Receiver> receivers, const Light& middle)
        : tracer_(std::move(tracer)),
          receivers_(receivers.begin(), receivers.end()),
          middle_(middle) {}

    std::vector<std::uint8_t> find(std::span<const Place> places, bool lit) const override {
        std::vector<std::uint8_t> found;
        for (std::size_t first = 0; first < places.size(); first += kBatch) {
            const auto batch = places.subspan(first, std::min(kBatch, places.size() - first));
            const std::vector<std::uint8_t> some = find_in(batch, lit);
            found.insert(found.end(), some.begin(), some.end());
        }
        return found;
    }

private:
    std::vector<std::uint8_t> find_in(std::span<const Place> places, bool lit) const {
        std::vector<trace::Receiver> points;
        for (const Place& place : places)
            add_points(place, lit, points);
        const std::size_t each = points.size() / places.size();
        std::vector<float> seen(points.size());
        Progress silent;
        tracer_->visibility(points,
                            {static_cast<unsigned>(each), static_cast<unsigned>(places.size())},
                            middle_, 1, 1, seen, silent);
        std::vector<std::uint8_t> found(places.size(), 0);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (points[i].exists() && (seen[i] > 0.0f) == lit) found[i / each] = 1;
        }
        return found;
    }

    /// Where light is looked for: beside the receiver, where its shadow is thin, and on its plane,
    /// where the shadow ends. Shadow: on the plane alone, and a little above; beside a plane that
    /// the light grazes, on the side that it lights.
    void add_points(const Place& place, bool lit, std::vector<trace::Receiver>& points) const {
        const trace::Receiver& receiver = receivers_[place.pixel];
        const auto reach_m = static_cast<float>(place.reach_m);
        const Vec3 to_light = direction_to(middle_, receiver.position_ws);
        const Vec3 aside = std::abs(to_light.y) < 0.7f ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
        const Vec3 u_ws = glm::normalize(glm::cross(aside, to_light));
        const Vec3 v_ws = glm::cross(to_light, u_ws);
        const float cosine = glm::dot(receiver.normal_ws, to_light);
        const bool is_grazed = cosine < kMinCosine;
        const auto add = [&](Vec3 offset_ws, Vec3 normal_ws) {
            points.push_back(receiver);
            points.back().position_ws += offset_ws;
            points.back().normal_ws = normal_ws;
        };
        for (int i = 0; i < kPoints; ++i) {
            const Vec2 at_m = reach_m * on_disc(i);
            const Vec3 offset_ws = at_m.x * u_ws + at_m.y * v_ws;
            const float height_m = glm::dot(receiver.normal_ws, offset_ws);
            // Beside the receiver is no surface that could turn away from the light.
            if (lit || is_grazed) add(lit || height_m > 0.0f ? offset_ws : -offset_ws, to_light);
            const float above_m = lit ? 0.0f : kRaised * reach_m;
            if (!is_grazed)
                add(offset_ws + (above_m - height_m / cosine) * to_light, receiver.normal_ws);
            else if (lit)
                points.emplace_back();  // no receiver: places of one call have as many points
        }
    }

    std::shared_ptr<const trace::Tracer> tracer_;
    std::vector<trace::Receiver> receivers_;
    Light middle_;
};

}  // namespace

std::shared_ptr<const EdgeProbe> make_edge_probe(std::shared_ptr<const trace::Tracer> tracer,
                                                 std::span<const trace::Receiver> receivers,
                                                 const Light& light) {
    const std::optional<Light> middle = middle_of(light);
    if (!middle) return nullptr;
    return std::make_shared<RayEdgeProbe>(std::move(tracer), receivers, *middle);
}

}  // namespace gnomon
