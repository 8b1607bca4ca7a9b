#pragma once

/// Scenes and shorthands that the tests of this folder share.

#include <gnomon/scene.h>

#include "trace/tracer.h"

#include <glm/ext/matrix_transform.hpp>

#include <span>
#include <utility>
#include <vector>

namespace gnomon::trace {

inline Mesh quad(Vec3 corner, Vec3 u, Vec3 v) {
    Mesh mesh;
    mesh.positions = {corner, corner + u, corner + u + v, corner + v};
    mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

/// [-1, 1]³, corners shared, outward normals.
inline Mesh cube() {
    Mesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.positions.emplace_back((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1,
                                    (i & 4) != 0 ? 1 : -1);
    }
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

/// A square of side 2 in the plane y = 0, in cells x cells squares.
inline Mesh tiles(int cells) {
    Mesh mesh;
    const float step = 2.0f / static_cast<float>(cells);
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            mesh.positions.emplace_back(static_cast<float>(i) * step - 1.0f, 0.0f,
                                        static_cast<float>(j) * step - 1.0f);
        }
    }
    const auto side = static_cast<unsigned>(cells + 1);
    for (unsigned j = 0; j + 1 < side; ++j) {
        for (unsigned i = 0; i + 1 < side; ++i) {
            const unsigned a = j * side + i;
            mesh.triangles.push_back({a, a + side, a + side + 1});
            mesh.triangles.push_back({a, a + side + 1, a + 1});
        }
    }
    return mesh;
}

struct Placed {
    Mesh mesh;
    std::vector<Mat4> places{Mat4(1.0f)};
};

inline Scene make_scene(const std::vector<Placed>& parts, const Material& material = {},
                        const std::vector<Texture>& textures = {}) {
    SceneData data;
    data.materials = {material};
    data.textures = textures;
    for (const Placed& part : parts) {
        for (const Mat4& place : part.places) {
            Instance instance;
            instance.mesh = static_cast<std::uint32_t>(data.meshes.size());
            instance.world_from_local = place;
            data.instances.push_back(instance);
        }
        data.meshes.push_back(part.mesh);
    }
    return Scene(std::move(data));
}

inline Mat4 moved(Vec3 offset) {
    return glm::translate(Mat4(1.0f), offset);
}

/// Far from the origin and at odds with every axis.
inline Mat4 far_and_turned() {
    return glm::rotate(moved({1013.7f, 987.3f, -1101.9f}), 0.7f, normalize(Vec3(0.3f, 0.8f, 0.5f)));
}

inline Receiver on_ground(float x, float z = 0.0f) {
    return {{x, 0.0f, z}, {0, 1, 0}, {kNoSurface, 0}};
}

inline std::vector<float> visibility(const Tracer& tracer, std::span<const Receiver> receivers,
                                     const Light& light, int samples = 1, unsigned seed = 1) {
    std::vector<float> out(receivers.size(), -1.0f);
    Progress progress;
    tracer.visibility(receivers, {static_cast<unsigned>(receivers.size()), 1}, light, samples, seed,
                      out, progress);
    return out;
}

inline Tracer make_tracer(const Scene& scene, bool ignore_alpha = false) {
    Progress progress;
    return Tracer(scene, ignore_alpha, progress);
}

inline float visibility(const Scene& scene, const Receiver& receiver, const Light& light,
                        int samples = 1) {
    return visibility(make_tracer(scene), {&receiver, 1}, light, samples).front();
}

}  // namespace gnomon::trace
