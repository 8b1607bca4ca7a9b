#include "gpu/commands.h"

#include <gnomon/error.h>

#include "gpu/device_test.h"

#include <cmath>

namespace gnomon::gpu {
namespace {

class CommandsTest : public DeviceTest {};

constexpr Extent kSize{8, 8};

TEST_F(CommandsTest, ClearTheTargetsThatTheyAreToldTo) {
    Image color(device(),
                {.size = kSize,
                 .format = VK_FORMAT_R32_UINT,
                 .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    Image depth(device(), {.size = kSize,
                           .format = VK_FORMAT_D32_SFLOAT_S8_UINT,
                           .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT |
                                    VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    Submission submission(device());
    Commands commands = submission.begin();
    for (const bool clear : {true, false}) {
        commands.use(color, Use::color_target);
        commands.use(depth, Use::depth_target);
        // The second clear value must have no effect.
        commands.begin_drawing({.colors = {&color},
                                .depth = &depth,
                                .size = kSize,
                                .clear_colors = clear,
                                .clear_depth = clear,
                                .clear_stencil = true,
                                .clear_value = {.uint32 = {clear ? 7u : 9u, 0, 0, 0}}});
        commands.end_drawing();
    }
    submission.submit_and_wait();
    EXPECT_EQ(read_back<std::uint32_t>(device(), color), std::vector<std::uint32_t>(64, 7u));
    EXPECT_EQ(read_back<float>(device(), depth), std::vector<float>(64, 0.0f));  // the far plane
}

// As when an error is thrown between.
TEST_F(CommandsTest, BeginAnewWhereTheLastWereNotSubmitted) {
    Image color(device(),
                {.size = kSize,
                 .format = VK_FORMAT_R32_UINT,
                 .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    Submission submission(device());
    for (const bool ends : {false, true}) {
        color.use = Use::none;
        Commands commands = submission.begin();
        commands.use(color, Use::color_target);
        commands.begin_drawing(
            {.colors = {&color}, .size = kSize, .clear_value = {.uint32 = {7u, 0, 0, 0}}});
        if (ends) commands.end_drawing();
    }
    submission.submit_and_wait();
    EXPECT_EQ(read_back<std::uint32_t>(device(), color), std::vector<std::uint32_t>(64, 7u));
}

TEST_F(CommandsTest, TimePassesInTheirOrder) {
    Submission submission(device());
    // Twice: a submission forgets the passes of the last.
    for (const std::vector<std::string>& names :
         {std::vector<std::string>{"first", "second", "third"}, {"alone"}}) {
        Commands commands = submission.begin();
        for (const std::string& name : names)
            const Pass pass(commands, name);
        submission.submit_and_wait();
        const std::vector<PassTimer::Time> times = submission.times();
        ASSERT_EQ(times.size(), names.size());
        for (std::size_t i = 0; i < times.size(); ++i) {
            EXPECT_EQ(times[i].name, names[i]);
            EXPECT_TRUE(std::isfinite(times[i].ms) && times[i].ms >= 0.0);
        }
    }
}

TEST_F(CommandsTest, HaveNoTimesWithoutPasses) {
    Submission submission(device());
    submission.begin();
    submission.submit_and_wait();
    EXPECT_TRUE(submission.times().empty());
}

TEST_F(CommandsTest, CanDoWithoutATimer) {
    Submission submission(device());
    Commands commands(device(), submission.begin().handle());
    { const Pass pass(commands, "untimed"); }
    submission.submit_and_wait();
    EXPECT_TRUE(submission.times().empty());
}

TEST(Check, NamesTheCallAndTheResult) {
    EXPECT_NO_THROW(check(VK_SUCCESS, "working"));
    try {
        check(VK_ERROR_DEVICE_LOST, "waiting for the device");
        FAIL() << "a lost device is no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::machine);
        const std::string text = error.what();
        EXPECT_NE(text.find("waiting for the device"), std::string::npos) << text;
        EXPECT_NE(text.find("lost"), std::string::npos) << text;
    }
    EXPECT_THROW(check(VK_TIMEOUT, "waiting"), Error);  // a hung device, though no negative code
}

}  // namespace
}  // namespace gnomon::gpu
