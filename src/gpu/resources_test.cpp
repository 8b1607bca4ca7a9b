#include "gpu/resources.h"

#include <gnomon/error.h>

#include "gpu/commands.h"
#include "gpu/device_test.h"

#include <numeric>

/// AddressSanitizer's malloc, which lavapipe calls too, is to fail as others do.
extern "C" const char* __asan_default_options() {  // NOLINT(bugprone-reserved-identifier)
    return "allocator_may_return_null=1";
}

namespace gnomon::gpu {
namespace {

std::vector<std::uint8_t> read_back(const Device& device, Buffer& source) {
    Buffer staging(device, source.size_bytes(), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                   Placement::readback);
    Submission submission(device);
    Commands commands = submission.begin();
    commands.use(source, Use::copy_source);
    commands.use(staging, Use::copy_target);
    commands.copy(source, staging, source.size_bytes());
    commands.use(staging, Use::host_read);
    submission.submit_and_wait();
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(staging.mapped());
    return {bytes, bytes + source.size_bytes()};
}

/// Bytes that differ from their neighbours at every power of two.
std::vector<std::uint8_t> pattern(std::size_t count) {
    std::vector<std::uint8_t> bytes(count);
    for (std::size_t i = 0; i < count; ++i)
        bytes[i] = static_cast<std::uint8_t>(i * 7 + i / 251);
    return bytes;
}

Buffer buffer_of(const Device& device, const std::vector<std::uint8_t>& bytes) {
    return make_buffer(device, std::span<const std::uint8_t>(bytes),
                       VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
}

class BufferTest : public DeviceTest {};

TEST_F(BufferTest, HoldsWhatWasUploaded) {
    for (const std::size_t count : {17u, 4096u, 1'000'003u}) {
        Buffer buffer = buffer_of(device(), pattern(count));
        EXPECT_EQ(buffer.size_bytes(), count);
        EXPECT_GE(buffer.memory_bytes(), count);
        EXPECT_EQ(read_back(device(), buffer), pattern(count));
    }
}

TEST_F(BufferTest, HoldsWhatWasUpdated) {
    Buffer buffer = buffer_of(device(), pattern(64));
    Submission submission(device());
    Commands commands = submission.begin();
    commands.update(buffer, std::uint32_t{0x04030201});
    submission.submit_and_wait();
    std::vector<std::uint8_t> expected = pattern(64);
    std::iota(expected.begin(), expected.begin() + 4, std::uint8_t{1});
    EXPECT_EQ(read_back(device(), buffer), expected);
}

TEST_F(BufferTest, RefusesToBeLargerThanShadersCanRead) {
    const std::uint64_t limit = device().limits().maxStorageBufferRange;
    try {
        const Buffer buffer(device(), limit + 1, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                            Placement::device);
        FAIL() << "a buffer of " << limit + 1 << " bytes was made";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::machine);
        EXPECT_NE(std::string(error.what()).find(std::to_string(limit >> 20)), std::string::npos)
            << error.what();
    }
}

TEST_F(BufferTest, CanBeBoundWhenEmpty) {
    Buffer buffer = buffer_of(device(), {});
    EXPECT_TRUE(buffer);
    EXPECT_GE(buffer.size_bytes(), 16u);
}

TEST_F(BufferTest, MovesWithItsContents) {
    Buffer first = buffer_of(device(), pattern(100));
    Buffer second(std::move(first));
    Buffer third = buffer_of(device(), pattern(10));
    third = std::move(second);
    EXPECT_EQ(read_back(device(), third), pattern(100));
}

class ImageTest : public DeviceTest {};

TEST_F(ImageTest, HoldsWhatWasCopiedInRowByRow) {
    constexpr Extent kSize{37, 11};  // no multiple of anything
    Image image(device(), {.size = kSize,
                           .format = VK_FORMAT_R32_UINT,
                           .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                    VK_IMAGE_USAGE_TRANSFER_DST_BIT});
    const std::vector<std::uint8_t> bytes = pattern(std::size_t{37} * 11 * 4);
    Buffer source = buffer_of(device(), bytes);
    Buffer target = buffer_of(device(), std::vector<std::uint8_t>(bytes.size()));
    Submission submission(device());
    Commands commands = submission.begin();
    commands.use(image, Use::copy_target);
    commands.use(source, Use::copy_source);
    commands.copy(source, image);
    commands.use(image, Use::copy_source);
    commands.use(target, Use::copy_target);
    commands.copy(image, target);
    submission.submit_and_wait();
    EXPECT_EQ(read_back(device(), target), bytes);
}

TEST_F(ImageTest, HasTheViewsOfItsFormat) {
    const Image color(
        device(),
        {.size = {4, 4}, .format = VK_FORMAT_R8G8B8A8_SRGB, .usage = VK_IMAGE_USAGE_SAMPLED_BIT});
    EXPECT_NE(color.view(), VK_NULL_HANDLE);
    EXPECT_EQ(color.stencil_view(), VK_NULL_HANDLE);
    const Image depth(device(), {.size = {4, 4},
                                 .format = VK_FORMAT_D32_SFLOAT_S8_UINT,
                                 .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT});
    EXPECT_NE(depth.view(), VK_NULL_HANDLE);
    EXPECT_NE(depth.stencil_view(), VK_NULL_HANDLE);
    EXPECT_NE(depth.attachment_view(), VK_NULL_HANDLE);
}

TEST_F(ImageTest, RefusesToBeLargerThanTheDeviceCan) {
    const unsigned limit = device().limits().maxImageDimension2D;
    for (const Extent size : {Extent{limit + 1, 1}, Extent{1, limit + 1}}) {
        try {
            const Image image(device(), {.size = size,
                                         .format = VK_FORMAT_R32_SFLOAT,
                                         .usage = VK_IMAGE_USAGE_STORAGE_BIT});
            FAIL() << "an image of " << size.width << "x" << size.height << " was made";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            const std::string text = error.what();
            EXPECT_NE(text.find(std::to_string(limit + 1)), std::string::npos) << text;
            EXPECT_NE(text.find(std::to_string(limit)), std::string::npos) << text;
        }
    }
}

/// Kind of the Error that making a resource throws.
template <typename Make>
ErrorKind thrown_kind(const Make& make) {
    try {
        make();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("memory"), std::string::npos) << error.what();
        return error.kind();
    }
    ADD_FAILURE() << "it was made";
    return ErrorKind::cancelled;
}

// Without the validation layer, which says that no heap is that large before the device can.
TEST(OutOfMemory, IsAnErrorThatTheDeviceOutlives) {
    const Device device(ContextOptions{});
    constexpr std::uint64_t kTooLarge = std::uint64_t{1} << 50;  // 1 PiB
    for (const Placement placement : {Placement::device, Placement::upload, Placement::readback}) {
        EXPECT_EQ(thrown_kind([&] {
                      Buffer(device, kTooLarge, VK_BUFFER_USAGE_TRANSFER_DST_BIT, placement);
                  }),
                  ErrorKind::machine);
    }
    const unsigned side = device.limits().maxImageDimension2D;
    EXPECT_EQ(thrown_kind([&] {
                  Image(device, {.size = {side, side},
                                 .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                 .usage = VK_IMAGE_USAGE_STORAGE_BIT,
                                 .layers = device.limits().maxImageArrayLayers});
              }),
              ErrorKind::machine);

    Buffer buffer = buffer_of(device, pattern(1000));
    EXPECT_EQ(read_back(device, buffer), pattern(1000));
}

}  // namespace
}  // namespace gnomon::gpu
