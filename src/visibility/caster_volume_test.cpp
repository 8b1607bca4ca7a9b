#include "visibility/caster_volume.h"

#include "visibility/seen.h"

#include <glm/ext/matrix_double4x4.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace gnomon {
namespace {

class CasterVolumeTest : public testing::Test {
protected:
    float uniform(float low, float high) {
        return std::uniform_real_distribution<float>(low, high)(engine_);
    }
    Vec3 point(float half) {
        return {uniform(-half, half), uniform(-half, half), uniform(-half, half)};
    }

    std::mt19937 engine_{11};
};

Box3 around(Vec3 p, float half) {
    Box3 box;
    box.include(p - Vec3(half));
    box.include(p + Vec3(half));
    return box;
}

constexpr Extent kSize{160, 90};

TEST_F(CasterVolumeTest, HoldsWhatIsBetweenAReceiverAndTheLight) {
    int tested = 0;
    for (int round = 0; round < 300; ++round) {
        Box3 bounds;
        bounds.include(Vec3(-20, 0, -20));
        bounds.include(Vec3(20, 10, 20));
        const Camera camera = look_at(point(30.0f), point(10.0f), radians(uniform(20, 100)));
        DirectionalLight light{.to_light_ws = normalize(point(1.0f) + Vec3(0, 0.01f, 0))};
        const std::vector<DVec3> receivers_ws = visible_corners(camera, kSize, bounds);
        if (receivers_ws.empty()) continue;
        const LightFit fit = fit_directional(light, receivers_ws, bounds, 512, 2.0f);
        const CasterVolume volume(fit, DVec3(light.to_light_ws),
                                  visible_planes(camera, kSize, bounds), 50.0);
        for (int i = 0; i < 20; ++i) {
            // Any point of the receivers' polytope is a mean of its corners.
            DVec3 receiver(0.0);
            double weights = 0.0;
            for (const DVec3& corner : receivers_ws) {
                const double weight = static_cast<double>(uniform(0, 1));
                receiver += weight * corner;
                weights += weight;
            }
            const Vec3 caster = Vec3(receiver / weights) + uniform(0, 30) * light.to_light_ws;
            EXPECT_TRUE(volume.holds(around(caster, 0.05f)));
            ++tested;
        }
    }
    EXPECT_GT(tested, 1000);
}

TEST_F(CasterVolumeTest, LeavesOutWhatIsBehindReceiversAndBesideThem) {
    Box3 bounds;
    bounds.include(Vec3(-20, 0, -20));
    bounds.include(Vec3(20, 10, 20));
    const Camera camera = look_at({0, 5, 18}, {0, 2, 0}, radians(40.0f));
    const DirectionalLight light{.to_light_ws = {0, 1, 0}};
    const LightFit fit =
        fit_directional(light, visible_corners(camera, kSize, bounds), bounds, 512, 2.0f);
    const CasterVolume volume(fit, DVec3(0, 1, 0), visible_planes(camera, kSize, bounds), 50.0);
    EXPECT_TRUE(volume.holds(around({0, 30, 0}, 1)));   // above
    EXPECT_FALSE(volume.holds(around({0, -5, 0}, 1)));  // below
    EXPECT_FALSE(volume.holds(around({0, 5, 25}, 1)));  // behind the camera
    EXPECT_FALSE(volume.holds(around({60, 5, 0}, 1)));  // beside
    Box3 ground;
    ground.include(Vec3(-20, 0, -20));
    ground.include(Vec3(20, 0, 20));
    EXPECT_FALSE(volume.holds(ground));  // touches only
    EXPECT_TRUE(CasterVolume().holds(around({0, -5, 0}, 1)));
}

TEST_F(CasterVolumeTest, SeenPartsTellWhereReceiversBegin) {
    const Camera camera = look_at({0, 0, 0}, {0, 0, -1}, radians(40.0f));
    const std::vector<Box3> boxes{around({0, 0, -30}, 1), around({0, 0, -12}, 2),
                                  around({0, 0, 5}, 2), around({50, 0, -12}, 2), Box3()};
    const Seen seen = seen_part(camera, kSize, boxes);
    EXPECT_NEAR(seen.range.near_m, 10.0, 1e-2);
    EXPECT_NEAR(seen.range.far_m, 31.0, 1e-2);
    EXPECT_FLOAT_EQ(seen.bounds.max.x, 2.0f);
    EXPECT_FLOAT_EQ(seen.bounds.max.z, -10.0f);

    // A ground that begins behind the camera is seen from where the frustum meets it; flat boxes
    // are thickened by a ten-thousandth of their size.
    Box3 ground;
    ground.include(Vec3(-100, -3, -100));
    ground.include(Vec3(100, -3, 100));
    EXPECT_NEAR(seen_part(camera, kSize, {&ground, 1}).range.near_m, 3.0 / std::tan(radians(20.0)),
                0.1);
    EXPECT_TRUE(seen_part(camera, kSize, {boxes.data() + 2, 1}).bounds.empty());
    EXPECT_TRUE(seen_part(camera, kSize, {}).bounds.empty());
}

TEST_F(CasterVolumeTest, TilesTellWhatIsSeenBetweenDistances) {
    const Seen seen = seen_in({{around({0, 0, -10}, 1), {9.0, 11.0}},
                               {around({5, 0, -10}, 1), {9.0, 12.0}},
                               {around({0, 0, -50}, 2), {48.0, 52.0}}});
    EXPECT_EQ(seen.range.far_m, 52.0);
    const std::vector<DepthRange> occupied = seen.occupied();
    ASSERT_EQ(occupied.size(), 2u);
    EXPECT_EQ(occupied[0].far_m, 12.0);
    EXPECT_EQ(occupied[1].near_m, 48.0);
    const Seen near = seen.within({11.5, 40.0});
    EXPECT_EQ(near.range.near_m, 11.5);
    EXPECT_EQ(near.range.far_m, 12.0);
    EXPECT_FLOAT_EQ(near.bounds.min.x, 4.0f);
    EXPECT_TRUE(seen.within({20.0, 40.0}).bounds.empty());
    const glm::dvec4 left(-1.0, 0.0, 0.0, 2.0);  // x <= 2
    EXPECT_FLOAT_EQ(seen.within({}, {&left, 1}).bounds.max.x, 2.0f);
    EXPECT_TRUE(seen_in({}).bounds.empty());
}

TEST_F(CasterVolumeTest, DistancesAndDepthsAreInverse) {
    Camera camera = look_at({0, 5, 18}, {0, 2, 0}, radians(40.0f));
    for (const float height_m : {0.0f, 10.0f}) {
        camera.ortho_height_m = height_m;
        camera.ortho_depth_m = height_m > 0.0f ? 100.0f : 0.0f;
        for (const double distance_m : {0.2, 3.0, 80.0}) {
            EXPECT_NEAR(distance_at(camera, kSize, depth_at(camera, kSize, distance_m)), distance_m,
                        1e-4 * std::max(1.0, distance_m));
        }
    }
}

}  // namespace
}  // namespace gnomon
