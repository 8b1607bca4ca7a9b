#pragma once

#include <gnomon/scene.h>

#include <utility>
#include <vector>

namespace gnomon::raster {

/// A parallelogram whose front is the side of cross(u, v).
inline Mesh quad(Vec3 corner, Vec3 u, Vec3 v) {
    Mesh mesh;
    mesh.positions = {corner, corner + u, corner + u + v, corner + v};
    mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

/// A square about the point (x, y, z) that faces +Z.
inline Mesh wall(Vec3 center, float side_m) {
    const Vec3 half(0.5f * side_m, 0.5f * side_m, 0.0f);
    return quad(center - half, {side_m, 0, 0}, {0, side_m, 0});
}

/// Each mesh placed once, where it is; all of one default material.
inline SceneData scene_data(std::vector<Mesh> meshes) {
    SceneData data;
    data.materials.emplace_back();
    for (Mesh& mesh : meshes) {
        const auto index = static_cast<std::uint32_t>(data.meshes.size());
        data.instances.push_back({.mesh = index, .object = index});
        data.meshes.push_back(std::move(mesh));
    }
    return data;
}

}  // namespace gnomon::raster
