#include <gnomon/light.h>

#include "facts.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <set>

namespace gnomon::cli {

namespace {

std::size_t masked_count(const Scene& scene) {
    return static_cast<std::size_t>(
        std::count_if(scene.materials().begin(), scene.materials().end(),
                      [](const Material& material) { return material.masked(); }));
}

std::size_t object_count(const Scene& scene) {
    std::set<std::uint32_t> objects;
    for (const Instance& instance : scene.instances())
        objects.insert(instance.object);
    return objects.size();
}

/// Four digits, or centimetres where coordinates are large.
std::string text_of(double metres) {
    constexpr double kLargeM = 1e3;
    return std::abs(metres) < kLargeM ? fmt::format("{:.4g}", metres)
                                      : fmt::format("{:.2f}", metres);
}

std::string text_of(DVec3 v) {
    return fmt::format("{}, {}, {}", text_of(v.x), text_of(v.y), text_of(v.z));
}

Json json_of(DVec3 v) {
    return Json::array({v.x, v.y, v.z});
}

std::string lens_text(const Camera& camera) {
    if (camera.ortho_height_m > 0.0f) {
        return fmt::format("parallel, {:.4g} m high", camera.ortho_height_m);
    }
    return fmt::format("{:.3g} degrees high", degrees(camera.fov_y_rad));
}

/// Lists grow long in some scenes; the JSON has all.
constexpr std::size_t kMaxListed = 20;

template <typename Things, typename LineOf>
std::string list_text(std::string_view title, const Things& things, LineOf line_of) {
    std::string text = fmt::format("{:<14} {}\n", title, things.size());
    for (std::size_t i = 0; i < std::min(things.size(), kMaxListed); ++i) {
        text += fmt::format("  {}  {}\n", i, line_of(things[i]));
    }
    if (things.size() > kMaxListed) {
        text += fmt::format("  and {} more (all of them: --json)\n", things.size() - kMaxListed);
    }
    return text;
}

/// Corners of the scene's box in the file's coordinates; turning the axes may swap the corners.
std::pair<DVec3, DVec3> file_bounds(const Scene& scene, const FileFrame& frame) {
    const DVec3 a = frame.file_point_m(scene.bounds().min);
    const DVec3 b = frame.file_point_m(scene.bounds().max);
    return {glm::min(a, b), glm::max(a, b)};
}

std::string space_text(const Scene& scene, const FileFrame& frame) {
    const DVec3 offset = frame.file_point_m(Vec3(0.0f));
    std::string text;
    if (!scene.bounds().empty()) {
        const auto [min, max] = file_bounds(scene, frame);
        text += fmt::format("{:<14} {} m\n", "size", text_of(max - min));
        text += fmt::format("{:<14} {}  to  {} m\n", "bounds", text_of(min), text_of(max));
    }
    if (offset != DVec3(0.0)) {
        text += fmt::format("{:<14} {} m, taken off so that float can hold the rest\n",
                            "origin offset", text_of(offset));
    }
    return text;
}

}  // namespace

std::string scene_text(const Scene& scene, const FileFrame& frame) {
    std::string text = scene.source() + "\n";
    const auto add = [&](std::string_view name, const std::string& value) {
        text += fmt::format("{:<14} {}\n", name, value);
    };
    add("triangles", std::to_string(scene.triangle_count()));
    add("instances", fmt::format("{} of {} meshes, in {} objects", scene.instances().size(),
                                 scene.meshes().size(), object_count(scene)));
    add("materials",
        fmt::format("{}, {} with an alpha mask", scene.materials().size(), masked_count(scene)));
    add("textures", std::to_string(scene.textures().size()));
    text += space_text(scene, frame);
    text += list_text("cameras", scene.cameras(), [&](const Camera& camera) {
        return fmt::format("{}  at {} m, {}", camera.name,
                           text_of(frame.file_point_m(camera.eye_ws())), lens_text(camera));
    });
    text += list_text("lights", scene.lights(), [](const Light& light) {
        return fmt::format("{}  {}{}", light_name(light), light_kind(light),
                           has_extent(light) ? ", with extent" : "");
    });
    return text;
}

Json scene_json(const Scene& scene, const FileFrame& frame) {
    Json cameras = Json::array();
    for (const Camera& camera : scene.cameras()) {
        cameras.push_back({{"name", camera.name},
                           {"eye_m", json_of(frame.file_point_m(camera.eye_ws()))},
                           {"fov_y_degrees", degrees(camera.fov_y_rad)},
                           {"ortho_height_m", camera.ortho_height_m},
                           {"near_m", camera.near_m}});
    }
    Json lights = Json::array();
    for (const Light& light : scene.lights()) {
        lights.push_back({{"name", light_name(light)},
                          {"kind", light_kind(light)},
                          {"has_extent", has_extent(light)}});
    }
    Json bounds;  // null without triangles
    if (!scene.bounds().empty()) {
        const auto [min, max] = file_bounds(scene, frame);
        bounds = {{"min_m", json_of(min)}, {"max_m", json_of(max)}};
    }
    return {{"gnomon", GNOMON_VERSION},
            {"source", scene.source()},
            {"triangles", scene.triangle_count()},
            {"meshes", scene.meshes().size()},
            {"instances", scene.instances().size()},
            {"objects", object_count(scene)},
            {"materials", scene.materials().size()},
            {"masked_materials", masked_count(scene)},
            {"textures", scene.textures().size()},
            {"bounds", std::move(bounds)},
            {"origin_offset_m", json_of(frame.file_point_m(Vec3(0.0f)))},
            {"cameras", std::move(cameras)},
            {"lights", std::move(lights)},
            {"warnings", scene.warnings()}};
}

}  // namespace gnomon::cli
