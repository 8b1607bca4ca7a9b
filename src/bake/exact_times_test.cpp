#include "bake/exact_times.h"

#include <gnomon/error.h>
#include <gnomon/sun.h>

#include "bake/fine_path.h"
#include "bake/light_day.h"
#include "bake/thread_limit.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

namespace gnomon::bake {
namespace {

using namespace std::chrono;
using trace::Receiver;

constexpr Place kMunich{48.137, 11.575, 520.0};
constexpr minutes kOffset(60);
constexpr int kMostSteps = 1023;

SunPath sun_of(year_month_day date, int steps) {
    SunPathOptions options;
    options.steps = steps;
    return sun_path(kMunich, date, kOffset, options);
}

/// The sun at a time after midnight, to the millisecond, from the almanac itself.
DVec3 to_sun_at(year_month_day date, double time_s) {
    const milliseconds since_midnight(std::llround(1000.0 * time_s));
    const SunPosition sun = sun_position(kMunich, civil_time(date, since_midnight, kOffset));
    return sky_direction_ws(sun.azimuth_deg, sun.elevation_deg);
}

struct Box {
    DVec3 low, high;

    /// Whether a ray meets it.
    bool blocks(DVec3 origin, DVec3 direction) const {
        double first = 0.0, last = INFINITY;
        for (int axis = 0; axis < 3; ++axis) {
            const double a = (low[axis] - origin[axis]) / direction[axis];
            const double b = (high[axis] - origin[axis]) / direction[axis];
            first = std::max(first, std::min(a, b));
            last = std::min(last, std::max(a, b));
        }
        return first < last;
    }
};

// A pole and a wall, which cast on the floor around them.
constexpr std::array<Box, 2> kBoxes = {Box{{-0.0625, 0.0, -0.0625}, {0.0625, 4.0, 0.0625}},
                                       Box{{2.0, 0.0, -1.5}, {2.25, 1.5, 1.5}}};

Scene boxes() {
    Mesh mesh;
    for (const Box& box : kBoxes) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (unsigned i = 0; i < 8; ++i) {
            mesh.positions.emplace_back((i & 1) != 0 ? box.high.x : box.low.x,
                                        (i & 2) != 0 ? box.high.y : box.low.y,
                                        (i & 4) != 0 ? box.high.z : box.low.z);
        }
        for (const UVec3 t : {UVec3(0, 1, 3), UVec3(0, 3, 2), UVec3(4, 7, 5), UVec3(4, 6, 7),
                              UVec3(0, 4, 5), UVec3(0, 5, 1), UVec3(2, 3, 7), UVec3(2, 7, 6),
                              UVec3(0, 2, 6), UVec3(0, 6, 4), UVec3(1, 5, 7), UVec3(1, 7, 3)})
            mesh.triangles.push_back(t + first);
    }
    SceneData data;
    data.materials.emplace_back();
    data.meshes.push_back(mesh);
    data.instances.emplace_back();
    return Scene(std::move(data));
}

/// Points of the floor around both.
std::vector<Receiver> floor_points() {
    std::vector<Receiver> points;
    for (int i = 0; i < 12; ++i) {
        for (int j = 0; j < 9; ++j) {
            const Vec3 place(-1.7f + 0.41f * static_cast<float>(i), 0.0f,
                             -1.9f + 0.43f * static_cast<float>(j));
            points.push_back({place, {0.0f, 1.0f, 0.0f}, {trace::kNoSurface, 0}});
        }
    }
    return points;
}

/// When a point of the floor sees the sun, by bisection of the almanac, seconds since midnight.
class Truth {
public:
    Truth(year_month_day date, double begin_s, double end_s) : date_(date) {
        constexpr double kScan_s = 20.0;  // the boxes are seen for a minute or more
        const auto count = static_cast<int>((end_s - begin_s) / kScan_s);
        for (int i = 0; i <= count; ++i) {
            times_s_.push_back(begin_s + (end_s - begin_s) * i / count);
            to_sun_.push_back(to_sun_at(date, times_s_.back()));
        }
    }

    std::vector<double> changes_s(DVec3 point) const {
        std::vector<double> changes;
        for (std::size_t i = 1; i < times_s_.size(); ++i) {
            const bool before = is_lit(point, to_sun_[i - 1]);
            if (before == is_lit(point, to_sun_[i])) continue;
            double low = times_s_[i - 1], high = times_s_[i];
            while (high - low > 0.002) {
                const double middle = 0.5 * (low + high);
                (is_lit(point, to_sun_at(date_, middle)) == before ? low : high) = middle;
            }
            changes.push_back(0.5 * (low + high));
        }
        return changes;
    }

private:
    static bool is_lit(DVec3 point, DVec3 to_sun) {
        return std::ranges::none_of(kBoxes,
                                    [&](const Box& box) { return box.blocks(point, to_sun); });
    }

    year_month_day date_;
    std::vector<double> times_s_;
    std::vector<DVec3> to_sun_;
};

class ExactTimesOfBoxes : public testing::TestWithParam<year_month_day> {};

// A change is found to half of what is stored, 0.44 s at most with the most steps: within a second.
TEST_P(ExactTimesOfBoxes, AreThoseOfTheAlmanac) {
    const BakePath path = bake_path(sun_of(GetParam(), kMostSteps), "", "");
    const std::vector<Receiver> points = floor_points();
    Progress silent;
    const std::vector<LitTimes> times =
        LightDay(boxes(), path, {.bits = BakeBits::sixteen, .resume_file = {}}, silent)
            .kept_times(points, silent);
    const double codes = kMostSteps * ExactTimes::kParts;
    const double code_s = (path.end_s - path.begin_s) / codes;
    // Float coordinates of some metres, and the almanac's milliseconds.
    constexpr double kRounding_s = 0.03;
    ASSERT_LT(0.5 * code_s + kRounding_s, 1.0);
    const Truth truth(GetParam(), path.begin_s, path.end_s);
    std::size_t compared = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        std::vector<double> found_s;
        for (const CodedInterval& lit : times[i]) {
            if (lit.rise > 0) found_s.push_back(path.begin_s + lit.rise * code_s);
            if (lit.fall < codes) found_s.push_back(path.begin_s + lit.fall * code_s);
        }
        const std::vector<double> changes_s = truth.changes_s(DVec3(points[i].position_ws));
        ASSERT_EQ(found_s.size(), changes_s.size()) << "point " << i;
        for (std::size_t k = 0; k < changes_s.size(); ++k)
            EXPECT_NEAR(found_s[k], changes_s[k], 0.5 * code_s + kRounding_s) << "point " << i;
        compared += changes_s.size();
    }
    EXPECT_GT(compared, points.size());
}

INSTANTIATE_TEST_SUITE_P(Days, ExactTimesOfBoxes,
                         testing::Values(2026y / June / 21, 2026y / December / 21));

/// A sheet north of the origin, upright, from one x to the other.
Scene northern_sheet(float from_m, float to_m) {
    Mesh mesh;
    mesh.positions = {{from_m, -1, -1}, {to_m, -1, -1}, {to_m, 40, -1}, {from_m, 40, -1}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    SceneData data;
    data.materials.emplace_back();
    data.meshes.push_back(mesh);
    data.instances.emplace_back();
    return Scene(std::move(data));
}

// A sun that circles at one height, from north to north, and a sheet that ends nearly in the north:
// just before the path's end or after its begin, within the half steps there.
TEST(ExactTimes, AreFoundOverTheEndsOfAClosedPath) {
    constexpr int kSteps = 100;
    constexpr double kCodes = kSteps * ExactTimes::kParts;
    constexpr double kTurn = 2.0 * std::numbers::pi;
    BakePath path{.end_s = 86400.0};
    for (int k = 0; k < kSteps; ++k) {
        const double azimuth = kTurn * (k + 0.5) / kSteps;
        path.to_light_ws.push_back(
            glm::normalize(DVec3(std::sin(azimuth), 0.4, -std::cos(azimuth))));
    }
    ASSERT_TRUE(path_ends(path).closed);
    const std::vector<Receiver> point{{{0, 0, 0}, {0, 1, 0}, {trace::kNoSurface, 0}}};
    Progress silent;
    for (const bool to_the_east : {false, true}) {
        for (const float edge_m : {-0.03f, -0.02f, -0.004f, 0.004f, 0.02f, 0.03f}) {
            SCOPED_TRACE(testing::Message() << to_the_east << ' ' << edge_m);
            const Scene scene =
                to_the_east ? northern_sheet(edge_m, 5.0f) : northern_sheet(-5.0f, edge_m);
            const LitTimes lit =
                LightDay(scene, path, {.bits = BakeBits::sixteen, .resume_file = {}}, silent)
                    .times(point, silent)
                    .front();
            std::vector<double> changes;
            for (const CodedInterval& interval : lit) {
                if (interval.rise > 0) changes.push_back(interval.rise);
                if (interval.fall < kCodes) changes.push_back(interval.fall);
            }
            const auto code_of = [&](double azimuth) {
                return kCodes * (azimuth / kTurn - std::floor(azimuth / kTurn));
            };
            const double far_edge = std::atan(5.0) * (to_the_east ? 1.0 : -1.0);
            std::vector<double> expected{code_of(std::atan(static_cast<double>(edge_m))),
                                         code_of(far_edge)};
            std::ranges::sort(expected);
            ASSERT_EQ(changes.size(), 2u);
            EXPECT_NEAR(changes[0], expected[0], 0.51);
            EXPECT_NEAR(changes[1], expected[1], 0.51);
        }
    }
}

TEST(ExactTimes, AreTheSameOnAnyNumberOfThreads) {
    const BakePath path = bake_path(sun_of(2026y / March / 21, 100), "", "");
    const std::vector<Receiver> points = floor_points();
    const BakeOptions options{.bits = BakeBits::sixteen, .resume_file = {}};
    Progress silent;
    const std::vector<LitTimes> all =
        LightDay(boxes(), path, options, silent).kept_times(points, silent);
    const ThreadLimit one(1);
    EXPECT_EQ(LightDay(boxes(), path, options, silent).kept_times(points, silent), all);
    EXPECT_EQ(LightDay(boxes(), path, options, silent)
                  .kept_times(std::span(points).subspan(7, 20), silent),
              std::vector(all.begin() + 7, all.begin() + 27));
}

TEST(LightDay, KeptTimesAreNotFoundAgain) {
    /// Refuses whatever takes time.
    struct AtOnce : Progress {
        bool cancelled() const override { return true; }
    };
    const BakePath path = bake_path(sun_of(2026y / March / 21, 100), "", "");
    const std::vector<Receiver> points = floor_points();
    const auto file =
        std::filesystem::temp_directory_path() / ("gnomon_kept_times" + std::to_string(::getpid()));
    std::filesystem::remove(file);
    Progress silent;
    const LightDay light(boxes(), path, {.bits = BakeBits::sixteen, .resume_file = file}, silent);
    AtOnce at_once;
    EXPECT_THROW(light.kept_times(points, at_once), Error);
    const std::vector<LitTimes> first = light.kept_times(points, silent);
    EXPECT_EQ(light.kept_times(points, at_once), first);
    std::filesystem::remove(file);
}

// What 8 bits tell is at most half a step from it.
TEST(ExactTimes, StayWithinTheirStep) {
    const BakePath path = bake_path(sun_of(2026y / March / 21, 200), "", "");
    const std::vector<Receiver> points = floor_points();
    Progress silent;
    const auto steps =
        LightDay(boxes(), path, {.resume_file = {}}, silent).kept_times(points, silent);
    const auto exact =
        LightDay(boxes(), path, {.bits = BakeBits::sixteen, .resume_file = {}}, silent)
            .kept_times(points, silent);
    int moved = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_EQ(steps[i].size(), exact[i].size());
        for (std::size_t k = 0; k < steps[i].size(); ++k) {
            const int rise = exact[i][k].rise - ExactTimes::kParts * steps[i][k].rise;
            const int fall = exact[i][k].fall - ExactTimes::kParts * steps[i][k].fall;
            EXPECT_LE(std::max(std::abs(rise), std::abs(fall)), ExactTimes::kParts / 2);
            moved += (rise != 0 ? 1 : 0) + (fall != 0 ? 1 : 0);
        }
    }
    EXPECT_GT(moved, 100);
}

// The sun goes 7e-5 rad a second: what is stored is never coarser than this errs.
TEST(FinePath, IsTheAlmanacsBetweenItsSteps) {
    for (const auto& [steps, tolerance_rad] : {std::pair{1023, 1e-7}, {255, 1e-7}, {24, 5e-5}}) {
        const auto date = 2026y / March / 21;
        const BakePath path = bake_path(sun_of(date, steps), "", "");
        const std::vector<DVec3> fine = fine_path(path.to_light_ws, 8);
        ASSERT_EQ(fine.size(), std::size_t{8} * path.to_light_ws.size());
        double greatest_rad = 0.0;
        for (std::size_t i = 0; i < fine.size(); ++i) {
            const double part = (static_cast<double>(i) + 0.5) / static_cast<double>(fine.size());
            const double time_s = path.begin_s + part * (path.end_s - path.begin_s);
            greatest_rad = std::max(greatest_rad, glm::length(fine[i] - to_sun_at(date, time_s)));
        }
        EXPECT_LT(greatest_rad, tolerance_rad) << steps;
    }
}

TEST(FinePath, OfFewStepsIsStraight) {
    const std::vector<DVec3> one{{0.0, 1.0, 0.0}};
    EXPECT_EQ(fine_path(one, 2), (std::vector<DVec3>{one[0], one[0]}));
    const std::vector<DVec3> two{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
    const std::vector<DVec3> fine = fine_path(two, 1);
    EXPECT_EQ(fine, two);
}

}  // namespace
}  // namespace gnomon::bake
