#include "scene/load_draft.h"

#include "base/check.h"

#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace gnomon::scene {

namespace {

// When to re-centre; see recentring_offset_m.
constexpr double kCoarseRelative = 1e-5;
constexpr double kCoarse_m = 1e-3;
constexpr double kWorthwhileGain = 8.0;

// For the camera of a scene that has none: the size of a picture that nobody asked for yet.
constexpr Extent kNominalSize{1280, 720};
constexpr float kDefaultSunElevation_rad = radians(35.0f);
constexpr float kDefaultSunAzimuth_rad = radians(120.0f);

bool usable(DVec3 p) {
    // Written so that NaN fails.
    return std::abs(p.x) <= kMaxCoordinate_m && std::abs(p.y) <= kMaxCoordinate_m &&
           std::abs(p.z) <= kMaxCoordinate_m;
}

DBox3 mesh_bounds(const DraftMesh& draft) {
    DBox3 box;
    for (const UVec3& triangle : draft.mesh.triangles) {
        for (int corner = 0; corner < 3; ++corner) {
            box.include(DVec3(draft.mesh.positions[triangle[corner]]) + draft.origin_m);
        }
    }
    return box;
}

// Of the box's eight corners: contains the transformed content.
DBox3 transformed(const glm::dmat4& target_from_source, const DBox3& box) {
    DBox3 result;
    for (int corner = 0; corner < 8; ++corner) {
        const DVec3 p((corner & 1) != 0 ? box.max.x : box.min.x,
                      (corner & 2) != 0 ? box.max.y : box.min.y,
                      (corner & 4) != 0 ? box.max.z : box.min.z);
        result.include(DVec3(target_from_source * glm::dvec4(p, 1.0)));
    }
    return result;
}

// Floats minus whole metres near them: the subtraction is exact, so meshes that meet still meet.
void recentre_mesh(DraftMesh& draft) {
    if (draft.origin_m != DVec3(0.0)) return;
    draft.origin_m = recentring_offset_m(mesh_bounds(draft));
    if (draft.origin_m == DVec3(0.0)) return;
    for (Vec3& p : draft.mesh.positions)
        p = Vec3(DVec3(p) - draft.origin_m);
}

Box3 drawn_bounds(const SceneData& data) {
    Box3 bounds;
    for (const Instance& instance : data.instances) {
        const Mesh& mesh = data.meshes[instance.mesh];
        for (const UVec3& triangle : mesh.triangles) {
            for (int corner = 0; corner < 3; ++corner) {
                const Vec4 p(mesh.positions[triangle[corner]], 1.0f);
                bounds.include(Vec3(instance.world_from_local * p));
            }
        }
    }
    return bounds;
}

// The rigid part of a transform: unit axes at right angles, right-handed, mirrored or not.
std::optional<glm::dmat4> rigid(const glm::dmat4& world_from_view) {
    const DVec3 z = glm::normalize(DVec3(world_from_view[2]));
    const DVec3 x = glm::normalize(glm::cross(DVec3(world_from_view[1]), z));
    const DVec3 y = glm::cross(z, x);
    const DVec3 eye(world_from_view[3]);
    if (!usable(x) || !usable(y) || !usable(z) || !usable(eye)) return std::nullopt;
    return glm::dmat4(glm::dvec4(x, 0.0), glm::dvec4(y, 0.0), glm::dvec4(z, 0.0),
                      glm::dvec4(eye, 1.0));
}

void place_instances(std::vector<DraftInstance>& drafts, const std::vector<DraftMesh>& meshes,
                     DVec3 offset_m, SceneData& data) {
    for (DraftInstance& draft : drafts) {
        const glm::dmat4 world_from_local =
            glm::translate(glm::dmat4(1.0), -offset_m) * draft.world_from_local *
            glm::translate(glm::dmat4(1.0), meshes[draft.mesh].origin_m);
        data.instances.push_back({.mesh = draft.mesh,
                                  .object = draft.object,
                                  .world_from_local = Mat4(world_from_local),
                                  .name = std::move(draft.name)});
    }
}

void place_cameras(const std::vector<DraftCamera>& drafts, DVec3 offset_m, SceneData& data,
                   Warnings& warnings) {
    for (const DraftCamera& draft : drafts) {
        glm::dmat4 world_from_view = draft.world_from_view;
        world_from_view[3] -= glm::dvec4(offset_m, 0.0);
        Camera camera = draft.camera;
        try {
            const std::optional<glm::dmat4> pose = rigid(world_from_view);
            if (!pose) fail_input("has no place");
            camera.view_from_world = Mat4(glm::inverse(*pose));
            camera.validate();
            data.cameras.push_back(std::move(camera));
        } catch (const Error&) {
            warnings.add("a camera with impossible values is left out", camera.name);
        }
    }
}

void place_lights(const std::vector<DraftLight>& drafts, DVec3 offset_m, SceneData& data,
                  Warnings& warnings) {
    for (const DraftLight& draft : drafts) {
        const Vec3 position_ws(draft.position_ws - offset_m);
        Light light = draft.light;
        if (auto* point = std::get_if<PointLight>(&light)) point->position_ws = position_ws;
        if (auto* spot = std::get_if<SpotLight>(&light)) spot->position_ws = position_ws;
        try {
            if (!usable(draft.position_ws)) fail_input("has no place");
            validate(light);
            data.lights.push_back(std::move(light));
        } catch (const Error&) {
            warnings.add("a light with impossible values is left out", light_name(light));
        }
    }
}

}  // namespace

DVec3 recentring_offset_m(const DBox3& box) {
    DVec3 offset_m(0.0);
    if (box.empty()) return offset_m;
    const DVec3 half = 0.5 * (box.max - box.min);
    const double reach_m = std::max({half.x, half.y, half.z});
    const double tolerated_m = std::min(kCoarse_m, kCoarseRelative * 2.0 * glm::length(half));
    for (int axis = 0; axis < 3; ++axis) {
        const double farthest_m = std::max(std::abs(box.min[axis]), std::abs(box.max[axis]));
        const double spacing_m = farthest_m * std::numeric_limits<float>::epsilon();
        if (spacing_m <= tolerated_m || farthest_m < kWorthwhileGain * reach_m) continue;
        offset_m[axis] = std::round(0.5 * (box.min[axis] + box.max[axis]));
    }
    return offset_m;
}

SceneData finish(Draft draft, Warnings& warnings) {
    std::vector<DBox3> boxes;
    for (DraftMesh& mesh : draft.meshes) {
        recentre_mesh(mesh);
        boxes.push_back(mesh_bounds(mesh));
    }
    DBox3 world;
    std::vector<DraftInstance> placed;
    for (DraftInstance& instance : draft.instances) {
        if (boxes[instance.mesh].empty()) continue;
        const DBox3 box = transformed(instance.world_from_local, boxes[instance.mesh]);
        if (!usable(box.min) || !usable(box.max)) {
            warnings.add("an object without a finite place is left out", instance.name);
            continue;
        }
        world.include(box.min);
        world.include(box.max);
        placed.push_back(std::move(instance));
    }
    SceneData data;
    data.origin_offset_m = recentring_offset_m(world);
    place_instances(placed, draft.meshes, data.origin_offset_m, data);
    place_cameras(draft.cameras, data.origin_offset_m, data, warnings);
    place_lights(draft.lights, data.origin_offset_m, data, warnings);
    for (DraftMesh& mesh : draft.meshes)
        data.meshes.push_back(std::move(mesh.mesh));
    data.materials = std::move(draft.materials);
    data.textures = std::move(draft.textures);

    if (world.empty()) warnings.add("the file has no triangles to draw");
    if (data.cameras.empty()) {
        data.cameras.push_back(framing_camera(drawn_bounds(data), kNominalSize));
    }
    if (data.lights.empty()) {
        data.lights.push_back(sun(kDefaultSunElevation_rad, kDefaultSunAzimuth_rad));
    }
    return data;
}

}  // namespace gnomon::scene
