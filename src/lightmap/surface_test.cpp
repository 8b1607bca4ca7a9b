#include "lightmap/surface.h"

#include "lightmap/scenes_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace gnomon::lightmap {
namespace {

std::size_t backs(const Surface& surface) {
    return static_cast<std::size_t>(std::ranges::count(surface.faces(), true, &Face::back));
}

TEST(Surface, OneSidedMaterialsHaveNoBacks) {
    EXPECT_EQ(backs(Surface(scene_of({scene::ground(Vec2(-1), Vec2(1))}), 0, true)), 0u);
}

TEST(Surface, SheetsOfDoubleSidedMaterialsHaveBacksUnlessNotWanted) {
    const Scene scene = scene_of({scene::ground(Vec2(-1), Vec2(1))}, true);
    const Surface both(scene, 0, true);
    EXPECT_EQ(both.faces().size(), 4u);
    EXPECT_EQ(backs(both), 2u);
    EXPECT_EQ(backs(Surface(scene, 0, false)), 0u);
    for (const Face& face : both.faces())
        EXPECT_EQ(face.normal_ws, DVec3(0, face.back ? -1 : 1, 0));
}

TEST(Surface, SidesThatFaceNoLightAreLeftOut) {
    const Scene sheet = scene_of({scene::ground(Vec2(-1), Vec2(1))}, true);
    const DVec3 above(0.6, 0.8, 0.0);
    EXPECT_EQ(backs(Surface(sheet, 0, true, std::span(&above, 1))), 0u);
    const DVec3 both[] = {above, -above};
    EXPECT_EQ(backs(Surface(sheet, 0, true, both)), 2u);
    const Surface cube(scene_of({unit_cube()}), 0, true, std::span(&above, 1));
    EXPECT_EQ(cube.faces().size(), 4u) << "its top and its side to +x, but no side that it grazes";
}

TEST(Surface, TheInsideOfAClosedSolidIsDark) {
    Mesh two = unit_cube();
    scene::append(two, scene::centered_box({5, 0, 0}, Vec3(1)));
    EXPECT_EQ(backs(Surface(scene_of({two}, true), 0, true)), 0u);

    Mesh open = two;
    open.triangles.pop_back();
    EXPECT_EQ(backs(Surface(scene_of({open}, true), 0, true)), 11u) << "only that which is open";

    Mesh inside_out = unit_cube();
    for (UVec3& t : inside_out.triangles)
        std::swap(t.y, t.z);
    EXPECT_EQ(backs(Surface(scene_of({inside_out}, true), 0, true)), 12u);

    SceneData masked = scene_of({unit_cube()}, true).data();
    masked.materials[0].alpha_cutoff = 0.5f;
    EXPECT_EQ(backs(Surface(Scene(masked), 0, true)), 12u) << "light falls through its holes";
}

TEST(Surface, MirroringKeepsWhatIsTheFront) {
    const Scene scene =
        placed(scene::ground(Vec2(-1), Vec2(1)), {scene::scaling({-1, 1, 1}), Mat4(1.0f)});
    for (const std::uint32_t instance : {0u, 1u}) {
        const Surface surface(scene, instance, true);
        for (const Face& face : surface.faces()) {
            EXPECT_EQ(face.normal_ws, DVec3(0, 1, 0));
            const DVec3 turned = glm::cross(face.corners_ws[1] - face.corners_ws[0],
                                            face.corners_ws[2] - face.corners_ws[0]);
            EXPECT_GT(turned.y, 0.0) << "counter-clockwise seen from its side";
        }
        EXPECT_EQ(
            surface.across(0, 0).size() + surface.across(0, 1).size() + surface.across(0, 2).size(),
            1u);
    }
}

TEST(Surface, TrianglesWithoutAreaAreLeftOut) {
    const float next = std::nextafter(1.0f, 2.0f);
    const Mesh mesh = soup({{0, 0, 0},
                            {1, 0, 0},
                            {0, 0, -1},  // one with area
                            {0, 0, 0},
                            {0, 0, 0},
                            {0, 0, 0},  // a point
                            {0, 0, 0},
                            {1, 0, 0},
                            {3, 0, 0},  // a line
                            {0, 1, 0},
                            {1, 1, 0},
                            {2, next, 0},  // a line but for rounding
                            {0, 0, 0},
                            {1, 0, 0},
                            {0, 0.001f, 0}});  // thin, but a triangle
    EXPECT_EQ(Surface(scene_of({mesh}), 0, true).faces().size(), 2u);
    // Far from the origin as well: an instance's place takes no shape away.
    EXPECT_EQ(Surface(placed(mesh, {scene::translation({0, 0, 1e6f})}), 0, true).faces().size(),
              2u);
    EXPECT_TRUE(Surface(placed(mesh, {scene::scaling({0, 0, 0})}), 0, true).faces().empty());
}

TEST(Surface, AreaIsThatOfTheWorld) {
    const Surface surface(placed(unit_cube(), {scene::scaling({1, 2, 3})}), 0, true);
    // 2 (1*2 + 2*3 + 3*1); coordinates are whole and halves, exact in double.
    EXPECT_DOUBLE_EQ(surface.area_m2(), 22.0);
}

}  // namespace
}  // namespace gnomon::lightmap
