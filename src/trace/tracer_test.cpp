#include "trace/tracer.h"

#include <gnomon/error.h>

#include "trace/test_scenes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

namespace gnomon::trace {
namespace {

// ---- Determinism, degenerate input

/// Cubes over tiles, `instanced` or each with its own mesh, and a camera that sees them.
Scene playground(bool instanced) {
    std::vector<Placed> parts = {{tiles(4), {glm::scale(Mat4(1.0f), Vec3(20.0f))}}};
    std::vector<Mat4> places;
    for (int i = 0; i < 12; ++i) {
        const float x = static_cast<float>(i % 4) * 5.0f - 8.0f;
        const float z = static_cast<float>(i / 4) * 5.0f - 5.0f;
        Mat4 place = glm::rotate(moved({x, 1.5f, z}), 0.4f * static_cast<float>(i), Vec3(0, 1, 0));
        if (i % 3 == 0) place[0] = -place[0];  // mirrors
        places.push_back(place);
    }
    if (instanced) {
        parts.push_back({cube(), places});
    } else {
        for (const Mat4& place : places)
            parts.push_back({cube(), {place}});
    }
    Material single_sided;
    single_sided.double_sided = false;
    return make_scene(parts, single_sided);
}

const Camera kCamera = look_at({12, 14, 20}, {0, 0, 0});
constexpr Extent kSize{97, 61};

struct Picture {
    std::vector<SurfaceId> surfaces;
    std::vector<float> visibility;
};

Picture trace(const Scene& scene, const Light& light, int samples, unsigned seed) {
    Progress progress;
    const Tracer tracer(scene, false, progress);
    Picture picture;
    picture.surfaces = tracer.visible_surfaces(kCamera, kSize, progress);
    const std::vector<Receiver> receivers = tracer.receivers(kCamera, kSize, picture.surfaces);
    picture.visibility.resize(receivers.size());
    tracer.visibility(receivers, kSize, light, samples, seed, picture.visibility, progress);
    return picture;
}

const SphereLight kLamp{.center_ws = {-6, 12, 4}, .radius_m = 1.0f};

TEST(Tracer, InstancedIsFlattened) {
    const Light light = sun(radians(35.0f), radians(120.0f), 0.0f);
    const Picture instanced = trace(playground(true), light, 1, 1);
    const Picture flattened = trace(playground(false), light, 1, 1);
    int differ = 0;
    for (std::size_t i = 0; i < instanced.surfaces.size(); ++i) {
        differ += instanced.surfaces[i] != flattened.surfaces[i] ||
                  instanced.visibility[i] != flattened.visibility[i];
    }
    // Pixels whose centre is on an edge to the last bit may fall to either side: one in a thousand.
    EXPECT_LE(differ, static_cast<int>(kSize.width * kSize.height) / 1000);
    const auto dark = std::ranges::count(instanced.visibility, 0.0f);
    EXPECT_GT(dark, 100);
}

TEST(Tracer, SameSeedSameImageOnAnyNumberOfThreads) {
    const auto on_threads = [](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return trace(playground(true), kLamp, 13, 5);
    };
    const Picture one = on_threads(1);
    const Picture two = on_threads(2);
    EXPECT_EQ(one.surfaces, two.surfaces);
    EXPECT_EQ(one.visibility, two.visibility);
    EXPECT_NE(one.visibility, trace(playground(true), kLamp, 13, 6).visibility);
}

TEST(Tracer, EmptySceneIsLit) {
    const std::vector<Receiver> receivers = {
        on_ground(0), Receiver{}, {{0, 0, 0}, {0, -1, 0}, {kNoSurface, 0}}};
    for (const Light& light : {Light(sun(1.0f, 1.0f)), Light(PointLight{.position_ws = {0, 3, 0}}),
                               Light(DiscLight{.center_ws = {0, 3, 0}}), Light(kLamp)}) {
        EXPECT_EQ(visibility(make_tracer(Scene()), receivers, light, 7),
                  (std::vector<float>{1, 1, 0}))
            << light_kind(light);
    }
}

TEST(Tracer, DegenerateTrianglesAndMatricesAreHarmless) {
    Mesh flat = quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2});
    flat.triangles.push_back({0, 0, 1});
    flat.triangles.push_back({0, 1, 1});
    const Mat4 squashed = glm::scale(Mat4(1.0f), Vec3(1, 0, 1));  // no inverse: lies on the ground
    const Scene scene = make_scene({{flat, {Mat4(1.0f), squashed}}, {Mesh{}}});
    EXPECT_EQ(visibility(scene, on_ground(0.3f, 0.1f), DirectionalLight{}), 0.0f);
    EXPECT_EQ(visibility(scene, on_ground(3.0f), DirectionalLight{}), 1.0f);
}

TEST(Tracer, StopsWhenCancelled) {
    struct Cancel : Progress {
        bool cancelled() const override { return true; }
    } cancel;
    try {
        const Tracer tracer(playground(true), false, cancel);
        FAIL() << "did not throw";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::cancelled);
    }
    const Tracer tracer = make_tracer(playground(true));
    const Receiver receiver = on_ground(0);
    float out = 0.0f;
    EXPECT_THROW(tracer.visibility({&receiver, 1}, {1, 1}, kLamp, 4, 1, {&out, 1}, cancel), Error);
}

// ---- Cameras

TEST(Receivers, LieOnTheirPlaneAndUnderTheirPixel) {
    const Scene scene = playground(true);
    Camera parallel = kCamera;
    parallel.ortho_height_m = 30.0f;
    parallel.ortho_depth_m = 100.0f;
    for (const Camera& camera : {kCamera, parallel}) {
        Progress progress;
        const Tracer tracer = make_tracer(scene);
        const std::vector<SurfaceId> surfaces = tracer.visible_surfaces(camera, kSize, progress);
        const std::vector<Receiver> receivers = tracer.receivers(camera, kSize, surfaces);
        const Mat4 clip_from_world = camera.clip_from_world(kSize);
        int seen = 0;
        for (unsigned i = 0; i < receivers.size(); ++i) {
            const Receiver& receiver = receivers[i];
            ASSERT_EQ(receiver.id, surfaces[i]);
            if (!receiver.exists()) continue;
            ++seen;
            const Vec4 clip = clip_from_world * Vec4(receiver.position_ws, 1.0f);
            const float x = (0.5f + 0.5f * clip.x / clip.w) * kSize.width;
            const float y = (0.5f + 0.5f * clip.y / clip.w) * kSize.height;
            // Float matrices over 30 m, in pixels of about 0.3 m.
            EXPECT_NEAR(x, static_cast<float>(i % kSize.width) + 0.5f, 1e-3f);
            EXPECT_NEAR(y, static_cast<float>(i / kSize.width) + 0.5f, 1e-3f);
            EXPECT_GT(glm::dot(receiver.normal_ws, camera.eye_ws() - receiver.position_ws), 0.0f);
            EXPECT_NEAR(glm::length(receiver.normal_ws), 1.0f, 1e-6f);
        }
        EXPECT_GT(seen, 3000);
    }
}

TEST(VisibleSurfaces, BacksOfSingleSidedMaterialsAreNotSeen) {
    // A quad that faces +Y, as it is and mirrored; mirroring keeps what is the front.
    const Mat4 mirror = glm::scale(Mat4(1.0f), Vec3(-1, 1, 1));
    for (const bool double_sided : {false, true}) {
        for (const std::vector<Mat4>& places :
             {std::vector<Mat4>{Mat4(1.0f)}, {mirror}, {mirror, moved({0, -50, 0})}}) {
            Material material;
            material.double_sided = double_sided;
            const Scene scene =
                make_scene({{quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}), places}}, material);
            Progress progress;
            const Tracer tracer = make_tracer(scene);
            const auto sees = [&](Vec3 eye) {
                return tracer.visible_surfaces(look_at(eye, {0, 0, 0}), {1, 1}, progress)[0]
                           .instance == 0;
            };
            EXPECT_TRUE(sees({0.5f, 3, 0.2f}));
            EXPECT_EQ(sees({0.5f, -3, 0.2f}), double_sided);
        }
    }
}

TEST(Receivers, AreKeptInsideTheirTriangle) {
    const Scene scene = make_scene({{quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0})}});
    const Triangle triangle = world_triangle(scene, {0, 0});
    // Straight down beside the quad: a rasteriser says that the pixel is covered all the same.
    const Receiver receiver = receiver_on(triangle, {0, 0}, {-1.01, 5, 0.5}, {0, -1, 0});
    EXPECT_TRUE(receiver.exists());
    EXPECT_GE(receiver.position_ws.x, -1.0f);
    EXPECT_NEAR(receiver.position_ws.x, -1.0f, 1e-5f);
    EXPECT_EQ(receiver.position_ws.y, 0.0f);
    // Edge on, where the plane is met nowhere.
    const Receiver edge_on = receiver_on(triangle, {0, 0}, {5, 0, 0}, {-1, 0, 0});
    EXPECT_TRUE(std::isfinite(edge_on.position_ws.x) && std::abs(edge_on.position_ws.x) <= 1.0f);
    Triangle line = triangle;
    line.corners_ws[2] = line.corners_ws[1];
    EXPECT_FALSE(receiver_on(line, {0, 0}, {0, 5, 0}, {0, -1, 0}).exists());
}

// More rays than are traced at a time, to lights of both kinds.
TEST(Tracer, BlockedRaysAreThoseOfItsVisibility) {
    const Scene scene = playground(true);
    const Tracer tracer = make_tracer(scene);
    std::vector<Receiver> receivers;
    for (int i = 0; i < 1000; ++i)
        receivers.push_back(on_ground(0.02f * static_cast<float>(i) - 10.0f, 1.0f));
    const PointLight lamp{.position_ws = {-6, 12, 4}};
    const DirectionalLight hard_sun = sun(radians(40.0f), radians(30.0f), 0.0f);
    for (const Light& light : {Light(lamp), Light(hard_sun)}) {
        const bool to_infinity = std::holds_alternative<DirectionalLight>(light);
        std::vector<ShadowRay> rays;
        for (const Receiver& receiver : receivers) {
            const Vec3 direction =
                to_infinity ? hard_sun.to_light_ws : lamp.position_ws - receiver.position_ws;
            rays.push_back({&receiver, direction, to_infinity});
        }
        std::vector<std::uint8_t> blocked(rays.size());
        tracer.blocked(rays, blocked);
        const std::vector<float> visible = visibility(tracer, receivers, light);
        for (std::size_t i = 0; i < rays.size(); ++i)
            EXPECT_EQ(blocked[i], visible[i] == 0.0f ? 1 : 0) << light_kind(light) << ", " << i;
        EXPECT_GT(std::ranges::count(blocked, 1), 50);
        EXPECT_GT(std::ranges::count(blocked, 0), 50);
    }
}

}  // namespace
}  // namespace gnomon::trace
