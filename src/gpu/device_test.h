#pragma once

#include "gpu/commands.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace gnomon::gpu {

/// Base of tests on a device, one for all tests of a suite: what the validation layer says fails
/// the test that it says it in.
class DeviceTest : public testing::Test {
protected:
    static void SetUpTestSuite() {
        device_ = std::make_unique<Device>(ContextOptions{.validation = true});
    }
    static void TearDownTestSuite() { device_.reset(); }

    void SetUp() override { messages_before_ = device().validation_messages().size(); }
    void TearDown() override {
        const std::vector<std::string> messages = device().validation_messages();
        for (std::size_t i = messages_before_; i < messages.size(); ++i)
            ADD_FAILURE() << messages[i];
    }

    static const Device& device() { return *device_; }

private:
    static inline std::unique_ptr<Device> device_;
    std::size_t messages_before_ = 0;
};

/// The pixels of an image, of one T each, row by row; its use stays what it is.
template <typename T>
std::vector<T> read_back(const Device& device, Image& image) {
    std::vector<T> pixels(std::size_t{image.size().width} * image.size().height);
    Buffer staging(device, pixels.size() * sizeof(T), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                   Placement::readback);
    const Use use = image.use;
    Submission submission(device);
    Commands commands = submission.begin();
    commands.use(image, Use::copy_source);
    commands.use(staging, Use::copy_target);
    commands.copy(image, staging);
    commands.use(staging, Use::host_read);
    commands.use(image, use);
    submission.submit_and_wait();
    std::memcpy(pixels.data(), staging.mapped(), pixels.size() * sizeof(T));
    return pixels;
}

}  // namespace gnomon::gpu
