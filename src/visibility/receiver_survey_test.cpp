#include "visibility/receiver_survey.h"

#include "gpu/commands.h"
#include "visibility/context_impl.h"
#include "visibility/context_test.h"

#include <algorithm>

namespace gnomon {
namespace {

/// No multiple of a block, a tile or a group.
constexpr Extent kSize{203, 117};

/// Of positions in floats, which the tracer and the survey compute in different ways.
constexpr float kRounding = 1e-4f;

class ReceiverSurveyTest : public ContextTest {
protected:
    static Seen survey(const Frame& frame) {
        const gpu::Device& device = context().impl().device();
        ReceiverSurvey survey(device);
        gpu::Submission submission(device);
        gpu::Commands commands = submission.begin();
        survey.record(commands, context().impl().receivers(frame)->device);
        submission.submit_and_wait();
        return survey.seen();
    }

    static bool holds(const SeenTile& tile, Vec3 p_ws, double distance_m) {
        const float rounding_m = kRounding * static_cast<float>(distance_m);
        return glm::all(glm::lessThanEqual(tile.bounds.min - rounding_m, p_ws)) &&
               glm::all(glm::lessThanEqual(p_ws, tile.bounds.max + rounding_m)) &&
               distance_m >= tile.range.near_m && distance_m <= tile.range.far_m;
    }

    static void expect_all_in_tiles(const Frame& frame) {
        const Seen seen = survey(frame);
        Progress silent;
        std::size_t receivers = 0;
        for (const trace::Receiver& receiver :
             context().impl().receiver_points(frame, silent)->points) {
            if (!receiver.exists()) continue;
            ++receivers;
            const Vec3 p_ws = receiver.position_ws;
            const double distance_m = -(frame.camera.view_from_world * Vec4(p_ws, 1.0f)).z;
            EXPECT_TRUE(std::ranges::any_of(
                seen.tiles, [&](const SeenTile& tile) { return holds(tile, p_ws, distance_m); }))
                << distance_m << " m away";
        }
        EXPECT_GT(receivers, kSize.width * kSize.height / 4);
    }

    static Frame frame_of(const char* name) {
        const Scene scene = make_builtin_scene(name);
        return {.scene = scene,
                .camera = scene.cameras().front(),
                .light = scene.lights().front(),
                .size = kSize};
    }
};

TEST_F(ReceiverSurveyTest, EveryReceiverIsInATile) {
    for (const char* scene : {"courtyard", "field-large"})
        expect_all_in_tiles(frame_of(scene));
}

TEST_F(ReceiverSurveyTest, OfAParallelCameraToo) {
    Frame frame = frame_of("courtyard");
    frame.camera.ortho_height_m = 12.0f;
    frame.camera.ortho_depth_m = 100.0f;
    expect_all_in_tiles(frame);
}

// A box around each tile alone would hold all that is between a tree and the hills behind it.
TEST_F(ReceiverSurveyTest, TilesAreCutWhereDistancesJump) {
    const Seen seen = survey(frame_of("field-large"));
    constexpr double kQuarterOctave = 1.25;  // the longest: from 1 to 1.25
    for (const SeenTile& tile : seen.tiles)
        EXPECT_LE(tile.range.far_m, (kQuarterOctave + kRounding) * tile.range.near_m);
}

}  // namespace
}  // namespace gnomon
