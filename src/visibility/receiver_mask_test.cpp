#include "visibility/receiver_mask.h"

#include <gtest/gtest.h>

#include <random>

namespace gnomon {
namespace {

constexpr unsigned kSize_texels = 512;
constexpr double kMargin_texels = 2.0;

Box3 around(Vec3 p, float half) {
    Box3 box;
    box.include(p - Vec3(half));
    box.include(p + Vec3(half));
    return box;
}

class ReceiverMaskTest : public testing::Test {
protected:
    Vec3 point(float half) {
        std::uniform_real_distribution<float> along(-half, half);
        return {along(engine_), along(engine_), along(engine_)};
    }
    LightFit fit() const {
        const std::vector<DVec3> corners_ws{{-20, -20, -20}, {20, -20, -20}, {-20, 20, -20},
                                            {20, 20, -20},   {-20, -20, 20}, {20, -20, 20},
                                            {-20, 20, 20},   {20, 20, 20}};
        return fit_directional(light_, corners_ws, around(Vec3(0.0f), 30.0f), kSize_texels,
                               static_cast<float>(kMargin_texels));
    }

    std::mt19937 engine_{5};
    DirectionalLight light_{.to_light_ws = normalize(Vec3(0.5f, 1.0f, 0.3f))};
};

TEST_F(ReceiverMaskTest, WithoutReceiversEverythingMayHideSome) {
    EXPECT_TRUE(ReceiverMask().is_before_any(around(Vec3(0.0f), 1.0f)));
}

TEST_F(ReceiverMaskTest, KeepsWhatIsBetweenAReceiverAndTheLight) {
    for (int round = 0; round < 100; ++round) {
        const std::vector<Box3> receivers_ws{around(point(15.0f), 1.0f),
                                             around(point(15.0f), 1.0f)};
        const ReceiverMask mask(fit(), receivers_ws, kMargin_texels);
        const Vec3 receiver_ws = receivers_ws[round % 2].center() + point(1.0f);
        const float away_m = 0.1f * static_cast<float>(round);
        EXPECT_TRUE(mask.is_before_any(around(receiver_ws + away_m * light_.to_light_ws, 0.01f)));
    }
}

TEST_F(ReceiverMaskTest, LeavesOutWhatIsBehindAllReceiversOrBesideThem) {
    const Vec3 across = normalize(glm::cross(light_.to_light_ws, Vec3(1.0f, 0.0f, 0.0f)));
    for (int round = 0; round < 100; ++round) {
        const Vec3 receiver_ws = point(10.0f);
        const std::vector<Box3> receivers_ws{around(receiver_ws, 0.5f)};
        const ReceiverMask mask(fit(), receivers_ws, kMargin_texels);
        // Farther than both boxes reach along the light together.
        EXPECT_FALSE(mask.is_before_any(around(receiver_ws - 2.0f * light_.to_light_ws, 0.5f)));
        // Farther than both boxes reach, and a cell of 40 m / 64 with the margin.
        EXPECT_FALSE(mask.is_before_any(around(receiver_ws + 4.0f * across, 0.5f)));
    }
}

}  // namespace
}  // namespace gnomon
