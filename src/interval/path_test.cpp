#include "interval/path.h"

#include <gnomon/error.h>

#include "interval/test_days.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace gnomon::interval {
namespace {

TEST(Frame, StandsOnThePoleWithNoonInTheMiddle) {
    for (const double latitude : {-1.2, -0.5, 0.0, 0.84, 1.57}) {
        const Frame frame = frame_around(3.0 * pole_at(latitude));
        EXPECT_NEAR(glm::length(frame.z_ws - pole_at(latitude)), 0.0, 1e-15);
        EXPECT_NEAR(glm::length(glm::cross(frame.x_ws, frame.y_ws) - frame.z_ws), 0.0, 1e-15);
        if (latitude < 1.5) {
            EXPECT_NEAR(frame.x_ws.y, std::cos(latitude), 1e-15);
        }
    }
    EXPECT_THROW(frame_around(DVec3(0.0)), Error);
    EXPECT_THROW(frame_around(DVec3(std::numeric_limits<double>::quiet_NaN())), Error);
}

TEST(DayPath, FitsEvenCirclesExactly) {
    const Frame frame = frame_around(pole_at(0.84));
    for (const double declination : {-0.409, 0.0, 0.409}) {
        const DayPath path(circle(frame, declination, -2.0, 2.0, 255), frame);
        EXPECT_EQ(path.steps(), 255);
        EXPECT_EQ(path.words(), 4);
        EXPECT_NEAR(path.fit().steps_per_rad, 255 / 4.0, 1e-9);
        EXPECT_NEAR(path.fit().step_at_zero, 127.0, 1e-9);
        EXPECT_NEAR(path.fit().slack_steps, 0.0, 1e-9);
        EXPECT_NEAR(path.fit().low_slope, std::tan(declination), 1e-12);
        EXPECT_NEAR(path.fit().high_slope, std::tan(declination), 1e-12);
    }
}

TEST(DayPath, MeasuresItsDeviations) {
    const Frame frame = frame_around(pole_at(0.84));
    std::vector<DVec3> day = circle(frame, 0.1, -2.0, 2.0, 200);
    day[60] = circle(frame, 0.11, -2.0, 2.0, 200)[63];
    const DayPath path(day, frame);
    EXPECT_NEAR(path.fit().slack_steps, 1.5, 0.1);  // three steps off, the middle of it
    EXPECT_NEAR(path.fit().high_slope, std::tan(0.11), 1e-12);
}

TEST(DayPath, TurnsPastTheSeamOfAtan2) {
    const Frame frame = frame_around(pole_at(0.84));
    const double turn = 2.0 * std::numbers::pi;
    for (const double from : {-4.0, -1.0, 2.0}) {
        std::vector<DVec3> day = circle(frame, 0.3, from, from + turn, 360);
        EXPECT_NEAR(DayPath(day, frame).fit().slack_steps, 0.0, 1e-9);
        std::reverse(day.begin(), day.end());
        EXPECT_NEAR(DayPath(day, frame).fit().steps_per_rad, -360 / turn, 1e-9);
    }
}

TEST(DayPath, RefusesWhatIsNoDay) {
    const Frame frame = frame_around(pole_at(0.84));
    EXPECT_THROW(DayPath({}, frame), Error);
    EXPECT_THROW(DayPath(circle(frame, 0, 0, 1, DayPath::kMaxSteps + 1), frame), Error);
    EXPECT_EQ(DayPath(circle(frame, 0, 0, 1, DayPath::kMaxSteps), frame).words(), 16);
    std::vector<DVec3> day = circle(frame, 0, 0, 1, 4);
    day[2] = DVec3(0.0);
    EXPECT_THROW(DayPath(day, frame), Error);
}

}  // namespace
}  // namespace gnomon::interval
