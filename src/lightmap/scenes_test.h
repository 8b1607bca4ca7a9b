#pragma once

#include <gnomon/scene.h>

#include "scene/shapes.h"

#include <vector>

namespace gnomon::lightmap {

/// Meshes of one material, an instance of each.
inline Scene scene_of(std::vector<Mesh> meshes, bool double_sided = false) {
    SceneData data;
    data.materials.push_back({.name = "stone", .double_sided = double_sided});
    for (Mesh& mesh : meshes) {
        data.instances.push_back({.mesh = static_cast<std::uint32_t>(data.meshes.size()),
                                  .object = static_cast<std::uint32_t>(data.meshes.size()),
                                  .name = mesh.name});
        data.meshes.push_back(std::move(mesh));
    }
    return Scene(std::move(data));
}

/// One mesh in several places.
inline Scene placed(Mesh mesh, const std::vector<Mat4>& places) {
    SceneData data = scene_of({std::move(mesh)}).data();
    const Instance instance = data.instances.front();
    data.instances.clear();
    for (const Mat4& world_from_local : places) {
        data.instances.push_back(instance);
        data.instances.back().world_from_local = world_from_local;
    }
    return Scene(std::move(data));
}

inline Mesh named(Mesh mesh, const char* name) {
    mesh.name = name;
    return mesh;
}

/// 1 m.
inline Mesh unit_cube() {
    return named(scene::centered_box(Vec3(0.0f), Vec3(1.0f)), "cube");
}

/// Corners, three a triangle, each with vertices of its own.
inline Mesh soup(const std::vector<Vec3>& corners, const char* name = "soup") {
    Mesh mesh;
    mesh.name = name;
    mesh.positions = corners;
    for (std::uint32_t i = 0; i + 2 < corners.size(); i += 3)
        mesh.triangles.emplace_back(i, i + 1, i + 2);
    return mesh;
}

}  // namespace gnomon::lightmap
