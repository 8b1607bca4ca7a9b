#include <gnomon/error.h>
#include <gnomon/visibility.h>

#include "gpu/device_test.h"
#include "raster/small_scene_test.h"
#include "visibility/context_test.h"
#include "visibility/visibility_impl.h"

#include <cmath>

namespace gnomon {
namespace {

class VisibilityTest : public ContextTest {
protected:
    static Context::Impl& impl() { return context().impl(); }
};

/// Values that differ at every pixel.
void fill(Image& image) {
    for (std::size_t i = 0; i < image.pixels().size(); ++i)
        image.pixels()[i] = 1.0f / static_cast<float>(i + 1);
}

bool is_filled(const Image& image, Extent size) {
    Image expected(size, 1);
    fill(expected);
    return image.size() == size &&
           std::equal(image.pixels().begin(), image.pixels().end(), expected.pixels().begin());
}

TEST_F(VisibilityTest, MovesToTheDeviceAndBackUnchanged) {
    Visibility visibility;
    for (const Extent size : {Extent{5, 3}, Extent{64, 64}, Extent{1, 1}, Extent{5, 3}}) {
        fill(visibility.impl().host_target(impl(), size));
        EXPECT_TRUE(is_filled(visibility.image(), size));
        const std::vector<float> pixels =
            gpu::read_back<float>(impl().device(), visibility.impl().on_device());
        const Image& image = visibility.image();
        EXPECT_TRUE(std::equal(pixels.begin(), pixels.end(), image.pixels().begin()));
        EXPECT_EQ(visibility.size(), size);
    }
}

TEST_F(VisibilityTest, RenderedOnTheDeviceIsReadWhenAskedFor) {
    constexpr Extent kSize{7, 2};
    Visibility source;
    fill(source.impl().host_target(impl(), kSize));
    gpu::Buffer bytes =
        gpu::make_buffer(impl().device(), std::span<const float>(source.image().pixels()),
                         VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    Visibility visibility;
    visibility.impl().host_target(impl(), kSize).at(0, 0) = 0.5f;  // to be void
    gpu::Image& target = visibility.impl().device_target(impl(), kSize);
    gpu::Commands commands = impl().submission().begin();
    commands.use(bytes, gpu::Use::copy_source);
    commands.use(target, gpu::Use::copy_target);
    commands.copy(bytes, target);
    impl().submission().submit_and_wait();
    EXPECT_TRUE(is_filled(visibility.image(), kSize));
}

TEST_F(VisibilityTest, IsEmptyUntilRenderedInto) {
    Visibility visibility;
    EXPECT_EQ(visibility.size(), Extent{});
    EXPECT_TRUE(visibility.image().empty());
    EXPECT_TRUE(visibility.texel_size_m().empty());
    EXPECT_EQ(visibility.filter_radius_texels(), 0.0f);
    EXPECT_THROW(visibility.impl().on_device(), Error);
}

/// A camera at the origin that looks along -Z at a wall, 10 m wide, `distance_m` away.
Frame wall_frame(float distance_m = 5.0f) {
    Frame frame{.scene = Scene(raster::scene_data({raster::wall({0, 0, -distance_m}, 10)})),
                .size = {32, 32}};
    frame.camera.fov_y_rad = radians(60.0f);
    frame.light = DirectionalLight{.to_light_ws = {0, 0, 1}};
    return frame;
}

TEST_F(VisibilityTest, KnowsTheTexelsOfWhatWasRenderedLast) {
    const Frame frame = wall_frame();
    Visibility visibility;
    visibility.impl().host_target(impl(), frame.size);
    visibility.impl().set_texels([](Vec3 p_ws) { return 100.0f + p_ws.x; }, 2.0f, frame);
    EXPECT_EQ(visibility.filter_radius_texels(), 2.0f);
    const Image& texels = visibility.texel_size_m();
    ASSERT_EQ(texels.size(), frame.size);
    // A pixel's centre at 5 m: half a pixel from the axis.
    const float half_pixel_m = 5.0f * std::tan(radians(30.0f)) / 32.0f;
    EXPECT_NEAR(texels.at(16, 16), 100.0f + half_pixel_m, 1e-4f);
    EXPECT_NEAR(texels.at(0, 0), 100.0f - 31.0f * half_pixel_m, 1e-4f);

    visibility.impl().host_target(impl(), frame.size);
    EXPECT_TRUE(visibility.texel_size_m().empty());
    EXPECT_EQ(visibility.filter_radius_texels(), 0.0f);
}

TEST_F(VisibilityTest, KnowsWhetherTexelsLieAcrossTheLight) {
    const Frame frame = wall_frame();
    Visibility visibility;
    visibility.impl().host_target(impl(), frame.size);
    visibility.impl().set_texels([](Vec3) { return 0.25f; }, 2.0f, frame);
    EXPECT_TRUE(visibility.impl().has_texels_across_light());

    visibility.impl().host_target(impl(), frame.size);
    visibility.impl().set_texels(
        [](const trace::Receiver& receiver) { return 5.0f + receiver.normal_ws.z; }, 2.0f, frame);
    EXPECT_EQ(visibility.texel_size_m().at(20, 7), 6.0f);
    EXPECT_FALSE(visibility.impl().has_texels_across_light());
    visibility.impl().host_target(impl(), frame.size);
    visibility.impl().set_texels(Image(frame.size, 1, 0.25f), 2.0f);
    EXPECT_FALSE(visibility.texel_size_m().empty());
    EXPECT_FALSE(visibility.impl().has_texels_across_light());
}

class ContextCacheTest : public VisibilityTest {};

std::size_t receivers_in(const FrameReceivers& receivers) {
    std::size_t count = 0;
    for (const trace::Receiver& point : receivers.points)
        count += point.exists() ? 1 : 0;
    return count;
}

TEST_F(ContextCacheTest, DrawsAFrameOnceForAllLights) {
    Frame frame = wall_frame();
    const FrameReceivers* first = impl().receivers(frame).get();
    Progress silent;
    const trace::Receiver* points = impl().receiver_points(frame, silent)->points.data();
    frame.light = PointLight{};
    EXPECT_EQ(impl().receivers(frame).get(), first);
    EXPECT_EQ(impl().receiver_points(frame, silent)->points.data(), points);
}

TEST_F(ContextCacheTest, DrawsAnewWhatChangesTheReceivers) {
    Progress silent;
    const auto count = [&](const Frame& frame) {
        return receivers_in(*impl().receiver_points(frame, silent));
    };
    Frame frame = wall_frame();
    const std::size_t all = std::size_t{frame.size.width} * frame.size.height;
    EXPECT_EQ(count(frame), all);
    frame.camera = look_at(Vec3(0), Vec3(0, 0, 9));
    EXPECT_EQ(count(frame), 0u);
    frame.camera = wall_frame().camera;
    EXPECT_EQ(count(frame), all);
    frame.camera.near_m = 6.0f;
    EXPECT_EQ(count(frame), 0u);
    frame = wall_frame(20.0f);  // another scene
    EXPECT_LT(count(frame), all);
    frame.size = {8, 4};
    EXPECT_LE(count(frame), 32u);
    frame.camera.ortho_height_m = 1.0f;
    frame.camera.ortho_depth_m = 30.0f;
    EXPECT_EQ(count(frame), 32u);

    SceneData data = raster::scene_data({raster::wall({0, 0, -5}, 10)});
    data.materials[0].base_color.a = 0.2f;
    data.materials[0].alpha_cutoff = 0.5f;
    frame = wall_frame();
    frame.scene = Scene(std::move(data));
    EXPECT_EQ(count(frame), 0u);
    frame.ignore_alpha = true;
    EXPECT_EQ(count(frame), all);
}

TEST_F(ContextCacheTest, LeavesReceiversToThoseWhoHoldThem) {
    Progress silent;
    const Frame near = wall_frame();
    Frame away = near;
    away.camera = look_at(Vec3(0), Vec3(0, 0, 9));
    const std::shared_ptr<FrameReceivers> held = impl().receiver_points(near, silent);
    const std::shared_ptr<FrameReceivers> other = impl().receiver_points(away, silent);
    EXPECT_EQ(receivers_in(*held), std::size_t{near.size.width} * near.size.height);
    EXPECT_EQ(receivers_in(*other), 0u);
}

TEST(ContextOptionsTest, AreChecked) {
    for (const ContextOptions& options :
         {ContextOptions{.threads = -1}, ContextOptions{.device = "no such device"}}) {
        try {
            const Context context(options);
            FAIL() << "a context was made";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
        }
    }
}

class GroundTruthTest : public VisibilityTest {};

TEST_F(GroundTruthTest, ChecksItsSamples) {
    const Frame frame = wall_frame();
    for (const int samples : {0, -1, 65'537})
        EXPECT_THROW(trace_visibility(context(), frame, {.samples = samples}), Error) << samples;
    EXPECT_NO_THROW(trace_visibility(context(), frame, {.samples = 65'536}));
}

TEST_F(GroundTruthTest, ChecksItsFrame) {
    for (const Extent size : {Extent{0, 1}, Extent{1, 0}, Extent{16'385, 1}}) {
        Frame frame = wall_frame();
        frame.size = size;
        EXPECT_THROW(trace_visibility(context(), frame), Error);
        EXPECT_THROW(comparison_mask(context(), frame), Error);
    }
    Frame frame = wall_frame();
    frame.camera.near_m = std::nanf("");
    EXPECT_THROW(trace_visibility(context(), frame), Error);
}

/// Asks to stop at once.
class Cancelled : public Progress {
public:
    bool cancelled() const override { return true; }
};

TEST_F(GroundTruthTest, CanBeCancelledAndAskedAgain) {
    const Frame frame = wall_frame();
    Cancelled progress;
    try {
        trace_visibility(context(), frame, {}, progress);
        FAIL() << "went on to the end";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::cancelled);
    }
    const Visibility visibility = trace_visibility(context(), frame);
    for (const float v : visibility.image().pixels())
        EXPECT_EQ(v, 1.0f);
}

TEST_F(GroundTruthTest, IsInShadowBehindACaster) {
    // The right half of the wall is behind a board that the camera does not see.
    Frame frame = wall_frame();
    frame.scene =
        Scene(raster::scene_data({raster::wall({0, 0, -5}, 10), raster::wall({5, 0, 1}, 10)}));
    const Visibility visibility = trace_visibility(context(), frame);
    for (unsigned x = 0; x < 32; ++x)
        EXPECT_EQ(visibility.image().at(x, 9), x < 16 ? 1.0f : 0.0f);
}

TEST_F(GroundTruthTest, JudgesReceiversThatTheLightCanReach) {
    Frame frame = wall_frame(20.0f);
    const auto judged = [&](const Light& light) {
        frame.light = light;
        const ComparisonMask mask = comparison_mask(context(), frame);
        std::size_t count = 0;
        for (const float v : mask.facing.pixels())
            count += v > 0.0f ? 1 : 0;
        return count;
    };
    Progress silent;
    const std::size_t all = receivers_in(*impl().receiver_points(frame, silent));
    ASSERT_GT(all, 50u);
    ASSERT_LT(all, std::size_t{32} * 32);  // there is a background
    EXPECT_EQ(judged(DirectionalLight{.to_light_ws = {0, 0, 1}}), all);
    EXPECT_EQ(judged(DirectionalLight{.to_light_ws = {0, 0, -1}}), 0u);
    // A little below the horizon, but its disc is not.
    DirectionalLight low{.to_light_ws = normalize({1, 0, -0.1f})};
    EXPECT_EQ(judged(low), 0u);
    low.angular_diameter_rad = 0.3f;
    EXPECT_EQ(judged(low), all);
    // Too low for normals of 16 bits to tell.
    EXPECT_EQ(judged(DirectionalLight{.to_light_ws = normalize({1, 0, 0.5e-4f})}), 0u);
    EXPECT_EQ(judged(DirectionalLight{.to_light_ws = normalize({1, 0, 2e-4f})}), all);
    EXPECT_EQ(judged(PointLight{.position_ws = {0, 0, -19}}), all);
    EXPECT_EQ(judged(PointLight{.position_ws = {0, 0, -21}}), 0u);
    EXPECT_EQ(judged(DiscLight{.center_ws = {0, 0, -10}, .normal_ws = {0, 0, -1}}), all);
    EXPECT_EQ(judged(DiscLight{.center_ws = {0, 0, -10}, .normal_ws = {0, 0, 1}}), 0u);

    // A spot's circle of 2 m on a square of 10 m; pixels are 0.72 m wide, so count to half of that
    // along the circle's rim.
    const SpotLight spot{
        .position_ws = {0, 0, -18}, .direction_ws = {0, 0, -1}, .outer_angle_rad = radians(45.0f)};
    const double expected = static_cast<double>(all) * kPi * 4.0 / 100.0;
    EXPECT_NEAR(static_cast<double>(judged(spot)), expected, 0.5 * 4.0 * kPi / 0.72);
}

TEST_F(GroundTruthTest, KnowsTheSizeOfPixelsAtTheirReceivers) {
    // A wall that faces the camera shows how far apart the receivers of neighbouring pixels are.
    for (const bool parallel : {false, true}) {
        Frame frame = wall_frame();
        if (parallel) {
            frame.camera.ortho_height_m = 3.0f;
            frame.camera.ortho_depth_m = 30.0f;
        }
        Progress silent;
        const std::vector<trace::Receiver> points = impl().receiver_points(frame, silent)->points;
        const ComparisonMask mask = comparison_mask(context(), frame);
        for (unsigned y = 0; y < 32; ++y) {
            for (unsigned x = 0; x + 1 < 32; ++x) {
                const float apart_m = glm::distance(points[y * 32 + x].position_ws,
                                                    points[y * 32 + x + 1].position_ws);
                EXPECT_NEAR(mask.pixel_size_m.at(x, y), apart_m, 1e-5f);
            }
        }
    }
}

}  // namespace
}  // namespace gnomon
