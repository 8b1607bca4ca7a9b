// Input that no modeller should make and every file holds: each technique that casts shadows must
// give what the traced truth gives, but for pixels at the truth's own edges.

#include "harness.h"

#include <glm/ext/matrix_transform.hpp>

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string_view>

namespace gnomon {

namespace {

using test::context;

constexpr Extent kSize{160, 120};

DirectionalLight hard_sun() {
    return sun(radians(48.0f), radians(310.0f), 0.0f);
}

PointLight point(Vec3 position_ws) {
    return {.position_ws = position_ws};
}

std::vector<Light> sun_and_point() {
    return {hard_sun(), point({-1.7f, 3.2f, 1.1f})};
}

Camera from_above() {
    return look_at({1.6f, 3.1f, 4.2f}, {0.1f, 0.4f, 0.0f});
}

Camera from_below() {
    return look_at({1.1f, 0.2f, 2.9f}, {0.0f, 0.8f, 0.0f});
}

Mesh caster_box() {
    return test::box({-0.6f, 0.5f, -0.4f}, {0.5f, 1.3f, 0.45f});
}

/// An open sheet over the ground, not parallel to it.
Mesh sheet() {
    return test::quad({-0.7f, 0.9f, 0.5f}, {1.3f, 0.2f, 0.1f}, {-0.1f, 0.1f, -1.1f});
}

Mesh flipped(Mesh mesh) {
    for (UVec3& triangle : mesh.triangles)
        std::swap(triangle.y, triangle.z);
    return mesh;
}

Mesh joined(Mesh mesh, const Mesh& other) {
    const auto first = static_cast<unsigned>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
    for (const UVec3 triangle : other.triangles)
        mesh.triangles.push_back(triangle + first);
    return mesh;
}

/// Every triangle with corners of its own.
Mesh soup(const Mesh& mesh) {
    Mesh result;
    for (const UVec3 triangle : mesh.triangles) {
        const auto first = static_cast<unsigned>(result.positions.size());
        for (int corner = 0; corner < 3; ++corner)
            result.positions.push_back(mesh.positions[triangle[corner]]);
        result.triangles.emplace_back(first, first + 1, first + 2);
    }
    return result;
}

Mesh scaled(Mesh mesh, float factor, Vec3 offset = Vec3(0.0f)) {
    for (Vec3& p : mesh.positions)
        p = factor * p + offset;
    return mesh;
}

/// A pixel whose neighbours, and itself, have one truth.
bool is_inner(const Image& truth, unsigned x, unsigned y) {
    for (unsigned v = std::max(y, 1u) - 1; v <= std::min(y + 1, truth.height() - 1); ++v) {
        for (unsigned u = std::max(x, 1u) - 1; u <= std::min(x + 1, truth.width() - 1); ++u) {
            if (truth.at(u, v) != truth.at(x, y)) return false;
        }
    }
    return true;
}

class Degenerate : public test::DeviceTest,
                   public testing::WithParamInterface<const TechniqueInfo*> {
protected:
    const TechniqueInfo& info() const { return *GetParam(); }

    Comparison compared(const Frame& frame, const Visibility& truth) const {
        if (!technique_) technique_ = make_technique(context(), info().name);
        visibility_ = technique_->render(frame);
        return compare(visibility_, truth, comparison_mask(context(), frame));
    }

    /// False pixels are only where the truth changes: within a pixel, or within what texels there
    /// are explain.
    void expect_truth(const Frame& frame) const {
        if (!supports(info().lights, frame.light)) return;
        SCOPED_TRACE(light_name(frame.light));
        const Visibility truth = trace_visibility(context(), frame);
        const Comparison error = compared(frame, truth);
        // Of shadows that an object casts on itself some techniques say that they make none.
        if (info().self_shadows) {
            EXPECT_EQ(error.artefact_lit, 0.0);
        }
        EXPECT_EQ(error.artefact_shadow, 0.0);
        if (!visibility_.texel_size_m().empty()) return;
        const ComparisonMask mask = comparison_mask(context(), frame);
        for (unsigned y = 0; y < frame.size.height; ++y) {
            for (unsigned x = 0; x < frame.size.width; ++x) {
                if (mask.facing.at(x, y) == 0.0f || !is_inner(truth.image(), x, y)) continue;
                ASSERT_EQ(visibility_.image().at(x, y), truth.image().at(x, y))
                    << "at (" << x << ", " << y << "), away from any edge";
            }
        }
    }

    void expect_truth(const Scene& scene, const Camera& camera,
                      const std::vector<Light>& lights = sun_and_point()) const {
        for (const Light& light : lights)
            expect_truth({.scene = scene, .camera = camera, .light = light, .size = kSize});
    }

    /// The casters over a ground, seen from above and from below them.
    void expect_truth_over_ground(const std::vector<Mesh>& casters) const {
        std::vector<Mesh> meshes = casters;
        meshes.push_back(test::ground(4.0f));
        const Scene scene = test::make_scene(meshes);
        expect_truth(scene, from_above());
        expect_truth(scene, from_below());
    }

    mutable std::unique_ptr<Technique> technique_;  // one for all pictures: bakes serve several
    mutable Visibility visibility_;                 // the last one
};

std::vector<const TechniqueInfo*> casting_techniques() {
    std::vector<const TechniqueInfo*> casting;
    for (const TechniqueInfo& info : techniques()) {
        if (info.name != "local_illumination") casting.push_back(&info);
    }
    return casting;
}

INSTANTIATE_TEST_SUITE_P(Techniques, Degenerate, testing::ValuesIn(casting_techniques()),
                         [](const auto& test) { return std::string(test.param->name); });

TEST_P(Degenerate, EmptyMesh) {
    Mesh no_triangles = caster_box();
    no_triangles.triangles.clear();
    expect_truth_over_ground({Mesh{}, sheet(), no_triangles});
}

TEST_P(Degenerate, NothingButEmptyMeshes) {
    const Scene scene = test::make_scene({Mesh{}, Mesh{}});
    for (const Light& light : sun_and_point()) {
        if (!supports(info().lights, light)) continue;
        const Visibility visibility = test::render(
            info().name, {.scene = scene, .camera = from_above(), .light = light, .size = kSize});
        for (const float value : visibility.image().pixels())
            ASSERT_EQ(value, 1.0f);
    }
}

TEST_P(Degenerate, TrianglesWithoutArea) {
    Mesh mesh = caster_box();
    const auto extra = static_cast<unsigned>(mesh.positions.size());
    mesh.positions.push_back(0.5f * (mesh.positions[0] + mesh.positions[7]));
    for (const UVec3 triangle : {UVec3(0, 0, 7), UVec3(3, 3, 3), UVec3(0, extra, 7)})
        mesh.triangles.push_back(triangle);
    expect_truth_over_ground({mesh});
}

TEST_P(Degenerate, OpenMesh) {
    expect_truth_over_ground({sheet()});
    expect_truth_over_ground({flipped(sheet())});
}

TEST_P(Degenerate, OpenBox) {
    Mesh mesh = caster_box();
    mesh.triangles.resize(mesh.triangles.size() - 2);
    expect_truth_over_ground({mesh});
    expect_truth_over_ground({flipped(mesh)});
}

TEST_P(Degenerate, DuplicateVertices) {
    expect_truth_over_ground({soup(caster_box())});
    expect_truth_over_ground({soup(test::ball({0.1f, 1.0f, 0.0f}, 0.5f, 6))});
}

TEST_P(Degenerate, CoincidentTriangles) {
    expect_truth_over_ground({joined(caster_box(), caster_box())});
    expect_truth_over_ground({caster_box(), caster_box()});
    expect_truth_over_ground({joined(sheet(), sheet())});
    expect_truth_over_ground({joined(sheet(), flipped(sheet()))});
}

TEST_P(Degenerate, LightInsideAClosedCaster) {
    const Scene scene = test::make_scene({test::ground(4.0f), caster_box()});
    expect_truth(scene, from_above(), {point({0.0f, 0.9f, 0.1f})});
    expect_truth(test::make_scene({test::ground(4.0f), test::ball({0, 0.9f, 0}, 0.4f, 8),
                                   test::ball({1.2f, 0.5f, 0.3f}, 0.4f, 8)}),
                 from_above(), {point({0.1f, 0.8f, 0.05f})});
}

TEST_P(Degenerate, LightInAReceiversPlane) {
    const Scene scene = test::make_scene({test::ground(4.0f), caster_box()});
    expect_truth(scene, from_above(), {point({-2.1f, 1.3f, 0.7f})});  // of the box's top
    expect_truth(scene, from_above(), {point({-2.1f, 0.0f, 0.7f})});  // of the ground
    expect_truth(scene, from_above(), {sun(0.0f, radians(310.0f), 0.0f)});
}

// Whether the lamp is above or below the surface is a matter of rounding.
TEST_P(Degenerate, LampFlushWithACeiling) {
    for (const float turn_deg : {3.0f, 7.0f, 11.0f, 17.0f}) {
        SCOPED_TRACE(turn_deg);
        const Mat4 turn = glm::rotate(Mat4(1.0f), radians(turn_deg), Vec3(0.3f, 0.2f, 0.93f));
        for (const bool solid : {true, false}) {
            const Mesh slab = solid ? test::box({-2.1f, 2.6f, -1.9f}, {1.9f, 2.8f, 2.2f})
                                    : test::quad({-2.1f, 2.6f, -1.9f}, {4, 0, 0}, {0, 0, 4});
            SceneData data = test::scene_data({test::ground(4.0f), slab, caster_box()});
            data.instances[1].world_from_local = turn;
            const Vec3 lamp(turn * Vec4(-0.3f, 2.6f, 0.4f, 1.0f));
            // The ceiling itself is not seen: whether it faces the lamp is rounding as well.
            expect_truth(Scene(data), look_at({1.6f, 1.9f, 3.5f}, {0, 0, 0}), {point(lamp)});
        }
    }
}

TEST_P(Degenerate, MirroredInstances) {
    // Not its own mirror image.
    const Mesh hook = joined(test::box({0.1f, 0.5f, -0.3f}, {0.7f, 0.8f, 0.3f}),
                             test::box({0.55f, 0.7f, -0.3f}, {0.75f, 1.4f, 0.1f}));
    for (const Mesh& mesh : {hook, sheet()}) {
        SceneData data = test::scene_data({test::ground(4.0f), mesh, mesh});
        data.instances[1].world_from_local = glm::scale(Mat4(1.0f), {-1, 1, 1});
        data.instances[2].world_from_local =
            glm::scale(glm::translate(Mat4(1.0f), {0.4f, 0.1f, 0.9f}), {0.8f, 0.9f, -1.2f});
        const Scene scene(data);
        expect_truth(scene, from_above());
        expect_truth(scene, from_below());
    }
}

TEST_P(Degenerate, AnInstanceSquashedFlat) {
    for (const Mesh& mesh : {test::ball(Vec3(0.0f), 0.6f, 8), caster_box()}) {
        SceneData data = test::scene_data({test::ground(4.0f), mesh});
        data.instances[1].world_from_local =
            glm::scale(glm::translate(Mat4(1.0f), {0, 0.9f, 0}), {1, 0, 1});
        const Scene scene(data);
        expect_truth(scene, from_above());
        expect_truth(scene, from_below());
    }
}

/// `count` closed plates one over the other, all of one shadow under a sun straight above.
Frame stack(int count) {
    std::vector<Mesh> meshes{test::ground(2.0f)};
    for (int i = 0; i < count; ++i) {
        const float y_m = 1.0f + 0.01f * static_cast<float>(i);
        meshes.push_back(test::box({-0.5f, y_m, -0.5f}, {0.5f, y_m + 0.005f, 0.5f}));
    }
    return {.scene = test::make_scene(meshes),
            .camera = look_at({0.3f, 0.8f, 2.0f}, {0, 0, 0}),
            .light = DirectionalLight{},
            .size = {80, 60}};
}

TEST_P(Degenerate, DeepStacks) {
    expect_truth(stack(255));
    expect_truth(stack(300));
}

class KnownFailure : public test::DeviceTest {};

// Eight bits of stencil count to 255, so 256 volumes at a place are none.
TEST_F(KnownFailure, AShadow256VolumesDeepIsLost) {
    const Frame frame = stack(256);
    const Visibility truth = trace_visibility(context(), frame);
    const Visibility visibility = test::render("shadow_volumes", frame);
    const Comparison error = compare(visibility, truth, comparison_mask(context(), frame));
    EXPECT_GT(error.stray_lit, 0.01);
    EXPECT_EQ(error.stray_shadow, 0.0);
}

TEST_P(Degenerate, AnEdgeOfThreeTriangles) {
    Mesh mesh;
    mesh.positions = {
        {0, 0.4f, 0}, {0, 1.4f, 0.1f}, {0.8f, 0.9f, 0.1f}, {-0.5f, 1, -0.6f}, {-0.4f, 0.8f, 0.7f}};
    mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}};
    expect_truth_over_ground({mesh});
}

TEST_P(Degenerate, InconsistentWinding) {
    Mesh mesh = caster_box();
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3)
        std::swap(mesh.triangles[i].y, mesh.triangles[i].z);
    expect_truth_over_ground({mesh});
}

TEST_P(Degenerate, InsideOut) {
    expect_truth_over_ground({flipped(caster_box())});
    // One piece of the mesh is, the other is not.
    expect_truth_over_ground(
        {joined(flipped(caster_box()), test::ball({1.1f, 0.7f, 0.3f}, 0.3f, 6))});
}

TEST_P(Degenerate, SolidsThatCross) {
    expect_truth_over_ground({caster_box(), test::ball({0.4f, 1.1f, 0.3f}, 0.5f, 8),
                              test::box({-0.2f, -0.3f, -0.2f}, {0.1f, 1.8f, 0.2f})});
}

TEST_P(Degenerate, CameraInsideAShadow) {
    const Scene scene = test::make_scene({test::ground(4.0f), caster_box(), sheet()});
    const Vec3 middle(-0.05f, 0.9f, 0.0f);
    for (const Light& light : sun_and_point()) {
        const auto* distant = std::get_if<DirectionalLight>(&light);
        const Vec3 away = distant != nullptr
                              ? -distant->to_light_ws
                              : normalize(middle - std::get<PointLight>(light).position_ws);
        const Camera camera = look_at(middle + 0.75f * away, {2.0f, 0.0f, -0.4f}, radians(75.0f));
        expect_truth(scene, camera, {light});
    }
}

TEST_P(Degenerate, CameraInsideASolid) {
    const Scene scene =
        test::make_scene({test::box({-2, 0, -2}, {2, 2.5f, 2}), caster_box(), sheet()});
    const Camera camera = look_at({1.6f, 1.9f, 1.7f}, {0, 0.8f, 0}, radians(75.0f));
    // Warped by a near plane that nothing is at, texels at the far wall are so coarse that light
    // leaks in under the ceiling, no farther than they reach.
    expect_truth(scene, camera, {hard_sun()});
    expect_truth(scene, camera, {point({-1.7f, 2.2f, 1.1f})});
}

TEST_P(Degenerate, CasterAcrossTheNearPlane) {
    const Scene scene = test::make_scene({test::ground(4.0f), caster_box()});
    Camera camera = look_at({0.2f, 1.6f, 0.9f}, {0.1f, 0.0f, -0.3f}, radians(60.0f));
    camera.near_m = 0.55f;  // cuts the box open
    expect_truth(scene, camera);
}

TEST_P(Degenerate, FarFromTheOrigin) {
    const Vec3 offset(5000.0f, 120.0f, -3000.0f);
    const std::vector<Mesh> meshes{scaled(test::ground(4.0f), 1.0f, offset),
                                   scaled(caster_box(), 1.0f, offset),
                                   scaled(sheet(), 1.0f, offset + Vec3(0.3f, 0.6f, 0.2f))};
    const Camera near = from_above();
    const Camera camera = look_at(near.eye_ws() + offset, offset + Vec3(0.1f, 0.4f, 0.0f));
    expect_truth(test::make_scene(meshes), camera,
                 {hard_sun(), point(offset + Vec3(-1.7f, 3.2f, 1.1f))});
}

TEST_P(Degenerate, OfAMillimetre) {
    constexpr float kScale = 1e-3f;
    const Scene scene = test::make_scene({scaled(test::ground(4.0f), kScale),
                                          scaled(caster_box(), kScale), scaled(sheet(), kScale)});
    const Camera camera = look_at(kScale * from_above().eye_ws(), kScale * Vec3(0.1f, 0.4f, 0.0f));
    expect_truth(scene, camera, {hard_sun(), point(kScale * Vec3(-1.7f, 3.2f, 1.1f))});
}

TEST_P(Degenerate, OfManyKilometres) {
    constexpr float kFar_m = 5e4f;
    Mesh canopy;  // over half of the ground
    canopy.positions = {{0.2f, 2.0f, -kFar_m}, {0.2f, 2.0f, kFar_m}, {-kFar_m, 900.0f, 0.0f}};
    canopy.triangles = {{0, 1, 2}};
    expect_truth(test::make_scene({test::ground(kFar_m), canopy, caster_box()}), from_above(),
                 {hard_sun(), point({3.0f, 6.0f, 1.0f})});
}

}  // namespace

}  // namespace gnomon
