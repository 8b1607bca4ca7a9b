#include "raster/receivers.h"

#include "raster/drawn_test.h"
#include "raster/small_scene_test.h"

#include <glm/ext/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

#include <random>

namespace gnomon::raster {
namespace {

constexpr Extent kSize{16, 16};

/// octahedral.glsl, and some roundings of normalised floats.
constexpr float kNormalTolerance = 7e-5f;

class ReceiversTest : public gpu::DeviceTest {
protected:
    void SetUp() override {
        DeviceTest::SetUp();
        pass_.emplace(device());
        submission_.emplace(device());
    }
    void TearDown() override {
        submission_.reset();
        pass_.reset();
        DeviceTest::TearDown();
    }

    void draw(const Scene& scene, const Camera& camera, Extent size, bool ignore_alpha,
              Receivers& out) {
        const GpuScene gpu_scene(device(), scene);
        gpu::Commands commands = submission_->begin();
        pass_->record(commands, gpu_scene, camera, size, ignore_alpha, out);
        submission_->submit_and_wait();
    }

    Drawn drawn(const Scene& scene, const Camera& camera, Extent size = kSize,
                bool ignore_alpha = false) {
        Receivers receivers;
        draw(scene, camera, size, ignore_alpha, receivers);
        return read_back(device(), receivers);
    }

private:
    std::optional<ReceiverPass> pass_;
    std::optional<gpu::Submission> submission_;
};

/// At the origin, along -Z, 90° wide and high.
Camera forward_camera(float near_m = 0.1f) {
    Camera camera;
    camera.fov_y_rad = radians(90.0f);
    camera.near_m = near_m;
    return camera;
}

std::size_t count_of(const Drawn& drawn, std::uint32_t instance) {
    std::size_t count = 0;
    for (const glm::uvec2 id : drawn.ids)
        count += id.x == instance ? 1 : 0;
    return count;
}

TEST_F(ReceiversTest, AreNoneInAnEmptyScene) {
    for (const Scene& scene : {Scene(), Scene(scene_data({Mesh{}}))}) {
        const Drawn seen = drawn(scene, forward_camera());
        EXPECT_EQ(count_of(seen, kNoReceiver), seen.ids.size());
        EXPECT_EQ(seen.depths, std::vector<float>(seen.ids.size(), 0.0f));
    }
}

TEST_F(ReceiversTest, HaveReversedDepthWithoutAFarPlane) {
    for (const float distance_m : {0.5f, 5.0f, 5e3f, 5e6f}) {
        const Scene scene(scene_data({wall({0, 0, -distance_m}, 4 * distance_m)}));
        const Drawn seen = drawn(scene, forward_camera());
        EXPECT_EQ(count_of(seen, 0), seen.ids.size());
        for (const float depth : seen.depths) {
            // A rasteriser interpolates in float: some roundings.
            EXPECT_NEAR(depth, 0.1f / distance_m, 1e-6f * 0.1f / distance_m);
        }
    }
}

TEST_F(ReceiversTest, NearerOnesHideFartherOnesInAnyOrderAtAnyDistance) {
    for (const float distance_m : {1.0f, 1e3f, 1e6f}) {
        // A thousandth apart, far above what float resolves.
        const Mesh near = wall({0, 0, -distance_m}, 4 * distance_m);
        const Mesh far = wall({0, 0, -1.001f * distance_m}, 4 * distance_m);
        const Drawn first = drawn(Scene(scene_data({near, far})), forward_camera());
        EXPECT_EQ(count_of(first, 0), first.ids.size());
        const Drawn last = drawn(Scene(scene_data({far, near})), forward_camera());
        EXPECT_EQ(count_of(last, 1), last.ids.size());
    }
}

TEST_F(ReceiversTest, BeginAtTheNearPlane) {
    const Scene scene(scene_data({wall({0, 0, -0.5f}, 4)}));
    EXPECT_EQ(count_of(drawn(scene, forward_camera(0.49f)), 0), kSize.width * kSize.height);
    EXPECT_EQ(count_of(drawn(scene, forward_camera(0.51f)), 0), 0u);
}

TEST_F(ReceiversTest, OfAParallelCameraEndAtItsFarPlane) {
    Camera camera;
    camera.near_m = 1.0f;
    camera.ortho_height_m = 2.0f;
    camera.ortho_depth_m = 11.0f;
    for (const float distance_m : {1.5f, 6.0f, 10.5f}) {
        const Drawn seen = drawn(Scene(scene_data({wall({0, 0, -distance_m}, 4)})), camera);
        for (const float depth : seen.depths)
            EXPECT_NEAR(depth, (11.0f - distance_m) / 10.0f, 1e-6f);
    }
    EXPECT_EQ(count_of(drawn(Scene(scene_data({wall({0, 0, -11.5f}, 4)})), camera), 0), 0u);
}

TEST_F(ReceiversTest, ShowTheirFrontUnlessTheMaterialHasTwo) {
    for (const bool double_sided : {false, true}) {
        for (const bool mirrored : {false, true}) {
            for (const bool turned : {false, true}) {
                SceneData data = scene_data({wall({0, 0, -5}, 40)});
                data.materials[0].double_sided = double_sided;
                Mat4& place = data.instances[0].world_from_local;
                if (turned) {
                    const float half_turn = glm::radians(180.0f);
                    place = glm::translate(place, {0, 0, -10});
                    place = glm::rotate(place, half_turn, {0, 1, 0});
                }
                // The mirror image of a front is a front.
                if (mirrored) place = glm::scale(place, {-1, 1, 1});
                const Drawn seen = drawn(Scene(std::move(data)), forward_camera());
                const std::size_t visible = double_sided || !turned ? seen.ids.size() : 0;
                EXPECT_EQ(count_of(seen, 0), visible)
                    << "double-sided " << double_sided << ", mirrored " << mirrored << ", turned "
                    << turned;
                if (visible > 0) {
                    EXPECT_LT(glm::distance(seen.normal_ws(3, 7), Vec3(0, 0, 1)), kNormalTolerance);
                }
            }
        }
    }
}

TEST_F(ReceiversTest, HaveTheIndexOfTheirInstanceHoweverDrawn) {
    // Four walls side by side, whose materials are drawn in another order; each leans back more.
    SceneData data = scene_data({});
    const auto lean_rad = [](std::uint32_t i) { return -0.1f * static_cast<float>(i); };
    for (std::uint32_t i = 0; i < 4; ++i) {
        data.meshes.push_back(wall({-3.0f + 2.0f * static_cast<float>(i), 0, 0}, 2));
        data.meshes[i].material = i;
        data.instances.push_back({.mesh = i});
        const Mat4 place = glm::translate(Mat4(1.0f), {0, 0, -4});
        data.instances[i].world_from_local = glm::rotate(place, lean_rad(i), {1, 0, 0});
    }
    data.materials.resize(4);
    data.materials[0].alpha_cutoff = 0.5f;
    data.materials[2].double_sided = false;
    const Drawn seen = drawn(Scene(std::move(data)), forward_camera());
    for (unsigned x = 0; x < 16; ++x) {
        EXPECT_EQ(seen.instance(x, 8), x / 4);
        const Vec3 normal(0, -std::sin(lean_rad(x / 4)), std::cos(lean_rad(x / 4)));
        EXPECT_LT(glm::distance(seen.normal_ws(x, 8), normal), kNormalTolerance);
    }
}

TEST_F(ReceiversTest, HaveTheIndexOfTheirTriangle) {
    // The diagonal of a square of two triangles, of its second instance.
    SceneData data = scene_data({wall({0, 0, -8}, 16)});
    data.instances.push_back({.mesh = 0});
    data.instances[0].world_from_local = glm::translate(Mat4(1.0f), {0, 0, -10});
    const Drawn seen = drawn(Scene(std::move(data)), forward_camera());
    for (unsigned y = 0; y < 16; ++y) {
        for (unsigned x = 0; x < 16; ++x) {
            EXPECT_EQ(seen.instance(x, y), 1u);
            // The first triangle is right of and below the diagonal, on which nobody can say.
            if (x + y == 15) continue;
            EXPECT_EQ(seen.ids[seen.index(x, y)].y, x + y > 15 ? 0u : 1u);
        }
    }
}

/// A wall whose texture is opaque to the right only.
SceneData half_wall() {
    SceneData data = scene_data({wall({0, 0, -1}, 2), wall({0, 0, -2}, 4)});
    data.materials.resize(2);
    data.meshes[1].material = 1;
    data.textures.push_back({.name = "half", .size = {2, 1}, .rgba = {9, 9, 9, 0, 9, 9, 9, 255}});
    data.materials[0].base_color_texture = 0;
    data.materials[0].alpha_cutoff = 0.5f;
    return data;
}

TEST_F(ReceiversTest, AreSeenThroughHoles) {
    const Scene scene(half_wall());
    const Drawn masked = drawn(scene, forward_camera());
    const Drawn solid = drawn(scene, forward_camera(), kSize, true);
    EXPECT_EQ(count_of(solid, 0), solid.ids.size());
    for (unsigned x = 0; x < 16; ++x) {
        // Between texel centres at 1/4 and 3/4, alpha is 1/2 in the middle, which wraps round.
        const bool opaque = x >= 8;
        EXPECT_EQ(masked.instance(x, 5), opaque ? 0u : 1u) << x;
    }
}

TEST_F(ReceiversTest, HaveHolesByTheProductOfAllAlphas) {
    SceneData data = half_wall();
    const std::size_t pixels = kSize.width * kSize.height;
    data.materials[0].base_color_texture = -1;
    data.materials[0].base_color.a = 0.8f;
    EXPECT_EQ(count_of(drawn(Scene(data), forward_camera()), 0), pixels);
    data.meshes[0].colors.assign(4, Vec4(1, 1, 1, 0.6f));  // 0.48 is below the cutoff
    EXPECT_EQ(count_of(drawn(Scene(data), forward_camera()), 0), 0u);
    data.materials[0].alpha_cutoff = 0.45f;
    EXPECT_EQ(count_of(drawn(Scene(data), forward_camera()), 0), pixels);
}

TEST_F(ReceiversTest, HaveTheHolesOfTheirOwnMaterial) {
    // Two masked walls side by side, of which the second is all hole.
    SceneData data = scene_data({wall({-2, 0, -4}, 4), wall({2, 0, -4}, 4)});
    data.materials.assign(2, {.alpha_cutoff = 0.5f});
    data.materials[1].base_color.a = 0.4f;
    data.meshes[1].material = 1;
    const Drawn seen = drawn(Scene(std::move(data)), forward_camera());
    for (unsigned x = 0; x < 16; ++x)
        EXPECT_EQ(seen.instance(x, 8), x < 8 ? 0u : kNoReceiver);
}

TEST_F(ReceiversTest, HaveHolesWhereTheTextureIsMoved) {
    SceneData data = half_wall();
    data.materials[0].uv_offset = {0.5f, 0.0f};
    const Drawn seen = drawn(Scene(data), forward_camera());
    for (unsigned x = 0; x < 16; ++x)
        EXPECT_EQ(seen.instance(x, 5), x < 8 ? 0u : 1u) << x;
    data.textures[0].wrap_u = TextureWrap::clamp;  // beyond the right end: opaque
    EXPECT_EQ(count_of(drawn(Scene(data), forward_camera()), 1), 0u);
}

TEST_F(ReceiversTest, AreDrawnAnewInAnotherSize) {
    const Scene scene(scene_data({wall({0, 0, -5}, 100)}));
    Receivers receivers;
    for (const Extent size : {Extent{16, 16}, Extent{1, 1}, Extent{33, 7}, Extent{33, 7}}) {
        draw(scene, forward_camera(), size, false, receivers);
        const Drawn seen = read_back(device(), receivers);
        EXPECT_EQ(seen.ids.size(), std::size_t{size.width} * size.height);
        EXPECT_EQ(count_of(seen, 0), seen.ids.size());
    }
}

/// Triangles in all directions in a cube about the origin.
Mesh random_triangles(int count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    const auto point = [&](float reach) {
        return reach * Vec3(unit(random), unit(random), unit(random));
    };
    Mesh mesh;
    for (int i = 0; i < count; ++i) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        const Vec3 center = point(2.0f);
        for (int corner = 0; corner < 3; ++corner)
            mesh.positions.push_back(center + point(1.0f));
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

TEST_F(ReceiversTest, HaveThePlaneOfTheirTriangle) {
    SceneData data = scene_data({random_triangles(300)});
    data.instances[0].world_from_local =
        glm::rotate(glm::scale(Mat4(1.0f), {1.5f, 0.7f, -1.0f}), 0.6f, normalize(Vec3(1, 2, 3)));
    const Scene scene(std::move(data));
    const Mesh& mesh = scene.meshes()[0];
    for (const Vec3 eye : {Vec3(3, 2, 6), Vec3(-5, 1, 0.5f), Vec3(0.1f, -8, 0)}) {
        const Drawn seen = drawn(scene, look_at(eye, Vec3(0)), {64, 64});
        std::size_t compared = 0;
        for (unsigned y = 0; y < 64; ++y) {
            for (unsigned x = 0; x < 64; ++x) {
                if (seen.instance(x, y) == kNoReceiver) continue;
                const UVec3 t = mesh.triangles[seen.ids[seen.index(x, y)].y];
                const auto corner = [&](std::uint32_t i) {
                    const Mat4& place = scene.instances()[0].world_from_local;
                    return DVec3(glm::dmat4(place) * glm::dvec4(DVec3(mesh.positions[i]), 1.0));
                };
                const DVec3 a = corner(t.x);
                DVec3 normal = glm::normalize(glm::cross(corner(t.y) - a, corner(t.z) - a));
                const DVec3 p(seen.position_ws(x, y));
                if (glm::dot(normal, DVec3(eye) - p) < 0.0) normal = -normal;
                EXPECT_LT(glm::distance(normal, DVec3(seen.normal_ws(x, y))), kNormalTolerance);
                // Depths of rasterised triangles are exact to some roundings of float, which a
                // glancing view enlarges.
                const double distance_m = glm::distance(DVec3(eye), p);
                EXPECT_LT(std::abs(glm::dot(normal, p - a)), 5e-6 * distance_m);
                ++compared;
            }
        }
        EXPECT_GT(compared, 500u);
    }
}

}  // namespace
}  // namespace gnomon::raster
