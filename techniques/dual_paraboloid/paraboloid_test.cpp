#include "paraboloid.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon::dual_paraboloid {
namespace {

constexpr double kQuarter_rad = std::numbers::pi / 2.0;

/// A unit vector in every part of the half-space along the axis.
DVec3 direction(int i) {
    const double z = 0.02 + 0.96 * std::fmod(0.754877666 * i, 1.0);
    const double turn = 4.0 * kQuarter_rad * std::fmod(0.569840296 * i, 1.0);
    const double across = std::sqrt(1.0 - z * z);
    return {across * std::cos(turn), across * std::sin(turn), z};
}

/// Between the directions of an edge's ends, by its share of the angle.
DVec3 on_arc(DVec3 a, DVec3 b, double angle_rad, double share) {
    return (std::sin((1.0 - share) * angle_rad) * a + std::sin(share * angle_rad) * b) /
           std::sin(angle_rad);
}

/// How far the arc's middle is off its chord, in the paraboloid's plane.
double bend(DVec3 a, DVec3 b, double angle_rad, double from, double to) {
    const glm::dvec2 p = place_of(on_arc(a, b, angle_rad, from));
    const glm::dvec2 q = place_of(on_arc(a, b, angle_rad, to));
    const glm::dvec2 off = place_of(on_arc(a, b, angle_rad, 0.5 * (from + to))) - p;
    const glm::dvec2 chord = glm::normalize(q - p);
    return std::abs(off.x * chord.y - off.y * chord.x);
}

TEST(Paraboloid, ShowsEachDirectionAtOnePlace) {
    for (int i = 0; i < 1000; ++i) {
        const DVec3 d = direction(i);
        EXPECT_LT(glm::length(place_of(d)), 1.0);
        EXPECT_NEAR(glm::length(direction_at(place_of(d)) - d), 0.0, 1e-14);  // roundings
    }
    EXPECT_NEAR(glm::length(place_of({1, 0, 0}) - glm::dvec2(1, 0)), 0.0, 1e-15);
}

// What texel_size_m() says against two directions half a texel to either side.
TEST(Paraboloid, TexelsAreAsWideAsTheirRaysAreApart) {
    const PointLight light{.position_ws = {1, 2, 3}};
    const ParaboloidView view = paraboloid_view(light, Box3{Vec3(-5.0f), Vec3(5.0f)}, 512, 2.5);
    const double texel = 2.0 * view.reach / view.size_texels;
    for (int i = 0; i < 1000; ++i) {
        constexpr double kDistance_m = 3.0;
        const DVec3 d = direction(i);
        const glm::dvec2 half(0.5 * texel, 0.0);
        const double apart =
            glm::length(direction_at(place_of(d) + half) - direction_at(place_of(d) - half));
        const DVec3 p_ws =
            view.position_ws +
            kDistance_m * (d.x * view.right_ws + d.y * view.up_ws + d.z * view.forward_ws);
        // Floats, and that the step is not infinitely small.
        EXPECT_NEAR(view.texel_size_m(Vec3(p_ws)), kDistance_m * apart, 1e-5 * kDistance_m * apart);
    }
}

// As dual_paraboloid.tesc.glsl divides an edge: of the pieces that come of it none is off by more
// than half a texel, and of one piece less, where an edge bends most, some are.
TEST(Paraboloid, PiecesOfEdgesAreOffByHalfATexelAtMost) {
    constexpr unsigned kSize = 1024;
    constexpr double kReach = 1.0;
    const double half_texel = kReach / kSize;
    double widest = 0.0;
    for (int i = 0; i < 1000; ++i) {
        const DVec3 a = direction(2 * i), b = direction(2 * i + 1);
        const double angle_rad = std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
        const double turn = std::abs(glm::normalize(glm::cross(a, b)).z);
        const double scale = 1.0 / (1.0 + std::min(a.z, b.z));
        const double per_rad = segments_per_rad(kReach, kSize) * scale * std::sqrt(turn);
        const int pieces = std::max(1, static_cast<int>(std::ceil(angle_rad * per_rad)));
        for (int piece = 0; piece < pieces; ++piece) {
            widest = std::max(widest,
                              bend(a, b, angle_rad, 1.0 * piece / pieces, (piece + 1.0) / pieces));
        }
    }
    // A chord of an arc is off by its square over 8 but for its fourth power.
    EXPECT_LE(widest, 1.01 * half_texel);
    EXPECT_GT(widest, 0.8 * half_texel);
}

TEST(Paraboloid, LeavesOutOnlyWhatIsBehindALayer) {
    const ParaboloidView view =
        paraboloid_view(PointLight{}, Box3{Vec3(-5.0f), Vec3(5.0f)}, 256, 2.5);
    const Box3 below{{-1, -3, -1}, {1, -2, 1}}, above{{-1, 2, -1}, {1, 3, 1}};
    const Box3 beside{{2, -1, -1}, {3, 1, 1}};
    EXPECT_TRUE(view.sees(Side::along, below));
    EXPECT_FALSE(view.sees(Side::against, below));
    EXPECT_FALSE(view.sees(Side::along, above));
    EXPECT_TRUE(view.sees(Side::against, above));
    EXPECT_TRUE(view.sees(Side::along, beside));
    EXPECT_TRUE(view.sees(Side::against, beside));
}

}  // namespace
}  // namespace gnomon::dual_paraboloid
