#include <gnomon/bake.h>
#include <gnomon/error.h>
#include <gnomon/sun.h>

#include "bake/circle_path.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
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

TEST(PathEnds, AreThoseOfTheDay) {
    using namespace std::chrono;
    const auto ends = [](double latitude_deg, year_month_day date, int steps, double horizon_deg) {
        SunPathOptions options;
        options.steps = steps;
        options.horizon_deg = horizon_deg;
        return path_ends(
            bake_path(sun_path({latitude_deg, 0.0, 0.0}, date, minutes(0), options), "", ""));
    };
    for (const int steps : {24, 255, 1023}) {
        for (const double latitude_deg : {75.0, 90.0}) {
            EXPECT_TRUE(ends(latitude_deg, 2026y / June / 21, steps, 0.0).closed);
        }
        EXPECT_TRUE(ends(89.0, 2026y / April / 5, steps, 0.0).closed) << "declination grows";
        for (const double latitude_deg : {0.0, 48.0, 65.0}) {
            const PathEnds day = ends(latitude_deg, 2026y / June / 21, steps, 0.0);
            EXPECT_FALSE(day.closed || day.begins_up || day.ends_up) << latitude_deg;
            EXPECT_EQ(day.path_steps, steps);
        }
        const PathEnds high = ends(48.0, 2026y / June / 21, steps, 10.0);
        EXPECT_TRUE(high.begins_up && high.ends_up && !high.closed);
    }
    EXPECT_EQ(path_ends({}).path_steps, 0.0);
}

// What lies beyond an end at which the light is up is lit as it is there, and at sunrise dark.
TEST(PathEnds, DecideWhatWindowsSeeBeyond) {
    IntervalPage page{.side_texels = 1, .rises = {0, 0, 0, 0}, .falls = {40, 0, 0, 0}};
    std::fill(page.rises.begin() + 1, page.rises.end(), IntervalPage::kNoRise);
    const auto seen = [&](double at_step, PathEnds ends) {
        return interval_visibility(page, 0, 0,
                                   {.at_step = at_step, .width_steps = 2.0, .ends = ends});
    };
    EXPECT_DOUBLE_EQ(seen(0.0, {}), 0.5);
    EXPECT_DOUBLE_EQ(seen(0.0, {.path_steps = 40.0, .begins_up = true}), 1.0);
    EXPECT_DOUBLE_EQ(seen(40.0, {.path_steps = 40.0, .begins_up = true}), 0.5);
    EXPECT_DOUBLE_EQ(seen(40.0, {.path_steps = 40.0, .ends_up = true}), 1.0);
    EXPECT_DOUBLE_EQ(seen(0.0, {.path_steps = 40.0, .closed = true}), 1.0);
    EXPECT_DOUBLE_EQ(seen(40.0, {.path_steps = 40.0, .closed = true}), 1.0);
    EXPECT_DOUBLE_EQ(seen(0.0, {.path_steps = 80.0, .closed = true}), 0.5);
}

}  // namespace
}  // namespace gnomon
