#include "visibility/moving_casters.h"

#include "visibility/light_fit_test.h"
#include "visibility/light_view.h"

#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace gnomon {
namespace {

using namespace test;

const DirectionalLight kLight{.to_light_ws = normalize({0.3f, 1.0f, 0.5f})};

Box3 yard() {
    Box3 bounds;
    bounds.include(Vec3(-20, 0, -20));
    bounds.include(Vec3(20, 8, 20));
    return bounds;
}

LightFit stable_fit() {
    return fit_directional_stable(kLight, look_at({0, 3, 9}, {0, 1, 0}), {160, 90}, {2.0, 20.0},
                                  yard(), kMapSize, kMarginTexels);
}

bool holds(const TexelRect& rect, glm::dvec2 texel) {
    return texel.x >= rect.x && texel.y >= rect.y &&
           texel.x <= rect.x + static_cast<double>(rect.width) &&
           texel.y <= rect.y + static_cast<double>(rect.height);
}

bool in_map(glm::dvec2 texel) {
    return holds(whole_map(kMapSize), texel);
}

TEST(CoveredTexels, HoldWhatABoxCovers) {
    Random random(11);
    const LightFit spot = fit_view(
        spot_view({.position_ws = {1, 9, 2}, .direction_ws = normalize({-0.1f, -1.0f, -0.2f})}),
        yard(), kMapSize, kMarginTexels);
    for (const LightFit& fit : {stable_fit(), spot}) {
        int inside = 0;
        for (int i = 0; i < 200; ++i) {
            const Box3 box{Vec3(-0.4f, -0.1f, -0.2f), Vec3(0.3f, 0.6f, 0.1f)};
            const Mat4 placed = glm::rotate(
                glm::translate(Mat4(1.0f), random.point(Vec3(-9, 0, -9), Vec3(9, 7, 9))),
                0.1f * static_cast<float>(i), Vec3(0.6f, 0.8f, 0.0f));
            const TexelRect rect = covered_texels(fit, placed, box);
            EXPECT_LE(rect.area(), whole_map(kMapSize).area());
            for (int j = 0; j < 20; ++j) {
                const DVec3 p_ws(placed * Vec4(random.point(box.min, box.max), 1.0f));
                const glm::dvec2 texel =
                    (0.5 * glm::dvec2(project(fit, p_ws).ndc) + 0.5) * double{kMapSize};
                if (!in_map(texel)) continue;
                EXPECT_TRUE(holds(rect, texel)) << i;
                ++inside;
            }
        }
        EXPECT_GT(inside, 500);
    }
}

TEST(CoveredTexels, AreNoneBesideTheMapAndAllBehindItsEye) {
    const Box3 box{Vec3(-0.5f), Vec3(0.5f)};
    EXPECT_EQ(covered_texels(stable_fit(), glm::translate(Mat4(1.0f), Vec3(500, 0, 0)), box).area(),
              0u);
    EXPECT_EQ(covered_texels(stable_fit(), Mat4(1.0f), Box3{}).area(), 0u);
    const LightFit face = fit_view(cube_views({0, 0, 0})[0], yard(), kMapSize, kMarginTexels);
    EXPECT_EQ(covered_texels(face, Mat4(1.0f), box), whole_map(kMapSize));
}

TEST(Apart, HoldsAllAndDoesNotOverlap) {
    constexpr unsigned kSide = 256;
    Random random(3);
    for (int round = 0; round < 30; ++round) {
        std::vector<TexelRect> rects(static_cast<std::size_t>(12 * round));
        for (TexelRect& rect : rects) {
            const Vec3 p = random.point(Vec3(0), Vec3(240));
            rect = {static_cast<int>(p.x), static_cast<int>(p.y), static_cast<unsigned>(p.z) / 20,
                    static_cast<unsigned>(p.z) % 13};
        }
        std::vector<int> covered(std::size_t{kSide} * kSide);
        const auto count = [&](const std::vector<TexelRect>& in) {
            std::ranges::fill(covered, 0);
            for (const TexelRect& rect : in) {
                for (unsigned i = 0; i < rect.area(); ++i) {
                    const std::size_t x = static_cast<unsigned>(rect.x) + i % rect.width;
                    const std::size_t y = static_cast<unsigned>(rect.y) + i / rect.width;
                    ++covered.at(y * kSide + x);
                }
            }
            return covered;
        };
        const std::vector<int> wanted = count(rects);
        const std::vector<int> found = count(apart(rects));
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            ASSERT_LE(found[i], 1);
            ASSERT_TRUE(wanted[i] == 0 || found[i] == 1);
        }
    }
}

TEST(Apart, JoinsNeighboursOnlyWhereTheyOverlap) {
    const std::array beside{TexelRect{0, 0, 4, 4}, TexelRect{4, 0, 4, 4}, TexelRect{9, 9, 0, 3}};
    EXPECT_EQ(apart(beside).size(), 2u);
    const std::array chain{TexelRect{0, 0, 4, 4}, TexelRect{6, 0, 4, 4}, TexelRect{3, 2, 4, 4}};
    EXPECT_EQ(apart(chain), (std::vector{TexelRect{0, 0, 10, 6}}));
}

class MovingCastersTest : public testing::Test {
protected:
    /// Triangles side by side.
    static Scene row() {
        SceneData data;
        data.materials.emplace_back();
        data.meshes.push_back({.name = "triangle",
                               .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                               .triangles = {{0, 1, 2}}});
        for (const float x : {-6.0f, -2.0f, 2.0f, 6.0f})
            data.instances.push_back({.world_from_local = at(x)});
        return Scene(data);
    }
    static Mat4 at(float x) { return glm::translate(Mat4(1.0f), Vec3(x, 0, 0)); }
    static Scene moved(const Scene& scene, std::uint32_t instance, float x) {
        const std::array pose{InstancePose{instance, at(x)}};
        return scene.moved(pose);
    }
    /// The scene made anew, with an instance whose triangle reaches so high.
    static Scene bend(const Scene& scene, std::uint32_t instance, float height_m) {
        SceneData data = scene.data();
        data.instances[instance].mesh = static_cast<std::uint32_t>(data.meshes.size());
        data.meshes.push_back(data.meshes[0]);
        data.meshes.back().positions[2].y = height_m;
        return Scene(data);
    }
};

TEST_F(MovingCastersTest, AreAllThatEverMoved) {
    const Scene scene = row();
    MovingCasters moving;
    EXPECT_FALSE(moving.follow(scene));
    EXPECT_TRUE(moving.follow(scene));
    EXPECT_TRUE(moving.empty());
    EXPECT_FALSE(moving.follow(moved(scene, 2, 2.5f)));
    EXPECT_TRUE(moving.follow(moved(scene, 2, 3.0f)));
    EXPECT_TRUE(moving.follow(scene));
    EXPECT_FALSE(moving.follow(moved(scene, 0, -7.0f)));
    EXPECT_TRUE(moving.follow(scene));
    EXPECT_EQ(std::vector(moving.still().begin(), moving.still().end()),
              (std::vector<std::uint8_t>{0, 1, 0, 1}));
    ASSERT_EQ(moving.places().size(), 2u);
    EXPECT_EQ(moving.places()[0].world_from_local, at(-6));
    EXPECT_EQ(moving.places()[1].world_from_local, at(2));
    moving.clear();
    EXPECT_TRUE(moving.empty());
    EXPECT_TRUE(moving.still().empty());
}

TEST_F(MovingCastersTest, AreThoseThatDifferInAnotherPose) {
    const Scene scene = row();
    MovingCasters moving;
    moving.follow(scene);
    EXPECT_TRUE(moving.follow(Scene(scene.data())));  // made again
    const Scene bent = bend(scene, 1, 0.5f);
    EXPECT_FALSE(moving.follow(bent));
    EXPECT_EQ(std::vector(moving.still().begin(), moving.still().end()),
              (std::vector<std::uint8_t>{1, 0, 1, 1}));
    const std::vector<CasterPlace> before = moving.places();
    EXPECT_TRUE(moving.follow(bent));
    EXPECT_TRUE(moving.changed(stable_fit(), before).empty());
    // It rests where it is and changes.
    EXPECT_TRUE(moving.follow(bend(scene, 1, 3.0f)));
    const std::vector<TexelRect> texels = moving.changed(stable_fit(), before);
    ASSERT_EQ(texels.size(), 1u);
    Box3 highest = scene.mesh_bounds(0);
    highest.include(Vec3(0, 3, 0));
    EXPECT_EQ(texels[0], covered_texels(stable_fit(), at(-2), highest));
}

TEST_F(MovingCastersTest, OfAnotherSceneAreItsOwn) {
    const Scene scene = row();
    MovingCasters moving;
    moving.follow(moved(scene, 2, 2.5f));
    SceneData fewer = scene.data();
    fewer.instances.pop_back();
    EXPECT_FALSE(moving.follow(moved(Scene(fewer), 1, 0.0f)));
    EXPECT_EQ(std::vector(moving.still().begin(), moving.still().end()),
              (std::vector<std::uint8_t>{1, 0, 1}));
}

TEST_F(MovingCastersTest, ChangeTheTexelsWhereTheyGoAndComeFrom) {
    const LightFit fit = stable_fit();
    const Scene before = moved(moved(row(), 0, -5.9f), 3, 5.9f);
    const Scene after = moved(before, 3, 3.0f);
    MovingCasters moving;
    moving.follow(before);
    const std::vector<CasterPlace> places = moving.places();
    EXPECT_TRUE(moving.changed(fit, places).empty());
    EXPECT_TRUE(moving.follow(after));
    const std::vector<TexelRect> texels = moving.changed(fit, places);
    ASSERT_EQ(texels.size(), 2u);
    const Box3& box = after.mesh_bounds(0);
    EXPECT_EQ(texels[0], covered_texels(fit, at(5.9f), box));
    EXPECT_EQ(texels[1], covered_texels(fit, at(3.0f), box));
    // Instance 2 is near 3 but stays.
    EXPECT_EQ(moving.reaching(fit, texels), (std::vector<std::uint8_t>{0, 0, 0, 1}));
    EXPECT_EQ(moving.reaching(fit, std::vector{whole_map(kMapSize)}),
              (std::vector<std::uint8_t>{1, 0, 0, 1}));
}

}  // namespace
}  // namespace gnomon
