#include <gnomon/error.h>
#include <gnomon/light_path.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

namespace gnomon {
namespace {

constexpr double kRounding = 1e-15;  // of unit vectors in double

std::string error_of(std::string_view json) {
    try {
        parse_light_path(json, "lamp.json");
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        const std::string message = error.what();
        EXPECT_EQ(message.rfind("lamp.json: ", 0), 0u) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        return message;
    }
    return "no error";
}

void expect_near(DVec3 a, DVec3 b) {
    EXPECT_LT(glm::length(a - b), kRounding);
}

TEST(LightPath, DirectionsGoAlongGreatCirclesAtAnEvenPace) {
    const LightPath path(LightPathKind::direction, Interpolation::spherical,
                         {{0.0, {2.0, 0.0, 0.0}}, {3.0, {0.0, 5.0, 0.0}}});
    const double third = std::acos(-1.0) / 6.0;  // of a right angle
    expect_near(path.at(1.0), {std::cos(third), std::sin(third), 0.0});
    expect_near(path.at(2.0), {std::sin(third), std::cos(third), 0.0});
    expect_near(path.at(-1.0), {1.0, 0.0, 0.0});
    expect_near(path.at(9.0), {0.0, 1.0, 0.0});
}

TEST(LightPath, LinearDirectionsStayUnitVectors) {
    const LightPath path(LightPathKind::direction, Interpolation::linear,
                         {{0.0, {1.0, 0.0, 0.0}}, {4.0, {0.0, 1.0, 0.0}}});
    expect_near(path.at(1.0), glm::normalize(DVec3(3.0, 1.0, 0.0)));
}

TEST(LightPath, EqualDirectionsStand) {
    const DVec3 up(0.0, 1.0, 0.0);
    const LightPath path(LightPathKind::direction, Interpolation::spherical,
                         {{0.0, up}, {1.0, up}});
    expect_near(path.at(0.5), up);
}

TEST(LightPath, PositionsGoStraight) {
    const LightPath path(LightPathKind::position, Interpolation::linear,
                         {{0.0, {0.0, 0.0, 0.0}}, {2.0, {4.0, 0.0, 0.0}}, {3.0, {4.0, 8.0, 0.0}}});
    EXPECT_EQ(path.at(1.0), DVec3(2.0, 0.0, 0.0));
    EXPECT_EQ(path.at(2.0), DVec3(4.0, 0.0, 0.0));
    EXPECT_EQ(path.at(2.25), DVec3(4.0, 2.0, 0.0));
}

TEST(LightPath, StepsAreEven) {
    const LightPath path(LightPathKind::position, Interpolation::linear,
                         {{0.0, {0.0, 0.0, 0.0}}, {4.0, {4.0, 0.0, 0.0}}});
    const auto middles = path.steps(4);
    ASSERT_EQ(middles.size(), 4u);
    EXPECT_EQ(middles[0].time_s, 0.5);
    EXPECT_EQ(middles[3].value_ws.x, 3.5);
    const auto ends = path.steps(5, StepPlacement::ends);
    EXPECT_EQ(ends[0].time_s, 0.0);
    EXPECT_EQ(ends[1].time_s, 1.0);
    EXPECT_EQ(ends[4].time_s, 4.0);
    EXPECT_EQ(path.steps(1, StepPlacement::ends)[0].time_s, 0.0);
    EXPECT_THROW(path.steps(0), Error);
}

TEST(LightPath, NumbersMustBeFinite) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    EXPECT_THROW(
        LightPath(LightPathKind::position, Interpolation::linear, {{0.0, {kInfinity, 0.0, 0.0}}}),
        Error);
    EXPECT_THROW(
        LightPath(LightPathKind::position, Interpolation::linear, {{NAN, {0.0, 0.0, 0.0}}}), Error);
    EXPECT_THROW(LightPath(LightPathKind::position, Interpolation::linear, {}), Error);
}

TEST(LightPathFile, IsReadAsDocumented) {
    const LightPath path = parse_light_path(
        R"({"kind": "direction", "keys": [{"time": 0, "value": [0, 1, 0]},
                                          {"time": 60, "value": [1, 1, 0]}]})",
        "lamp.json");
    EXPECT_EQ(path.kind(), LightPathKind::direction);
    EXPECT_EQ(path.interpolation(), Interpolation::spherical);
    EXPECT_EQ(path.end_s(), 60.0);
    expect_near(path.at(60.0), glm::normalize(DVec3(1.0, 1.0, 0.0)));
    const LightPath lamp = parse_light_path(
        R"({"kind": "position", "interpolation": "linear", "keys": [{"time": 0, "value": [1, 2, 3]}]})",
        "lamp.json");
    EXPECT_EQ(lamp.interpolation(), Interpolation::linear);
    EXPECT_EQ(lamp.at(7.0), DVec3(1.0, 2.0, 3.0));
}

TEST(LightPathFile, NamesTheFault) {
    const auto expect_fault = [](std::string_view json, std::string_view fault) {
        EXPECT_NE(error_of(json).find(fault), std::string::npos) << error_of(json);
    };
    expect_fault("{\n\"kind\": ,}", "no valid JSON at line 2");
    expect_fault(R"({"kind": "direction", "keys": [{"time": 1e999, "value": [0, 1, 0]}]})",
                 "holds a number that is too large");
    expect_fault("[]", "must be an object");
    expect_fault(R"({"keys": []})", "\"kind\" is missing");
    expect_fault(R"({"kind": "directon", "keys": []})", "did you mean \"direction\"?");
    expect_fault(R"({"kind": "position", "keys": []})", "has no keys");
    expect_fault(R"({"kind": "position", "keys": 1})", "keys must be an array");
    expect_fault(R"({"kind": "position", "keyz": []})", "did you mean \"keys\"?");
    expect_fault(R"({"kind": "position", "keys": [{"time": 0}]})", "key 0: \"value\" is missing");
    expect_fault(R"({"kind": "position", "keys": [{"time": "0", "value": [0, 0, 0]}]})",
                 "key 0: time must be a number");
    expect_fault(R"({"kind": "position", "keys": [{"time": 0, "value": [0, 0]}]})",
                 "key 0: value must be three numbers");
    expect_fault(R"({"kind": "direction", "keys": [{"time": 0, "value": [0, 0, 0]}]})",
                 "key 0 is (0, 0, 0), which is no direction");
    expect_fault(R"({"kind": "position", "interpolation": "spherical",
                     "keys": [{"time": 0, "value": [0, 0, 0]}]})",
                 "positions cannot be spherical");
    expect_fault(R"({"kind": "position", "keys": [{"time": 1, "value": [0, 0, 0]},
                                                  {"time": 1, "value": [0, 0, 1]}]})",
                 "key 1 is at 1 s; it must be later than key 0 at 1 s");
    expect_fault(R"({"kind": "direction", "keys": [{"time": 0, "value": [0, 1, 0]},
                                                   {"time": 1, "value": [0, -2, 0]}]})",
                 "keys 0 and 1 are opposite");
}

TEST(LightPathFile, MissingFilesAreNamed) {
    try {
        read_light_path("no-such-path.json");
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("no-such-path.json"), std::string::npos);
    }
}

}  // namespace
}  // namespace gnomon
