#include "scene/gltf_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace gnomon::scene {

namespace {

// Parallel cameras may have their near plane at the eye; ours must be in front of it, by this
// fraction of the depth.
constexpr double kNearFraction = 1e-6;

std::string named(const std::string& name, const std::string& node_name, std::string_view kind,
                  std::size_t number) {
    if (!name.empty()) return name;
    return node_name.empty() ? fmt::format("{} {}", kind, number) : node_name;
}

Camera convert(const tinygltf::Camera& source) {
    Camera camera;
    if (source.type == "orthographic") {
        const auto& view = source.orthographic;
        camera.ortho_height_m = static_cast<float>(2.0 * view.ymag);
        camera.ortho_depth_m = static_cast<float>(view.zfar);
        camera.near_m = static_cast<float>(std::max(view.znear, kNearFraction * view.zfar));
        // 0 would make it a perspective camera; the caller's check refuses negative heights.
        if (camera.ortho_height_m == 0.0f) camera.ortho_height_m = -1.0f;
    } else {
        camera.fov_y_rad = static_cast<float>(source.perspective.yfov);
        camera.near_m = static_cast<float>(source.perspective.znear);
    }
    return camera;
}

Light convert_spot(const tinygltf::Light& source, Vec3 direction_ws, Vec3 intensity,
                   Warnings& warnings) {
    SpotLight light{.direction_ws = direction_ws, .intensity = intensity, .name = source.name};
    const double outer_rad = std::min(source.spot.outerConeAngle, double{kPi} / 2.0);
    if (!(source.spot.innerConeAngle < outer_rad) || source.spot.innerConeAngle < 0.0) {
        warnings.add("a spot light's inner cone is made to lie within its outer cone", source.name);
    }
    light.outer_angle_rad = std::min(static_cast<float>(outer_rad), kPi / 2.0f);
    light.inner_angle_rad = std::clamp(static_cast<float>(source.spot.innerConeAngle), 0.0f,
                                       std::max(0.0f, light.outer_angle_rad));
    return light;
}

// KHR_lights_punctual: a light shines along -Z of its node; lux for directional lights, else
// candela.
/// glTF's lights have no extent; write_glb() keeps ours in the extras. Others are suns.
float angular_diameter_rad(const tinygltf::Light& source) {
    constexpr const char* kKey = "angular_diameter_rad";
    if (!source.extras.IsObject() || !source.extras.Has(kKey)) return kSunAngularDiameterRad;
    const tinygltf::Value& value = source.extras.Get(kKey);
    if (!value.IsNumber()) return kSunAngularDiameterRad;
    const double diameter_rad = value.GetNumberAsDouble();
    const bool valid = diameter_rad >= 0.0 && diameter_rad <= 0.5 * static_cast<double>(kPi);
    return valid ? static_cast<float>(diameter_rad) : kSunAngularDiameterRad;
}

std::optional<Light> convert(const tinygltf::Light& source, const glm::dmat4& world_from_node,
                             Warnings& warnings) {
    const Vec3 to_light_ws(glm::normalize(DVec3(world_from_node[2])));
    Vec3 color(1.0f);
    if (source.color.size() == 3) {
        color = Vec3(DVec3(source.color[0], source.color[1], source.color[2]));
    }
    const Vec3 strength = static_cast<float>(source.intensity) * color;
    if (source.range > 0.0)
        warnings.add("a light's range is ignored: light has no end", source.name);
    if (source.type == "directional") {
        return DirectionalLight{.to_light_ws = to_light_ws,
                                .irradiance = strength,
                                .angular_diameter_rad = angular_diameter_rad(source),
                                .name = source.name};
    }
    if (source.type == "point") return PointLight{.intensity = strength, .name = source.name};
    if (source.type == "spot") return convert_spot(source, -to_light_ws, strength, warnings);
    warnings.add("a light of unknown type is left out", source.type);
    return std::nullopt;
}

}  // namespace

void read_cameras_and_lights(const GltfDocument& document, std::span<const int> nodes,
                             std::span<const glm::dmat4> world_from_node, LoadContext& context,
                             Draft& draft) {
    const tinygltf::Model& model = document.model();
    for (const int index : nodes) {
        const auto i = static_cast<std::size_t>(index);
        const tinygltf::Node& node = model.nodes[i];
        if (node.camera >= 0) {
            const tinygltf::Camera& source = model.cameras[static_cast<std::size_t>(node.camera)];
            Camera camera = convert(source);
            camera.name = named(source.name, node.name, "camera", draft.cameras.size());
            draft.cameras.push_back({std::move(camera), world_from_node[i]});
        }
        const tinygltf::Value* extension = find_extension(node.extensions, "KHR_lights_punctual");
        if (extension == nullptr) continue;
        tinygltf::Light source =
            model.lights[static_cast<std::size_t>(number_in(*extension, "light", 0.0))];
        source.name = named(source.name, node.name, "light", draft.lights.size());
        if (auto light = convert(source, world_from_node[i], context.warnings)) {
            draft.lights.push_back({*std::move(light), DVec3(world_from_node[i][3])});
        }
    }
}

}  // namespace gnomon::scene
