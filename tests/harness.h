#pragma once

/// What the tests of the whole share: one Context a program with the validation layer on, a fixture
/// that fails a test when that layer says anything, and small scenes.

#include <gnomon/gnomon.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gnomon::test {

/// Owns the program's Context: made when first asked for, gone before the program's statics are.
class ContextEnvironment final : public testing::Environment {
public:
    Context& context() {
        if (!context_) context_ = std::make_unique<Context>(ContextOptions{.validation = true});
        return *context_;
    }
    void TearDown() override { context_.reset(); }

private:
    std::unique_ptr<Context> context_;
};

/// GoogleTest owns it.
inline ContextEnvironment* const kContextEnvironment = [] {
    auto* environment = new ContextEnvironment;
    testing::AddGlobalTestEnvironment(environment);
    return environment;
}();

inline Context& context() {
    return kContextEnvironment->context();
}

/// Base of all tests that use the device: a message of the validation layer fails the test.
class DeviceTest : public testing::Test {
protected:
    void SetUp() override { messages_before_ = context().validation_messages().size(); }
    void TearDown() override {
        const std::vector<std::string> messages = context().validation_messages();
        for (std::size_t i = messages_before_; i < messages.size(); ++i) {
            ADD_FAILURE() << "validation layer: " << messages[i];
        }
    }

private:
    std::size_t messages_before_ = 0;
};

/// A parallelogram whose front is the side of cross(u, v).
inline Mesh quad(Vec3 corner, Vec3 u, Vec3 v) {
    Mesh mesh;
    mesh.name = "quad";
    mesh.positions = {corner, corner + u, corner + u + v, corner + v};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

/// A square ground, facing up.
inline Mesh ground(float half_side_m, float y_m = 0.0f) {
    const float side_m = 2.0f * half_side_m;
    return quad({-half_side_m, y_m, half_side_m}, {side_m, 0, 0}, {0, 0, -side_m});
}

/// A closed box of 8 vertices.
inline Mesh box(Vec3 min, Vec3 max) {
    Mesh mesh;
    mesh.name = "box";
    for (unsigned i = 0; i < 8; ++i) {
        mesh.positions.emplace_back((i & 1) != 0 ? max.x : min.x, (i & 2) != 0 ? max.y : min.y,
                                    (i & 4) != 0 ? max.z : min.z);
    }
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

/// A closed ball of `rings` bands from pole to pole (up and down), each of twice as many facets.
inline Mesh ball(Vec3 center, float radius_m, unsigned rings) {
    const unsigned sides = 2 * rings;
    Mesh mesh;
    mesh.name = "ball";
    mesh.positions = {center + Vec3(0, radius_m, 0), center - Vec3(0, radius_m, 0)};
    const auto vertex = [sides](unsigned ring, unsigned side) {
        return 2 + (ring - 1) * sides + side % sides;
    };
    for (unsigned ring = 1; ring < rings; ++ring) {
        const float polar = kPi * static_cast<float>(ring) / static_cast<float>(rings);
        for (unsigned side = 0; side < sides; ++side) {
            const float turn = 2.0f * kPi * static_cast<float>(side) / static_cast<float>(sides);
            const Vec3 direction(std::sin(polar) * std::cos(turn), std::cos(polar),
                                 -std::sin(polar) * std::sin(turn));
            mesh.positions.push_back(center + radius_m * direction);
        }
    }
    for (unsigned side = 0; side < sides; ++side) {
        mesh.triangles.push_back({0, vertex(1, side), vertex(1, side + 1)});
        mesh.triangles.push_back({1, vertex(rings - 1, side + 1), vertex(rings - 1, side)});
        for (unsigned ring = 1; ring + 1 < rings; ++ring) {
            const unsigned a = vertex(ring, side), b = vertex(ring + 1, side);
            const unsigned c = vertex(ring + 1, side + 1), d = vertex(ring, side + 1);
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        }
    }
    return mesh;
}

/// Each mesh placed once, as it is, of one grey material.
inline SceneData scene_data(std::vector<Mesh> meshes) {
    SceneData data;
    data.materials.emplace_back();
    for (Mesh& mesh : meshes) {
        const auto index = static_cast<std::uint32_t>(data.meshes.size());
        data.instances.push_back({.mesh = index, .object = index, .name = mesh.name});
        data.meshes.push_back(std::move(mesh));
    }
    return data;
}

inline Scene make_scene(std::vector<Mesh> meshes) {
    return Scene(scene_data(std::move(meshes)));
}

/// A parallel view straight down on `target`: +X to the right, +Z down the picture. Its pixels are
/// squares of height_m / frame.size.height.
inline Camera top_view(Vec3 target, float height_m, float above_m) {
    Camera camera = look_at(target + Vec3(0, above_m, 0), target);
    camera.near_m = 1e-3f * above_m;
    camera.ortho_height_m = height_m;
    camera.ortho_depth_m = 2.0f * above_m;
    return camera;
}

/// What `technique` makes of `frame`, made anew.
inline Visibility render(std::string_view technique, const Frame& frame,
                         const Params& params = {}) {
    return make_technique(context(), technique, params)->render(frame);
}

/// A technique at its defaults but for `params` and a bake of a tenth of its texels, in a tenth of
/// the time: for what does not turn on how fine they are.
inline std::unique_ptr<Technique> make_small(std::string_view technique, Params params = {}) {
    constexpr int kTexels = 40'000;
    const std::span<const ParamInfo> infos = find_technique(technique).params();
    if (std::ranges::count(infos, "texels", &ParamInfo::name) != 0 &&
        !params.values().contains("texels")) {
        params.set("texels", kTexels);
    }
    return make_technique(context(), technique, params);
}

/// `technique` against the truth of one ray per pixel, or of `samples` for lights with extent.
inline Comparison compare_with_truth(std::string_view technique, const Frame& frame,
                                     const Params& params = {}, int samples = 256) {
    const Visibility visibility = render(technique, frame, params);
    const Visibility truth = trace_visibility(context(), frame, {.samples = samples});
    return compare(visibility, truth, comparison_mask(context(), frame));
}

}  // namespace gnomon::test
