#include "base/smallest_rectangle.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace gnomon {
namespace {

using glm::dvec2;

constexpr double kRounding = 1e-12;

TEST(SmallestRectangle, IsATurnedRectangleItself) {
    for (const double angle : {0.0, 0.3, 1.0, 2.5}) {
        const dvec2 axis(std::cos(angle), std::sin(angle));
        const dvec2 left(-axis.y, axis.x);
        const dvec2 center(7.0, -3.0);
        std::vector<dvec2> corners;
        for (const double x : {-2.0, 2.0}) {
            for (const double y : {-0.5, 0.5})
                corners.push_back(center + x * axis + y * left);
        }
        const Rectangle found = smallest_rectangle(corners);
        EXPECT_NEAR(found.size.x * found.size.y, 4.0, kRounding) << angle;
        EXPECT_NEAR(std::max(found.size.x, found.size.y), 4.0, kRounding) << angle;
        EXPECT_NEAR(glm::distance(found.center, center), 0.0, kRounding) << angle;
    }
}

TEST(SmallestRectangle, HoldsAllPointsAndIsNoLargerThanAnyOther) {
    std::mt19937 engine(3);
    std::normal_distribution<double> normal;
    for (int round = 0; round < 50; ++round) {
        std::vector<dvec2> points;
        for (int i = 0; i < 20; ++i)
            points.emplace_back(5.0 * normal(engine), normal(engine));
        const Rectangle found = smallest_rectangle(points);
        const auto extent = [&](dvec2 axis) {
            double low = 1e30;
            double high = -1e30;
            for (const dvec2 p : points) {
                low = std::min(low, glm::dot(axis, p));
                high = std::max(high, glm::dot(axis, p));
            }
            return high - low;
        };
        const dvec2 left(-found.axis.y, found.axis.x);
        for (const dvec2 p : points) {
            EXPECT_LE(std::abs(glm::dot(p - found.center, found.axis)),
                      0.5 * found.size.x + kRounding * 100);
            EXPECT_LE(std::abs(glm::dot(p - found.center, left)),
                      0.5 * found.size.y + kRounding * 100);
        }
        for (double angle = 0.0; angle < 1.6; angle += 0.01) {
            const dvec2 axis(std::cos(angle), std::sin(angle));
            EXPECT_LE(found.size.x * found.size.y,
                      extent(axis) * extent({-axis.y, axis.x}) * (1.0 + 1e-9));
        }
    }
}

TEST(SmallestRectangle, CopesWithPointsOnALineAndWithNone) {
    EXPECT_EQ(smallest_rectangle({}).size, dvec2(0.0));
    EXPECT_EQ(smallest_rectangle({{2, 3}}).center, dvec2(2, 3));
    const Rectangle line = smallest_rectangle({{0, 0}, {1, 1}, {3, 3}, {2, 2}});
    EXPECT_NEAR(std::max(line.size.x, line.size.y), std::sqrt(18.0), kRounding);
    EXPECT_NEAR(std::min(line.size.x, line.size.y), 0.0, kRounding);
}

}  // namespace
}  // namespace gnomon
