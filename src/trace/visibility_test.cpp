// Visibility against closed forms, and rays against the surfaces that they start on.

#include "trace/light_sample.h"
#include "trace/test_scenes.h"
#include "trace/tracer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace gnomon::trace {
namespace {

struct Estimate {
    double mean, standard_error;
};

/// The same receiver many times: each draws its own samples.
Estimate estimate(const Tracer& tracer, const Receiver& receiver, const Light& light, int samples) {
    constexpr int kRuns = 400;
    const std::vector<Receiver> receivers(kRuns, receiver);
    double sum = 0.0;
    double squares = 0.0;
    for (const float v : visibility(tracer, receivers, light, samples)) {
        sum += v;
        squares += double{v} * v;
    }
    const double mean = sum / kRuns;
    const double variance = std::max(0.0, squares / kRuns - mean * mean);
    return {mean, std::sqrt(variance / (kRuns - 1))};
}

/// Random points on every triangle of instance 0, corners and edges included.
std::vector<Receiver> scattered(const Scene& scene, int per_triangle) {
    std::vector<Receiver> receivers;
    const Mesh& mesh = scene.meshes()[scene.instances()[0].mesh];
    for (std::uint32_t primitive = 0; primitive < mesh.triangles.size(); ++primitive) {
        const SurfaceId id{0, primitive};
        const Triangle triangle = world_triangle(scene, id);
        const DVec3 normal = glm::normalize(triangle.front_normal_ws());
        for (int i = 0; i < per_triangle; ++i) {
            Vec2 u = random_2d(primitive, static_cast<std::uint32_t>(i), 5);
            if (u.x + u.y > 1.0f) u = 1.0f - u;
            if (i % 4 == 1) u.x = 0.0f;
            if (i % 4 == 2) u.y = 1.0f - u.x;
            const auto& [a, b, c] = triangle.corners_ws;
            const DVec3 point = a + double{u.x} * (b - a) + double{u.y} * (c - a);
            receivers.push_back(receiver_on(triangle, id, point + normal, -normal));
        }
    }
    return receivers;
}

/// Every receiver sees the sun that stands `elevation` above its own plane, from all sides.
void expect_all_lit(const Scene& scene, const std::vector<Receiver>& receivers,
                    float elevation_deg) {
    const Tracer tracer = make_tracer(scene);
    int dark = 0;
    for (const Receiver& receiver : receivers) {
        const Vec3 n = receiver.normal_ws;
        const Vec3 s =
            normalize(glm::cross(n, std::abs(n.x) < 0.5f ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
        const Vec3 t = glm::cross(n, s);
        for (int i = 0; i < 8; ++i) {
            const float azimuth = radians(45.0f * static_cast<float>(i) + 3.0f);
            const float elevation = radians(elevation_deg);
            DirectionalLight light;
            light.to_light_ws =
                std::cos(elevation) * (std::cos(azimuth) * s + std::sin(azimuth) * t) +
                std::sin(elevation) * n;
            if (visibility(tracer, {&receiver, 1}, light).front() != 1.0f) ++dark;
        }
    }
    EXPECT_EQ(dark, 0) << "of " << 8 * receivers.size() << " at " << elevation_deg << "°";
}

constexpr float kElevationsDeg[] = {90.0f, 10.0f, 1.0f, 0.1f, 0.01f};

// ---- Penumbrae. The occluder is the half-plane x < 0 at half the light's height, so that from
// ground point x the light is seen where its own x is above -x. The light is so high that weights
// vary by less than 1e-6 over it: visibility is the fraction of its area.

constexpr float kLightHeight = 1000.0f;
constexpr float kLightRadius = 0.5f;

Scene half_plane() {
    return make_scene({{quad({-20, 0.5f * kLightHeight, -20}, {20, 0, 0}, {0, 0, 40})}});
}

TEST(Visibility, DiscOverHalfPlaneIsTheAreaFraction) {
    const Tracer tracer = make_tracer(half_plane());
    const DiscLight light{.center_ws = {0, kLightHeight, 0}, .radius_m = kLightRadius};
    double last = -1.0;
    for (int step = -4; step <= 4; ++step) {
        const float x = 0.11f * static_cast<float>(step);
        const double c = std::clamp(-double{x} / kLightRadius, -1.0, 1.0);
        const double expected = (std::acos(c) - c * std::sqrt(1.0 - c * c)) / kPi;
        const Estimate found = estimate(tracer, on_ground(x), light, 64);
        EXPECT_NEAR(found.mean, expected, 4.0 * found.standard_error + 1e-6) << x;
        EXPECT_GT(found.mean, last);
        last = found.mean;
    }
}

TEST(Visibility, RectangleOverHalfPlaneIsTheAreaFraction) {
    const Tracer tracer = make_tracer(half_plane());
    const RectLight light{.center_ws = {0, kLightHeight, 0},
                          .half_u_ws = {kLightRadius, 0, 0},
                          .half_v_ws = {0, 0, 1.0f}};
    for (const float x : {-0.6f, -0.4f, -0.13f, 0.0f, 0.3f, 0.6f}) {
        const double expected = std::clamp(0.5 + double{x}, 0.0, 1.0);
        const Estimate found = estimate(tracer, on_ground(x), light, 61);
        EXPECT_NEAR(found.mean, expected, 4.0 * found.standard_error + 1e-6) << x;
    }
}

TEST(Visibility, StratificationBeatsRandomSamples) {
    const DiscLight light{.center_ws = {0, kLightHeight, 0}, .radius_m = kLightRadius};
    const Estimate found = estimate(make_tracer(half_plane()), on_ground(0.1f), light, 256);
    // Random samples: sqrt(p (1 - p) / 256 / 400) with p = 0.63. Strata off the edge add nothing:
    // about 16 of 256 are on it.
    const double random_error = std::sqrt(0.63 * 0.37 / 256.0 / 400.0);
    EXPECT_LT(found.standard_error, 0.5 * random_error);
    EXPECT_GT(found.standard_error, 0.0);
}

TEST(Visibility, CountsOnlyWhatIsAboveTheHorizon) {
    // Half of the sphere is below the horizon. By symmetry a wall that hides z > 0 hides half of
    // what counts, and one below the horizon nothing.
    const SphereLight light{.center_ws = {10, 0, 0}, .radius_m = 1.0f};
    const Scene half = make_scene({{quad({5, -5, 0}, {0, 10, 0}, {0, 0, 5})}});
    const Estimate found = estimate(make_tracer(half), on_ground(0), light, 64);
    EXPECT_NEAR(found.mean, 0.5, 4.0 * found.standard_error);
    const Scene below = make_scene({{quad({5, -5, -5}, {0, 5, 0}, {0, 0, 10})}});
    EXPECT_EQ(visibility(below, on_ground(0), light, 64), 1.0f);
}

TEST(Visibility, LightBarelyAboveTheHorizonIsStillAnswered) {
    const SphereLight light{.center_ws = {10, -0.9999f, 0}, .radius_m = 1.0f};
    EXPECT_EQ(visibility(Scene(), on_ground(0), light, 4), 1.0f);
    const Scene wall = make_scene({{quad({5, -5, -5}, {0, 10, 0}, {0, 0, 10})}});
    EXPECT_EQ(visibility(wall, on_ground(0), light, 4), 0.0f);
}

// ---- Hard shadows

TEST(Visibility, ColumnsShadowHasItsLength) {
    constexpr float kHeight = 10.0f;
    Mat4 place = moved({0, 0.5f * kHeight, 0});
    place[0][0] = place[2][2] = 0.5f;
    place[1][1] = 0.5f * kHeight;
    const Scene scene =
        make_scene({{cube(), {place}}, {quad({-50, 0, -50}, {0, 0, 100}, {100, 0, 0})}});
    const Tracer tracer = make_tracer(scene);
    for (const float elevation_deg : {15.0f, 30.0f, 60.0f}) {
        const float elevation = radians(elevation_deg);
        // East sun: the shadow runs west from the west face.
        const float tip = -0.5f - kHeight / std::tan(elevation);
        const DirectionalLight light = sun(elevation, radians(90.0f), 0.0f);
        // Float's rounding of the tip and of the ray that grazes the roof's edge, 40 m away.
        const float tolerance = 2e-5f;
        const std::vector<Receiver> receivers = {on_ground(tip + tolerance),
                                                 on_ground(tip - tolerance), on_ground(-0.75f),
                                                 on_ground(tip + 1.0f, 0.51f)};
        EXPECT_EQ(visibility(tracer, receivers, light), (std::vector<float>{0, 1, 0, 1}));
    }
}

TEST(Visibility, PointLightIsNotShadowedByWhatIsBehindIt) {
    const Scene scene = make_scene({{quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2})}});
    EXPECT_EQ(visibility(scene, on_ground(0), PointLight{.position_ws = {0, 1.9999f, 0}}), 1.0f);
    EXPECT_EQ(visibility(scene, on_ground(0), PointLight{.position_ws = {0, 2.0001f, 0}}), 0.0f);
    EXPECT_EQ(visibility(scene, on_ground(0), SpotLight{.position_ws = {0, 3, 0}}), 0.0f);
    EXPECT_EQ(visibility(scene, on_ground(3), SpotLight{.position_ws = {3, 3, 0}}), 1.0f);
}

TEST(Visibility, LampFlushWithTheCeilingShines) {
    const Scene scene = make_scene({{tiles(7), {far_and_turned()}}});
    const Mat4 place = far_and_turned();
    const Vec3 down = -Vec3(place[1]);
    const Receiver below{
        Vec3(place[3]) + 3.0f * down + 0.3f * Vec3(place[0]), -down, {kNoSurface, 0}};
    const RectLight light{.center_ws = Vec3(place[3]),
                          .half_u_ws = 0.4f * Vec3(place[0]),
                          .half_v_ws = 0.4f * Vec3(place[2])};  // cross(X, Z) = -Y
    EXPECT_EQ(visibility(scene, below, light, 256), 1.0f);
}

// ---- Own surface

TEST(SelfShadow, CubeNeverDarkensItselfFarFromTheOrigin) {
    const Scene flattened = make_scene({{cube(), {far_and_turned()}}});
    const Scene instanced = make_scene({{cube(), {far_and_turned(), moved({0, -3000, 0})}}});
    for (const float elevation_deg : kElevationsDeg) {
        expect_all_lit(flattened, scattered(flattened, 40), elevation_deg);
        expect_all_lit(instanced, scattered(instanced, 40), elevation_deg);
    }
}

TEST(SelfShadow, CoplanarNeighboursAndDuplicatesNeverBlock) {
    const Mat4 large = glm::scale(far_and_turned(), Vec3(50.0f));
    const Scene once = make_scene({{tiles(8), {large}}});
    const Scene twice = make_scene({{tiles(8), {large, large}}, {tiles(3), {large}}});
    for (const float elevation_deg : kElevationsDeg) {
        expect_all_lit(once, scattered(once, 8), elevation_deg);
        expect_all_lit(twice, scattered(twice, 8), elevation_deg);
    }
}

TEST(SelfShadow, ContactShadowsAreKept) {
    // A wall on the ground; receivers as near to it as a millimetre, a kilometre from the origin.
    const Vec3 foot(1000, 0, 1000);
    const Scene scene = make_scene({{quad(foot + Vec3(-50, 0, -50), {0, 0, 100}, {100, 0, 0})},
                                    {quad(foot + Vec3(0, 0, -50), {0, 20, 0}, {0, 0, 100})}});
    const Tracer tracer = make_tracer(scene);
    for (const float distance_m : {1e-3f, 0.1f, 5.0f}) {
        const Receiver receiver{foot + Vec3(-distance_m, 0, 3), {0, 1, 0}, {0, 0}};
        for (const float elevation_deg : {60.0f, 10.0f, 1.0f, 0.1f}) {
            const float elevation = radians(elevation_deg);
            const auto seen = [&](float azimuth_deg) {
                return visibility(tracer, {&receiver, 1},
                                  sun(elevation, radians(azimuth_deg), 0.0f))
                    .front();
            };
            EXPECT_EQ(seen(80.0f), 0.0f) << distance_m << " m, " << elevation_deg << "°";
            EXPECT_EQ(seen(260.0f), 1.0f) << distance_m << " m, " << elevation_deg << "°";
        }
    }
}

TEST(SelfShadow, ClosedRoomIsDark) {
    // Inside a box whose walls are shared edges only, lights outside: nothing may leak in.
    Mesh room = cube();
    const Scene scene = make_scene({{room, {glm::scale(far_and_turned(), Vec3(4.0f))}}});
    std::vector<Receiver> receivers = scattered(scene, 60);
    for (Receiver& receiver : receivers)
        receiver.normal_ws = -receiver.normal_ws;  // inwards
    const Tracer tracer = make_tracer(scene);
    for (const float azimuth_deg : {10.0f, 130.0f, 250.0f}) {
        const std::vector<float> seen =
            visibility(tracer, receivers, sun(radians(40.0f), radians(azimuth_deg)), 16);
        EXPECT_EQ(*std::ranges::max_element(seen), 0.0f);
    }
}

// ---- Alpha

TEST(Alpha, HolesLetLightThrough) {
    Material leaf;
    leaf.base_color_texture = 0;
    leaf.alpha_cutoff = 0.5f;
    Texture half;
    half.size = {2, 1};
    half.wrap_u = TextureWrap::clamp;
    half.rgba = {0, 0, 0, 0, 0, 0, 0, 255};
    for (const std::vector<Mat4>& places :
         {std::vector<Mat4>{Mat4(1.0f)}, std::vector<Mat4>{Mat4(1.0f), moved({0, -5, 0})}}) {
        const Scene scene =
            make_scene({{quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}), places}}, leaf, {half});
        const DirectionalLight light;
        // The texture crosses 0.5 in the middle, where x = 0.
        const std::vector<Receiver> receivers = {on_ground(-0.01f), on_ground(0.01f)};
        EXPECT_EQ(visibility(make_tracer(scene), receivers, light), (std::vector<float>{1, 0}));
        EXPECT_EQ(visibility(make_tracer(scene, true), receivers, light),
                  (std::vector<float>{0, 0}));
    }
}

}  // namespace
}  // namespace gnomon::trace
