#include <gnomon/bake.h>
#include <gnomon/error.h>

#include "bake/circle_path.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace gnomon {
namespace {

LightPath quarter() {
    return LightPath(LightPathKind::direction, Interpolation::spherical,
                     {{10.0, {1.0, 0.0, 0.0}}, {70.0, {0.0, 2.0, 0.0}}});
}

TEST(BakePathOfLight, HasTheKeysTimesAndTheDirectionsBetweenThem) {
    const BakePath path = bake_path(quarter(), 90, 0.01);
    EXPECT_EQ(path.steps(), 90);
    EXPECT_EQ(path.begin_s, 10.0);
    EXPECT_EQ(path.end_s, 70.0);
    EXPECT_EQ(path.angular_diameter_rad, 0.01);
    EXPECT_TRUE(path.place.empty());
    EXPECT_FALSE(path.summary.empty());
    const double half_step = 0.25 * std::numbers::pi / 90.0;
    EXPECT_NEAR(path.to_light_ws.front().y, std::sin(half_step), 1e-12);
    EXPECT_NEAR(glm::length(path.pole_ws - DVec3(0.0, 0.0, 1.0)), 0.0, 1e-12);
}

TEST(BakePathOfLight, FindsTheAxisOfASmallCircle) {
    const DVec3 axis = glm::normalize(DVec3(0.3, 0.7, -0.6));
    const BakePath circle = bake::circle_through({0.2, 0.9, 0.4}, axis, {0.0, 1.0, 0.0}, 40).path;
    std::vector<LightKey> keys;
    for (const DVec3& direction : circle.to_light_ws)
        keys.push_back({static_cast<double>(keys.size()), direction});
    const BakePath path =
        bake_path(LightPath(LightPathKind::direction, Interpolation::spherical, keys), 200, 0.0);
    // The great circles between 40 keys bow out of the small one by 1e-3.
    EXPECT_GT(std::abs(glm::dot(path.pole_ws, axis)), 0.999);
}

TEST(BakePathOfLight, RefusesWhatIsNoBake) {
    const LightPath lamp(LightPathKind::position, Interpolation::linear,
                         {{0.0, {1.0, 0.0, 0.0}}, {1.0, {2.0, 0.0, 0.0}}});
    EXPECT_THROW(bake_path(lamp, 10, 0.0), Error);
    const LightPath still(LightPathKind::direction, Interpolation::linear,
                          {{0.0, {1.0, 0.0, 0.0}}});
    EXPECT_THROW(bake_path(still, 10, 0.0), Error);
    EXPECT_THROW(bake_path(quarter(), 0, 0.0), Error);
    EXPECT_THROW(bake_path(quarter(), 10, -1.0), Error);
}

}  // namespace
}  // namespace gnomon
