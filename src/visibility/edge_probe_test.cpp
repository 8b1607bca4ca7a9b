#include "visibility/edge_probe.h"

#include "raster/small_scene_test.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace gnomon {
namespace {

using raster::quad;

constexpr float kHalfWidth_m = 5.0f;

/// Level at y, from x0 to x1, its front above.
Mesh level(float x0, float x1, float y) {
    return quad({x0, y, kHalfWidth_m}, {x1 - x0, 0, 0}, {0, 0, -2.0f * kHalfWidth_m});
}

Mesh ground() {
    return level(-kHalfWidth_m, kHalfWidth_m, 0.0f);
}

/// One receiver on the first mesh, level.
class Probed {
public:
    Probed(std::vector<Mesh> meshes, Vec3 p_ws, const Light& light) {
        Progress silent;
        const trace::Receiver receiver{.position_ws = p_ws, .normal_ws = {0, 1, 0}, .id = {0, 0}};
        probe_ = make_edge_probe(std::make_shared<const trace::Tracer>(
                                     Scene(raster::scene_data(std::move(meshes))), false, silent),
                                 std::span(&receiver, 1), light);
    }
    bool finds_light(double reach_m) const { return find(reach_m, true); }
    bool finds_shadow(double reach_m) const { return find(reach_m, false); }

private:
    bool find(double reach_m, bool lit) const {
        const EdgeProbe::Place place{0, reach_m};
        return probe_->find(std::span(&place, 1), lit).at(0) != 0;
    }
    std::shared_ptr<const EdgeProbe> probe_;
};

const DirectionalLight kNoon{.to_light_ws = {0, 1, 0}};

TEST(EdgeProbe, FindsLightBesideAThinShadow) {
    for (const Light& light : {Light(kNoon), Light(PointLight{.position_ws = {0, 100, 0}}),
                               Light(SpotLight{.position_ws = {0, 100, 0},
                               .direction_ws = {0, -1, 0},
                               .outer_angle_rad = radians(10.0f)})}) {
        const Probed below_wire({ground(), level(-0.05f, 0.05f, 1.0f)}, {0, 0, 0}, light);
        EXPECT_FALSE(below_wire.finds_light(0.04)) << light_name(light);
        EXPECT_TRUE(below_wire.finds_light(0.06)) << light_name(light);
    }
}

TEST(EdgeProbe, FindsTheEdgeOfAShadowOnThePlane) {
    const Probed lit({ground(), level(-kHalfWidth_m, -0.5f, 1.0f)}, {0, 0, 0}, kNoon);
    EXPECT_FALSE(lit.finds_shadow(0.45));
    EXPECT_TRUE(lit.finds_shadow(0.7));
    EXPECT_TRUE(lit.finds_light(0.1));
}

// The sun shines on the wall of a block: on its floor a shadow begins at the wall, where nobody
// sees it.
TEST(EdgeProbe, FindsAShadowThatItsCasterHides) {
    const Mesh side = quad({-0.5f, 0, kHalfWidth_m}, {0, 0, -2.0f * kHalfWidth_m}, {0, 2, 0});
    const Probed foot({ground(), level(-kHalfWidth_m, -0.5f, 2.0f), side}, {0, 0, 0},
                      DirectionalLight{.to_light_ws = glm::normalize(Vec3(0.1f, 1, 0))});
    EXPECT_FALSE(foot.finds_shadow(0.45));
    EXPECT_TRUE(foot.finds_shadow(0.7));
}

// A hollow lies above its tangent planes. Shadow there would be a technique's own.
TEST(EdgeProbe, TakesNoBentSurfaceForAShadow) {
    constexpr float kRise = 0.2f;  // a bend of 11°
    const Mesh slope = quad({0, 0, kHalfWidth_m}, {kHalfWidth_m, kRise * kHalfWidth_m, 0},
                            {0, 0, -2.0f * kHalfWidth_m});
    const Probed hollow({level(-kHalfWidth_m, 0, 0), slope}, {-0.01f, 0, 0}, kNoon);
    EXPECT_FALSE(hollow.finds_shadow(0.5));
    EXPECT_FALSE(hollow.finds_shadow(3.0));
}

// Of a low sun what is near across it is far along the plane.
TEST(EdgeProbe, ReachesAcrossTheLight) {
    constexpr float kSlant = 10.0f;
    const Probed dark({ground(), level(-kHalfWidth_m, -2.0f, 0.5f)}, {2, 0, 0},
                      DirectionalLight{.to_light_ws = glm::normalize(Vec3(-kSlant, 1, 0))});
    // The shadow of the roof's edge ends at x = -2 + 0.5 * 10 = 3, a metre away: a tenth across.
    EXPECT_TRUE(dark.finds_light(0.15));
    EXPECT_FALSE(dark.finds_light(0.08));
}

// The ground's horizon hides the sun's middle, but nothing does that stands there.
TEST(EdgeProbe, FindsLightBesideAReceiverThatTheMiddleIsBehind) {
    const DirectionalLight setting{.to_light_ws = glm::normalize(Vec3(1, -0.002f, 0)),
                                   .angular_diameter_rad = radians(0.53f)};
    EXPECT_TRUE(Probed({ground()}, {4.9f, 0, 0}, setting).finds_light(0.1));
    const Mesh wall = quad({5, -1, kHalfWidth_m}, {0, 0, -2.0f * kHalfWidth_m}, {0, 2, 0});
    EXPECT_FALSE(Probed({ground(), wall}, {4.9f, 0, 0}, setting).finds_light(0.1));
}

// No texel shows a plane that the light grazes: those around it show what is beside it.
TEST(EdgeProbe, FindsShadowBesideAPlaneThatTheLightGrazes) {
    const DirectionalLight low{.to_light_ws = glm::normalize(Vec3(1, 0.005f, 0))};
    const Mesh beam = quad({1, 0.3f, kHalfWidth_m}, {0, 0, -2.0f * kHalfWidth_m}, {0, 0.2f, 0});
    const Probed below_beam({ground(), beam}, {0, 0, 0}, low);
    EXPECT_FALSE(below_beam.finds_shadow(0.25));  // though the ground's other side is dark
    EXPECT_TRUE(below_beam.finds_shadow(0.45));
}

TEST(EdgeProbe, KnowsTheMiddleOfASphereButNotOfFlatLights) {
    Progress silent;
    const auto tracer =
        std::make_shared<const trace::Tracer>(Scene(raster::scene_data({ground()})), false, silent);
    EXPECT_NE(make_edge_probe(tracer, {}, SphereLight{}), nullptr);
    EXPECT_EQ(make_edge_probe(tracer, {}, DiscLight{}), nullptr);
    EXPECT_EQ(make_edge_probe(tracer, {}, RectLight{}), nullptr);
    EXPECT_NE(make_edge_probe(tracer, {}, DirectionalLight{.angular_diameter_rad = 0.01f}),
              nullptr);
}

}  // namespace
}  // namespace gnomon
