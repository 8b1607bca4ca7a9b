#include "visibility/light_fit_test.h"

#include <gnomon/error.h>

#include <glm/ext/matrix_double4x4.hpp>
#include <glm/ext/vector_double4.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace gnomon {
namespace {

using namespace test;

struct RandomView {
    Box3 bounds;
    Camera camera;
    Extent size;
    DirectionalLight light;
};

/// Scenes of 1 cm to 1 km, one in four of them flat, seen from inside and outside.
RandomView random_view(Random& random, unsigned index) {
    RandomView view;
    const float scale_m = std::pow(10.0f, random.uniform(-2.0f, 3.0f));
    const Vec3 center = scale_m * random.point(Vec3(-3), Vec3(3));
    Vec3 half = scale_m * random.point(Vec3(0.01f), Vec3(1));
    if (index % 4 == 0) half[static_cast<int>(index / 4 % 3)] = 0.0f;
    view.bounds.include(center - half);
    view.bounds.include(center + half);
    const Vec3 eye = center + scale_m * random.point(Vec3(-2), Vec3(2));
    const Vec3 target = center + half * random.point(Vec3(-1), Vec3(1));
    view.camera = look_at(eye, target, radians(random.uniform(5.0f, 150.0f)));
    if (index % 5 == 0) {
        view.camera.ortho_height_m = scale_m * random.uniform(0.05f, 3.0f);
        view.camera.ortho_depth_m = scale_m * random.uniform(0.5f, 10.0f);
    }
    view.size = {static_cast<unsigned>(random.uniform(1, 2000)),
                 static_cast<unsigned>(random.uniform(1, 2000))};
    view.light.to_light_ws =
        index % 7 == 0 ? Vec3(0, index % 2 == 0 ? 1 : -1, 0) : random.direction();
    return view;
}

/// Is the point in the picture, by the camera's own projection?
bool is_seen(const RandomView& view, Vec3 p_ws) {
    const glm::dvec4 p = glm::dmat4(view.camera.clip_from_view(view.size)) *
                         (glm::dmat4(view.camera.view_from_world) * glm::dvec4(DVec3(p_ws), 1.0));
    return p.w > 0.0 && std::abs(p.x) <= p.w && std::abs(p.y) <= p.w && p.z >= 0.0 && p.z <= p.w;
}

/// Points of the box, its corners and faces too.
std::vector<Vec3> points_of(const Box3& box, Random& random) {
    std::vector<Vec3> points;
    for (int i = 0; i < 300; ++i) {
        Vec3 p = random.point(box.min, box.max);
        if (i < 150) {
            const int axis = i % 3;
            p[axis] = i % 2 == 0 ? box.min[axis] : box.max[axis];
        }
        points.push_back(p);
    }
    for (unsigned i = 0; i < 8; ++i) {
        points.emplace_back((i & 1) != 0 ? box.max.x : box.min.x,
                            (i & 2) != 0 ? box.max.y : box.min.y,
                            (i & 4) != 0 ? box.max.z : box.min.z);
    }
    return points;
}

/// Points of the box that are close before the camera, if it is in the box or at it.
void add_points_before(const RandomView& view, Random& random, std::vector<Vec3>& points) {
    const Box3& box = view.bounds;
    const glm::mat4 world_from_view = glm::inverse(view.camera.view_from_world);
    for (int i = 0; i < 60; ++i) {
        const float distance_m = view.camera.near_m * std::pow(10.0f, random.uniform(0.0f, 2.0f));
        const Vec3 p(world_from_view * Vec4(distance_m * random.uniform(-1.0f, 1.0f),
                                            distance_m * random.uniform(-1.0f, 1.0f), -distance_m,
                                            1.0f));
        if (glm::all(glm::greaterThanEqual(p, box.min)) && glm::all(glm::lessThanEqual(p, box.max)))
            points.push_back(p);
    }
}

TEST(VisibleCorners, EncloseWhatIsSeen) {
    Random random(1);
    std::size_t seen = 0;
    for (unsigned i = 0; i < kViews; ++i) {
        const RandomView view = random_view(random, i);
        const std::vector<DVec3> corners = visible_corners(view.camera, view.size, view.bounds);
        std::vector<Vec3> points = points_of(view.bounds, random);
        add_points_before(view, random, points);
        for (const Vec3 p : points) {
            if (!is_seen(view, p)) continue;
            ++seen;
            // A convex body encloses a point when it reaches as far in every direction.
            const DVec3 direction(random.direction());
            double reach = -1e300;
            for (const DVec3& corner : corners)
                reach = std::max(reach, glm::dot(direction, corner));
            EXPECT_GE(reach, glm::dot(direction, DVec3(p))) << "view " << i;
        }
    }
    EXPECT_GT(seen, 10'000u);
}

TEST(VisibleCorners, AreOfTheBoxAndOfTheFrustum) {
    Random random(2);
    for (unsigned i = 0; i < kViews; ++i) {
        const RandomView view = random_view(random, i);
        // Boxes are taken a ten-thousandth of their size larger, so that flat ones have an inside.
        const double grown_m = 1.1e-4 * std::max(view.bounds.diagonal(), 1e-3f);
        for (const DVec3& corner : visible_corners(view.camera, view.size, view.bounds)) {
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_GE(corner[axis], view.bounds.min[axis] - grown_m);
                EXPECT_LE(corner[axis], view.bounds.max[axis] + grown_m);
            }
            const glm::dvec4 p =
                glm::dmat4(view.camera.clip_from_view(view.size)) *
                (glm::dmat4(view.camera.view_from_world) * glm::dvec4(corner, 1.0));
            const double rounding = 1e-6 * std::abs(p.w);  // of the camera's scale, a float
            EXPECT_LE(std::abs(p.x), p.w + rounding) << "view " << i;
            EXPECT_LE(std::abs(p.y), p.w + rounding) << "view " << i;
        }
    }
}

TEST(VisibleCorners, AreNoneWhereNothingIsSeen) {
    Box3 box;
    box.include(Vec3(-1));
    box.include(Vec3(1));
    EXPECT_TRUE(visible_corners(look_at({0, 0, 5}, {0, 0, 9}), {64, 64}, box).empty());
    EXPECT_TRUE(
        visible_corners(look_at({0, 0, 5}, {9, 0, 5}, radians(20.0f)), {64, 64}, box).empty());
    EXPECT_TRUE(visible_corners(look_at({0, 0, 5}, {0, 0, 0}), {64, 64}, Box3()).empty());
    EXPECT_FALSE(visible_corners(look_at({0, 0, 5}, {0, 0, 0}), {64, 64}, box).empty());
}

LightFit fit_view(const RandomView& view) {
    return fit_directional(view.light, visible_corners(view.camera, view.size, view.bounds),
                           view.bounds, kMapSize, kMarginTexels);
}

TEST(FitDirectional, HoldsWhatIsSeenWithinItsMargin) {
    Random random(3);
    for (unsigned i = 0; i < kViews; ++i) {
        const RandomView view = random_view(random, i);
        const LightFit fit = fit_view(view);
        ASSERT_TRUE(is_finite(fit)) << "view " << i;
        std::vector<Vec3> points = points_of(view.bounds, random);
        add_points_before(view, random, points);
        for (const Vec3 p : points) {
            if (!is_seen(view, p)) continue;
            const Projected at = project(fit, DVec3(p));
            EXPECT_LE(std::abs(at.ndc.x), kInnerNdc + at.rounding.x) << "view " << i;
            EXPECT_LE(std::abs(at.ndc.y), kInnerNdc + at.rounding.y) << "view " << i;
        }
    }
}

// A filter of a quarter of a small map left it one texel, and nothing hid anything.
TEST(FitDirectional, LeavesHalfOfAMapToItsReceivers) {
    EXPECT_EQ(used_texels(512, 16.0f), 480.0);
    EXPECT_EQ(used_texels(512, 257.0f), 256.0);
    const std::vector<DVec3> receivers_ws{{-1, 0, 0}, {1, 0, 0}, {0, 0, -1}, {0, 0, 1}};
    const LightFit fit = fit_directional({.to_light_ws = {0, 1, 0}}, receivers_ws,
                                         {{-1, 0, -1}, {1, 1, 1}}, 64, 100.0f);
    EXPECT_NEAR(fit.texel_size_m({0, 0, 0}), std::sqrt(2.0f) / 32.0f, 1e-3f);
}

TEST(FitDirectional, IsNoLargerThanItMustBe) {
    Random random(4);
    for (unsigned i = 0; i < kViews; ++i) {
        const RandomView view = random_view(random, i);
        const LightFit fit = fit_view(view);
        double reach = 0.0, rounding = 0.0;
        const std::vector<DVec3> corners = visible_corners(view.camera, view.size, view.bounds);
        for (const DVec3& corner : corners) {
            const Projected at = project(fit, corner);
            reach = std::max({reach, std::abs(at.ndc.x), std::abs(at.ndc.y)});
            rounding = std::max({rounding, at.rounding.x, at.rounding.y});
        }
        if (!corners.empty()) {
            EXPECT_NEAR(reach, kInnerNdc, 2.0 * rounding) << "view " << i;
        }
    }
}

TEST(FitDirectional, HasEveryCasterBetweenItsPlanesNearestFirst) {
    Random random(5);
    for (unsigned i = 0; i < kViews; ++i) {
        const RandomView view = random_view(random, i);
        const LightFit fit = fit_view(view);
        for (const Vec3 p : points_of(view.bounds, random)) {
            const Projected at = project(fit, DVec3(p));
            EXPECT_GE(at.ndc.z, -at.rounding.z) << "view " << i;
            EXPECT_LE(at.ndc.z, 1.0 + at.rounding.z) << "view " << i;
            const double step_m = 0.1 * view.bounds.diagonal();
            const Projected nearer =
                project(fit, DVec3(p) + step_m * DVec3(view.light.to_light_ws));
            EXPECT_GT(nearer.ndc.z, at.ndc.z) << "view " << i;
            // Towards the light is straight down the map.
            EXPECT_NEAR(nearer.ndc.x, at.ndc.x, nearer.rounding.x + at.rounding.x);
            EXPECT_NEAR(nearer.ndc.y, at.ndc.y, nearer.rounding.y + at.rounding.y);
        }
    }
}

TEST(FitDirectional, KnowsTheSizeOfItsTexels) {
    Random random(6);
    for (unsigned i = 0; i < kViews; ++i) {
        const RandomView view = random_view(random, i);
        const LightFit fit = fit_view(view);
        const Vec3 p = random.point(view.bounds.min, view.bounds.max);
        const float texel_m = fit.texel_size_m(p);
        const TexelSteps steps = fit.texel_steps();
        EXPECT_NEAR(texel_m / std::max(glm::length(steps.u_ws), glm::length(steps.v_ws)), 1.0,
                    1e-5);
        // A hundred texels; the matrix and the direction are in float.
        EXPECT_NEAR(texels_moved(fit, DVec3(p), 100.0 * DVec3(steps.u_ws)), 100.0, 1e-2);
        EXPECT_NEAR(texels_moved(fit, DVec3(p), 100.0 * DVec3(steps.v_ws)), 100.0, 1e-2);
        EXPECT_NEAR(glm::dot(steps.u_ws, steps.v_ws) / (texel_m * texel_m), 0.0, 1e-5);
        const Vec3 across = normalize(glm::cross(view.light.to_light_ws, random.direction()));
        EXPECT_GT(texels_moved(fit, DVec3(p), 100.0 * texel_m * DVec3(across)), 100.0 - 1e-2);
    }
}

TEST(FitDirectionalStable, LeavesItsTexelsWhereTheyAreInTheWorld) {
    Random random(12);
    Box3 bounds;
    bounds.include(Vec3(-50, 0, -50));
    bounds.include(Vec3(50, 12, 50));
    const DirectionalLight light{.to_light_ws = normalize({0.3f, 1.0f, 0.5f})};
    const DepthRange range{2.0, 20.0};
    const DVec3 mark(1.0, 2.0, -3.0);
    const auto texel_of_mark = [&](const Camera& camera) {
        const LightFit fit = fit_directional_stable(light, camera, {160, 90}, range, bounds,
                                                    kMapSize, kMarginTexels);
        const DVec3 ndc = project(fit, mark).ndc;
        return 0.5 * kMapSize * glm::dvec2(ndc);
    };
    const glm::dvec2 first = texel_of_mark(look_at({0, 3, 9}, {0, 1, 0}));
    for (int i = 0; i < 40; ++i) {
        const Vec3 eye = Vec3(0, 3, 9) + random.point(Vec3(-1), Vec3(1));
        const glm::dvec2 moved =
            texel_of_mark(look_at(eye, random.point(Vec3(-2), Vec3(2)))) - first;
        // By whole texels, but for the matrix's rounding to float.
        EXPECT_NEAR(moved.x, std::round(moved.x), 2e-3);
        EXPECT_NEAR(moved.y, std::round(moved.y), 2e-3);
    }
}

TEST(FitDirectionalStable, HoldsTheFrustum) {
    Random random(13);
    Box3 bounds;
    bounds.include(Vec3(-50, 0, -50));
    bounds.include(Vec3(50, 12, 50));
    for (int i = 0; i < 40; ++i) {
        const Camera camera =
            look_at(random.point(Vec3(-9), Vec3(9)), random.point(Vec3(-9), Vec3(9)),
                    radians(random.uniform(20.0f, 100.0f)));
        const DirectionalLight light{.to_light_ws = random.direction()};
        const DepthRange range{1.0, random.uniform(2.0f, 30.0f)};
        const LightFit fit = fit_directional_stable(light, camera, {160, 90}, range, bounds,
                                                    kMapSize, kMarginTexels);
        for (const DVec3& p : visible_corners(camera, {160, 90}, bounds, range)) {
            const Projected at = project(fit, p);
            EXPECT_LE(std::abs(at.ndc.x), kInnerNdc + at.rounding.x);
            EXPECT_LE(std::abs(at.ndc.y), kInnerNdc + at.rounding.y);
        }
    }
}

TEST(FitDirectional, CopesWithBoundsOfNoSizeAndWithNothingSeen) {
    Box3 point;
    point.include({1, 2, 3});
    Box3 line = point;
    line.include({1, 2, 8});
    Box3 square = line;
    square.include({5, 2, 3});
    const DirectionalLight light{.to_light_ws = {0, 1, 0}};
    for (const Box3& box : {Box3(), point, line, square}) {
        for (const Vec3 target : {Vec3(1, 2, 3), Vec3(1, 30, 9)}) {
            const Camera camera = look_at({3, 4, 9}, target, radians(30.0f));
            const LightFit fit = fit_directional(light, visible_corners(camera, {16, 9}, box), box,
                                                 kMapSize, kMarginTexels);
            ASSERT_TRUE(is_finite(fit));
            if (box.empty()) continue;
            for (const Vec3 p : {box.min, box.max}) {
                const Projected at = project(fit, DVec3(p));
                EXPECT_GE(at.ndc.z, -at.rounding.z);
                EXPECT_LE(at.ndc.z, 1.0 + at.rounding.z);
            }
        }
    }
}

TEST(FitDirectional, CopesWithMapsOfHardlyMoreThanTheirMargin) {
    Box3 box;
    box.include(Vec3(-1));
    box.include(Vec3(1));
    const Camera camera = look_at({3, 4, 9}, {0, 0, 0});
    for (const unsigned map_size : {1u, 6u, 7u}) {
        EXPECT_TRUE(
            is_finite(fit_directional({.to_light_ws = {0, 1, 0}},
                                      visible_corners(camera, {16, 9}, box), box, map_size, 3.0f)));
    }
}

}  // namespace
}  // namespace gnomon
