#include <gnomon/error.h>
#include <gnomon/sun_hours.h>

#include "trace/test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace gnomon {
namespace {

SunHoursOptions at_equinox() {
    using namespace std::chrono;
    constexpr auto kDate = 2026y / March / 20;
    return {.place = {48.137, 11.575, 520.0},
            .from = kDate,
            .to = kDate,
            .utc_offset = std::chrono::hours(1),
            .step_minutes = 30.0};
}

// A facade 1 cm before the south side of the cube [-1, 1]³ and around it, a roof that leans over it
// to the south, and a plane through its middle.
TEST(SunGrids, OnPlanesFaceAsTheyLieAndLeaveOutInsides) {
    const Scene scene =
        trace::make_scene({{trace::cube()}, {trace::quad({-3, -1, 3}, {6, 0, 0}, {0, 0, -6})}});
    const SunHoursOptions options = at_equinox();
    const std::vector<SunGrid> grids{
        make_sun_grid(SunPlane{{-1.0, -1.0, 1.01}, {2, 0, 0}, {0, 2, 0}}, 0.5),
        make_sun_grid(SunPlane{{-1.0, 2.0, 1.0}, {2, 0, 0}, {0, 1, -1}}, 0.5),
        make_sun_grid(SunPlane{{-2.0, -1.0, 0.1}, {4, 0, 0}, {0, 2, 0}}, 0.5)};
    EXPECT_EQ(grids[0].size, (Extent{4, 4}));
    EXPECT_EQ(grids[1].size, (Extent{4, 3}));  // 1.41 m, 4 cm beyond either edge
    EXPECT_NEAR(glm::distance(grids[1].normal_ws, glm::normalize(DVec3(0, 1, 1))), 0.0, 1e-12);
    EXPECT_NEAR(glm::distance(grids[0].first_ws, DVec3(-0.75, -0.75, 1.01)), 0.0, 1e-12);
    Progress silent;
    const SunHoursResult result = sun_hours(scene, grids, options, silent);
    ASSERT_EQ(result.points.size(), 16u + 12u + 32u);
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        const SunSensor& point = result.points[i];
        // As sensors there have it, and as horizontal grids have it.
        const SunHours alone =
            sun_hours(scene, std::span(&point, 1), options, silent).hours.front();
        EXPECT_EQ(result.hours[i].mean_h, alone.mean_h);
        const DVec3 p = point.position_ws;
        const bool inside = std::abs(p.x) < 1.0 && std::abs(p.z) < 1.0 && p.y < 1.0;
        EXPECT_EQ(result.weights[i], inside ? 0.0 : 1.0) << p.x << ", " << p.y << ", " << p.z;
    }
    const std::vector<SunHoursSummary> summaries = summarize(result);
    EXPECT_EQ(summaries.front().points, 16u + 12u + 16u);
    EXPECT_EQ(summaries.back().facing, "south");
    EXPECT_GT(summaries.back().mean_h, 6.0);
    for (const SunPlane& bad : {SunPlane{{}, {1, 0, 0}, {1, 1, 0}}, SunPlane{{}, {1, 0, 0}, {}}})
        EXPECT_THROW(make_sun_grid(bad, 0.5), Error);
}

// In the picture of a facade each square has the colour of its hours, as on a horizontal grid.
TEST(SunGrids, OnPlanesAreSeenInPictures) {
    const Scene scene = trace::make_scene({{trace::cube()}});
    Progress silent;
    const SunHoursResult result =
        sun_hours(scene, make_sun_grid(SunPlane{{-1, -1, 1.01}, {2, 0, 0}, {0, 2, 0}}, 1.0),
                  at_equinox(), silent);
    constexpr Extent kPicture{64, 64};
    const auto middle = [&](const Camera& camera) {
        const Image image = sun_hours_picture(scene, result, camera, kPicture, silent);
        return Vec3(image.at(20, 32, 0), image.at(20, 32, 1), image.at(20, 32, 2));
    };
    const auto is_grey = [](Vec3 c) { return c.r == c.g && c.g == c.b; };
    EXPECT_FALSE(is_grey(middle(look_at(Vec3(0, 0, 6), Vec3(0)))));
    EXPECT_TRUE(is_grey(middle(look_at(Vec3(0, 0, -6), Vec3(0)))));  // the cube hides it
}

}  // namespace
}  // namespace gnomon
