#include <gnomon/error.h>

#include "gpu/device.h"

#include <gtest/gtest.h>

namespace gnomon::gpu {
namespace {

Candidate candidate(int index, const std::string& name, DeviceType type,
                    const std::string& missing = {}) {
    Candidate made;
    made.info.index = index;
    made.info.name = name;
    made.info.type = type;
    made.info.missing = missing;
    made.info.usable = missing.empty();
    return made;
}

/// Best first: one that is too old, and two that will do.
std::vector<Candidate> workstation() {
    return {candidate(0, "GeForce GTX 630", DeviceType::discrete, "Vulkan 1.3"),
            candidate(1, "GeForce RTX 4090", DeviceType::discrete),
            candidate(2, "llvmpipe (LLVM 15.0.6)", DeviceType::cpu)};
}

std::string chosen(const std::string& wanted) {
    const std::vector<Candidate> candidates = workstation();
    return choose_device(candidates, wanted).info.name;
}

/// What choose_device() throws.
Error refusal(const std::vector<Candidate>& candidates, const std::string& wanted) {
    try {
        choose_device(candidates, wanted);
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "\"" << wanted << "\" was found";
    return {ErrorKind::cancelled, ""};
}

bool contains(const Error& error, const std::string& text) {
    return std::string(error.what()).find(text) != std::string::npos;
}

TEST(ChooseDevice, TakesTheBestUsableOne) {
    EXPECT_EQ(chosen(""), "GeForce RTX 4090");
}

TEST(ChooseDevice, KnowsIndexes) {
    EXPECT_EQ(chosen("1"), "GeForce RTX 4090");
    EXPECT_EQ(chosen("2"), "llvmpipe (LLVM 15.0.6)");
}

TEST(ChooseDevice, KnowsPartsOfNamesInAnyCase) {
    EXPECT_EQ(chosen("LLVM"), "llvmpipe (LLVM 15.0.6)");
    EXPECT_EQ(chosen("rtx"), "GeForce RTX 4090");
    EXPECT_EQ(chosen("GeForce RTX 4090"), "GeForce RTX 4090");
}

TEST(ChooseDevice, TellsWhatThereIs) {
    // A number is an index and nothing else: device 3 of three is not the one with a 3 in its name.
    for (const std::string wanted : {"radeon", "3", "-1", "99999999999999999999", "1x"}) {
        const Error error = refusal(workstation(), wanted);
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_TRUE(contains(error, "\"" + wanted + "\"")) << error.what();
        EXPECT_TRUE(contains(error, "0 \"GeForce GTX 630\"")) << error.what();
        EXPECT_TRUE(contains(error, "2 \"llvmpipe (LLVM 15.0.6)\"")) << error.what();
    }
}

TEST(ChooseDevice, TellsWhatTheWantedOneLacks) {
    for (const std::string wanted : {"0", "gtx"}) {
        const Error error = refusal(workstation(), wanted);
        EXPECT_EQ(error.kind(), ErrorKind::machine);
        EXPECT_TRUE(contains(error, "GeForce GTX 630")) << error.what();
        EXPECT_TRUE(contains(error, "Vulkan 1.3")) << error.what();
    }
}

TEST(ChooseDevice, TellsWhatEachLacksWhenNoneWillDo) {
    std::vector<Candidate> candidates = {workstation()[0]};
    candidates.push_back(candidate(1, "SwiftShader", DeviceType::cpu, "feature depthClamp"));
    const Error error = refusal(candidates, "");
    EXPECT_EQ(error.kind(), ErrorKind::machine);
    EXPECT_TRUE(contains(error, "\"GeForce GTX 630\" lacks Vulkan 1.3")) << error.what();
    EXPECT_TRUE(contains(error, "\"SwiftShader\" lacks feature depthClamp")) << error.what();
}

TEST(ChooseDevice, TellsThatThereIsNone) {
    EXPECT_EQ(refusal({}, "").kind(), ErrorKind::machine);
    EXPECT_EQ(refusal({}, "0").kind(), ErrorKind::machine);
}

TEST(Rank, PutsTheFastestKindFirstAndKeepsTheOrderWithin) {
    const std::vector<Candidate> ranked =
        rank({candidate(0, "virtual", DeviceType::other), candidate(0, "lavapipe", DeviceType::cpu),
              candidate(0, "UHD 770", DeviceType::integrated),
              candidate(0, "first", DeviceType::discrete), candidate(0, "swift", DeviceType::cpu),
              candidate(0, "second", DeviceType::discrete)});
    const std::vector<std::string> expected = {"first",    "second", "UHD 770",
                                               "lavapipe", "swift",  "virtual"};
    ASSERT_EQ(ranked.size(), expected.size());
    for (std::size_t i = 0; i < ranked.size(); ++i) {
        EXPECT_EQ(ranked[i].info.name, expected[i]);
        EXPECT_EQ(ranked[i].info.index, static_cast<int>(i));
    }
}

TEST(ListDevices, DescribesThem) {
    const std::vector<DeviceInfo> devices = list_devices();
    ASSERT_FALSE(devices.empty()) << "the tests need a Vulkan device, e.g. lavapipe";
    for (std::size_t i = 0; i < devices.size(); ++i) {
        EXPECT_EQ(devices[i].index, static_cast<int>(i));
        EXPECT_EQ(devices[i].usable, devices[i].missing.empty()) << devices[i].name;
        EXPECT_FALSE(devices[i].name.empty());
        EXPECT_FALSE(devices[i].driver.empty());
        EXPECT_EQ(devices[i].api.substr(0, 2), "1.");
    }
}

TEST(Device, IsTheOneAskedFor) {
    for (const DeviceInfo& info : list_devices()) {
        if (!info.usable) continue;
        const Device device(ContextOptions{.device = std::to_string(info.index)});
        EXPECT_EQ(device.info().name, info.name);
        EXPECT_EQ(device.info().index, info.index);
    }
    EXPECT_THROW(Device(ContextOptions{.device = "no such device"}), Error);
}

}  // namespace
}  // namespace gnomon::gpu
