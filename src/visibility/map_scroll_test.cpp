#include "visibility/map_scroll.h"

#include "visibility/light_fit_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace gnomon {
namespace {

using namespace test;

constexpr Extent kSize{160, 90};
constexpr DepthRange kRange{2.0, 20.0};
const DirectionalLight kLight{.to_light_ws = normalize({0.3f, 1.0f, 0.5f})};

Box3 ground() {
    Box3 bounds;
    bounds.include(Vec3(-50, 0, -50));
    bounds.include(Vec3(50, 12, 50));
    return bounds;
}

LightFit stable(const Camera& camera, int step_texels = 1, DepthRange range = kRange) {
    return fit_directional_stable(kLight, camera, kSize, range, ground(), kMapSize, kMarginTexels,
                                  step_texels);
}

glm::dvec2 texel_at(const LightFit& fit, DVec3 p_ws) {
    return (0.5 * glm::dvec2(project(fit, p_ws).ndc) + 0.5) * static_cast<double>(kMapSize);
}

/// How often each texel of a map is in any of the rectangles.
std::vector<int> covered(const MapScroll& scrolled) {
    std::vector<TexelRect> all = scrolled.comes;
    all.push_back(scrolled.stays);
    std::vector<int> count(std::size_t{kMapSize} * kMapSize);
    for (const TexelRect& rect : all) {
        for (unsigned y = 0; y < rect.height; ++y) {
            for (unsigned x = 0; x < rect.width; ++x) {
                const unsigned at_x = static_cast<unsigned>(rect.x) + x;
                const unsigned at_y = static_cast<unsigned>(rect.y) + y;
                ++count.at(std::size_t{at_y} * kMapSize + at_x);
            }
        }
    }
    return count;
}

TEST(MapScroll, TellsWhereTexelsGo) {
    Random random(5);
    const Camera first = look_at({0, 3, 9}, {0, 1, 0});
    const LightFit before = stable(first);
    const DVec3 mark(1.0, 2.0, -3.0);
    int moved = 0;
    for (int i = 0; i < 40; ++i) {
        const Vec3 eye = Vec3(0, 3, 9) + random.point(Vec3(-1), Vec3(1));
        const LightFit after = stable(look_at(eye, random.point(Vec3(-2), Vec3(2))));
        const std::optional<MapScroll> scrolled = scroll(before, after);
        ASSERT_TRUE(scrolled);
        const glm::dvec2 step = texel_at(after, mark) - texel_at(before, mark);
        // Double leaves far less than this of a texel.
        EXPECT_NEAR(step.x, scrolled->x_texels, 1e-6);
        EXPECT_NEAR(step.y, scrolled->y_texels, 1e-6);
        EXPECT_EQ(covered(*scrolled), std::vector<int>(std::size_t{kMapSize} * kMapSize, 1));
        moved += scrolled->comes.size() == 2 ? 1 : 0;
    }
    EXPECT_GT(moved, 30);
}

TEST(MapScroll, OfAMapThatRestsBringsNothing) {
    const LightFit fit = stable(look_at({0, 3, 9}, {0, 1, 0}));
    const std::optional<MapScroll> scrolled = scroll(fit, fit);
    ASSERT_TRUE(scrolled);
    EXPECT_TRUE(scrolled->comes.empty());
    EXPECT_EQ(scrolled->stays, whole_map(kMapSize));

    LightFit perspective = fit;
    perspective.affine = false;
    EXPECT_TRUE(scroll(perspective, perspective));
    LightFit beside = perspective;
    beside.clip_from_world[3].x += 2.0 / kMapSize;
    EXPECT_FALSE(scroll(perspective, beside));
}

TEST(MapScroll, NeedsTheSameTexelsAndDepths) {
    const Camera camera = look_at({0, 3, 9}, {0, 1, 0});
    const LightFit fit = stable(camera);
    EXPECT_FALSE(scroll(fit, stable(camera, 1, {2.0, 24.0})));
    EXPECT_FALSE(scroll(fit, stable(look_at({0, 3, 900}, {0, 1, 891}))));  // nothing in common

    DirectionalLight later = kLight;
    later.to_light_ws = normalize({0.31f, 1.0f, 0.5f});
    EXPECT_FALSE(scroll(fit, fit_directional_stable(later, camera, kSize, kRange, ground(),
                                                    kMapSize, kMarginTexels)));
    Box3 higher = ground();
    higher.include(Vec3(0, 12.1f, 0));  // as what moves may do in each frame
    EXPECT_TRUE(scroll(fit, fit_directional_stable(kLight, camera, kSize, kRange, higher, kMapSize,
                                                   kMarginTexels)));
    higher.include(Vec3(0, 40, 0));
    EXPECT_FALSE(scroll(fit, fit_directional_stable(kLight, camera, kSize, kRange, higher, kMapSize,
                                                    kMarginTexels)));
    LightFit half_way = fit;
    half_way.clip_from_world[3].x += 1.0 / kMapSize;
    EXPECT_FALSE(scroll(fit, half_way));
}

// Else a map that creeps by less than what counts as rounding would never move.
TEST(MapScroll, LetsRoundingNotAddUp) {
    constexpr double kCreep_texels = 4e-4;
    LightFit held = stable(look_at({0, 3, 9}, {0, 1, 0}));
    LightFit wanted = held;
    int frames = 0;
    for (std::optional<MapScroll> scrolled; frames < 10; ++frames) {
        wanted.clip_from_world[3].x += kCreep_texels * 2.0 / kMapSize;
        scrolled = scroll(held, wanted);
        if (!scrolled) break;
        held = scrolled->fit;
    }
    EXPECT_EQ(frames, 2);
}

TEST(MapScroll, IsByWholeSteps) {
    constexpr int kStep_texels = 32;
    const LightFit before = stable(look_at({0, 3, 9}, {0, 1, 0}), kStep_texels);
    Random random(6);
    int rested = 0;
    for (int i = 0; i < 40; ++i) {
        const Vec3 eye = Vec3(0, 3, 9) + random.point(Vec3(-1), Vec3(1));
        const Camera camera = look_at(eye, Vec3(0, 1, 0));
        const LightFit after = stable(camera, kStep_texels);
        const std::optional<MapScroll> scrolled = scroll(before, after);
        ASSERT_TRUE(scrolled);
        EXPECT_EQ(scrolled->x_texels % kStep_texels, 0);
        EXPECT_EQ(scrolled->y_texels % kStep_texels, 0);
        rested += scrolled->comes.empty() ? 1 : 0;
        for (const DVec3& p : visible_corners(camera, kSize, ground(), kRange)) {
            const Projected at = project(after, p);
            EXPECT_LE(std::abs(at.ndc.x), kInnerNdc + at.rounding.x);
            EXPECT_LE(std::abs(at.ndc.y), kInnerNdc + at.rounding.y);
        }
    }
    EXPECT_GT(rested, 0);
}

}  // namespace
}  // namespace gnomon
