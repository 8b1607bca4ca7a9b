#include "post_projective.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace gnomon::psm {
namespace {

class PostProjective : public testing::Test {
protected:
    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine_);
    }
    DVec3 direction() {
        for (;;) {
            const DVec3 d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
            if (glm::length(d) > 0.1 && glm::length(d) < 1.0) return glm::normalize(d);
        }
    }
    VirtualCamera camera() {
        const DVec3 eye = 5.0 * direction();
        const Camera camera = look_at(Vec3(eye), Vec3(2.0 * direction()),
                                      radians(static_cast<float>(uniform(20, 100))));
        return virtual_camera(camera, {160, 90}, {uniform(0.1, 2.0), uniform(20.0, 200.0)});
    }
    /// A point that the camera sees.
    DVec3 seen(const VirtualCamera& camera) {
        const std::vector<DVec3> corners = camera.corners_ws();
        DVec3 p(0.0);
        double weights = 0.0;
        for (const DVec3& corner : corners) {
            const double weight = uniform(0, 1);
            p += weight * corner;
            weights += weight;
        }
        return p / weights;
    }

    std::mt19937 engine_{5};
};

glm::dvec3 image(const Projection& projection, const DVec3& p_ws) {
    const glm::dvec4 p(p_ws, 1.0);
    const double w = glm::dot(projection.w, p);
    return {glm::dot(projection.x, p) / w, glm::dot(projection.y, p) / w, w};
}

// Wherever the light is, casters are looked up where their receivers are, were they behind the
// camera.
TEST_F(PostProjective, ALightsRaysAreSinglePlacesOfItsMap) {
    int tested = 0;
    for (int round = 0; round < 300; ++round) {
        const VirtualCamera camera = this->camera();
        const DVec3 to_light = direction();
        const Projection projection = light_camera(camera, {to_light, 0.0}, camera.corners_ws());
        const DVec3 receiver = seen(camera);
        const glm::dvec3 at = image(projection, receiver);
        if (!(at.z > 0.0)) continue;  // of a light that looks into the camera
        const glm::dvec3 caster = image(projection, receiver + uniform(0, 500) * to_light);
        EXPECT_NEAR(caster.x, at.x, 1e-6 * (1.0 + std::abs(at.x)));
        EXPECT_NEAR(caster.y, at.y, 1e-6 * (1.0 + std::abs(at.y)));
        EXPECT_NEAR(caster.z / at.z, 1.0, 1e-6);
        ++tested;
    }
    EXPECT_GT(tested, 200);
}

TEST_F(PostProjective, EveryPointSeenIsOnTheFaceOfItsGreatestW) {
    for (int round = 0; round < 300; ++round) {
        const VirtualCamera camera = this->camera();
        const bool is_point = round % 2 == 0;
        const glm::dvec4 light =
            is_point ? glm::dvec4(20.0 * direction(), 1.0) : glm::dvec4(direction(), 0.0);
        const std::vector<Projection> faces = cube_faces(camera, light);
        ASSERT_GE(faces.size(), is_point ? 1u : 3u);
        ASSERT_LE(faces.size(), is_point ? 6u : 5u);
        for (int i = 0; i < 20; ++i) {
            const DVec3 p = seen(camera);
            const auto w = [&](const Projection& face) { return image(face, p).z; };
            const Projection& face = *std::ranges::max_element(faces, {}, w);
            const glm::dvec3 at = image(face, p);
            EXPECT_GT(at.z, 0.0);
            EXPECT_LE(std::abs(at.x), 1.0 + 1e-6);
            EXPECT_LE(std::abs(at.y), 1.0 + 1e-6);
            if (!is_point) continue;
            // Farther from the light on the same ray is at the same place, and has a greater w.
            const glm::dvec3 beyond = image(face, p + 0.5 * (p - DVec3(light)));
            EXPECT_NEAR(beyond.x, at.x, 1e-6);
            EXPECT_NEAR(beyond.z / at.z, 1.5, 1e-6);
        }
    }
}

TEST_F(PostProjective, ASlidCameraSeesWhatTheViewCameraDoes) {
    for (int round = 0; round < 100; ++round) {
        const VirtualCamera camera = this->camera();
        Box3 bounds;
        bounds.include(Vec3(-30));
        bounds.include(Vec3(30));
        for (const VirtualCamera& back :
             {slid(camera, uniform(0.0, 50.0)), slid_behind(camera, bounds)}) {
            for (int i = 0; i < 20; ++i) {
                const glm::dvec4 p = back.clip_from_world() * glm::dvec4(seen(camera), 1.0);
                EXPECT_LE(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}),
                          p.w * (1.0 + 1e-9));
            }
        }
    }
}

TEST_F(PostProjective, FindsTheNarrowestCone) {
    for (int round = 0; round < 100; ++round) {
        const DVec3 axis = direction();
        const double half_rad = uniform(0.05, 1.2);
        const DVec3 across = glm::normalize(glm::cross(axis, direction()));
        const DVec3 other = glm::cross(axis, across);
        std::vector<DVec3> directions;
        for (int i = 0; i < 40; ++i) {
            const double turn = uniform(0.0, 6.28318);
            const double from_axis = i < 20 ? half_rad : uniform(0.0, half_rad);
            directions.push_back(std::cos(from_axis) * axis +
                                 std::sin(from_axis) *
                                     (std::cos(turn) * across + std::sin(turn) * other));
        }
        const DVec3 found = narrowest_cone_axis(directions);
        double widest_rad = 0.0;
        for (const DVec3& d : directions)
            widest_rad = std::max(widest_rad, std::acos(std::min(glm::dot(found, d), 1.0)));
        EXPECT_LT(widest_rad, 1.02 * half_rad);
    }
}

}  // namespace
}  // namespace gnomon::psm
