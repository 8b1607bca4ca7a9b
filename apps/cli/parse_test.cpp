#include "parse.h"

#include <gnomon/error.h>

#include "progress.h"
#include "view.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace gnomon::cli {
namespace {

/// The message of the Error{input} that `call` throws, empty when it throws none.
template <typename Call>
std::string message_of(Call call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    return {};
}

void expect_mentions(const std::string& message, std::initializer_list<const char*> words) {
    for (const char* word : words) {
        EXPECT_NE(message.find(word), std::string::npos) << '"' << message << "\" lacks " << word;
    }
    EXPECT_EQ(message.find('\n'), std::string::npos) << "one line";
}

// ---- words and numbers

TEST(Suggestion, FindsAMisspellingOnly) {
    constexpr std::array<std::string_view, 2> kNames = {"--technique", "--size"};
    EXPECT_EQ(suggestion("--techniqe", kNames), ", did you mean \"--technique\"?");
    EXPECT_EQ(suggestion("--validation", kNames), "");
}

TEST(Number, KeepsDoublePrecision) {
    EXPECT_EQ(parse_number("--x", "447000.125", {0, 1e9, ""}), 447000.125);
    EXPECT_EQ(parse_number("--x", "-1e-3", {-1, 1, ""}), -1e-3);
}

TEST(Number, RefusesWhatIsNoFiniteNumberInRange) {
    for (const char* text : {"nan", "inf", "-inf", "", "1,0", "1x", " 1", "0x10", "1e999", "-2"}) {
        const std::string message = message_of([&] { parse_number("--x", text, {-1, 1, "m"}); });
        expect_mentions(message, {"--x", text, "-1 to 1 m"});
    }
}

TEST(Integer, RefusesFractionsAndOverflow) {
    EXPECT_EQ(parse_integer("--n", "65536", {1, 65536, ""}), 65536);
    for (const char* text : {"1.5", "1e3", "65537", "0", "99999999999999999999", "four"}) {
        const std::string message = message_of([&] { parse_integer("--n", text, {1, 65536, ""}); });
        expect_mentions(message, {"--n", text, "1 to 65536"});
    }
}

TEST(Size, IsWidthByHeight) {
    EXPECT_EQ(parse_size("--size", "1280x720"), (Extent{1280, 720}));
    EXPECT_EQ(parse_size("--size", "1x16384"), (Extent{1, 16384}));
}

TEST(Size, NamesTheRange) {
    for (const char* text : {"0x0", "1x0", "99999999x1", "16385x1", "12", "axb", "12x", "x12",
                             "1x2x3", "-1x5", "", "1280 x 720", "4294967297x1"}) {
        const std::string message = message_of([&] { parse_size("--size", text); });
        expect_mentions(message, {"--size", text, "1 to 16384 pixels", "1280x720"});
    }
}

TEST(Clock, IsHoursMinutesAndMaybeSeconds) {
    EXPECT_EQ(parse_clock("--time", "10:30"), 37800.0);
    EXPECT_EQ(parse_clock("--time", "00:00:07.25"), 7.25);
    EXPECT_EQ(parse_clock("--time", "24:00:59"), 86459.0);
    EXPECT_EQ(parse_clock("--time", "9:30"), 34200.0);
    for (const char* text : {"", "10", ":30", "100:30", "10:3", "10:60", "10:30:60", "10:30:5",
                             "10:30:15:1", "10.5:30", "-1:30", "10:30pm", "10:30:1e1", "noon"}) {
        const std::string message = message_of([&] { parse_clock("--time", text); });
        expect_mentions(message, {"--time", text, "10:30"});
    }
}

TEST(Clock, IsToldInSeconds) {
    EXPECT_EQ(clock_text(37815.4), "10:30:15");
    EXPECT_EQ(clock_text(-60.0), "23:59:00");
    EXPECT_EQ(clock_text(86400.0), "24:00:00");
}

TEST(Vector, HasThreeNumbers) {
    EXPECT_EQ(parse_vector("v", "1,-2,3.5", {-9, 9, ""}), DVec3(1, -2, 3.5));
    for (const char* text : {"1,2", "1,2,3,4", "1,,3", "1,2,nan", ""}) {
        EXPECT_NE(message_of([&] { parse_vector("v", text, {-9, 9, ""}); }), "") << text;
    }
}

TEST(Color, IsGreyOrThreeNumbers) {
    EXPECT_EQ(parse_color("c", "2", {0, 9, ""}), Vec3(2.0f));
    EXPECT_EQ(parse_color("c", "1,2,3", {0, 9, ""}), Vec3(1, 2, 3));
    expect_mentions(message_of([] { parse_color("c", "1,2", {0, 9, ""}); }), {"1,2", "r,g,b"});
    EXPECT_NE(message_of([] { parse_color("c", "-1", {0, 9, ""}); }), "");
}

TEST(List, RefusesEmptyAndRepeatedNames) {
    EXPECT_EQ(parse_list("--t", "a,b"), (std::vector<std::string>{"a", "b"}));
    EXPECT_NE(message_of([] { parse_list("--t", "a,,b"); }), "");
    EXPECT_NE(message_of([] { parse_list("--t", "a,a"); }), "");
    EXPECT_NE(message_of([] { parse_list("--t", ""); }), "");
}

TEST(Word, SuggestsTheNearest) {
    constexpr std::string_view kWays[] = {"additive", "subtractive"};
    EXPECT_EQ(parse_word("--compose", "additive", kWays), "additive");
    expect_mentions(message_of([&] { parse_word("--compose", "aditive", kWays); }),
                    {"--compose", "\"aditive\"", "did you mean \"additive\"?", "subtractive"});
}

// ---- key=value

constexpr std::array<Key, 3> kKeys{{{"eye", true}, {"fov"}, {"name"}}};

TEST(KeyValues, ValueRunsToTheNextKey) {
    const KeyValues keys("--c", "eye=1,2,3,fov=40,name=a,b", kKeys, "--c eye=0,0,0");
    EXPECT_EQ(keys.vector("eye", {-9, 9, ""}), DVec3(1, 2, 3));
    EXPECT_EQ(keys.number("fov", {1, 90, ""}, 0.0), 40.0);
    EXPECT_EQ(keys.text("name", ""), "a,b");
}

TEST(KeyValues, ErrorsNameTheKeyAndWhatIsAllowed) {
    const auto parse = [](const char* text) {
        return message_of([&] { KeyValues("--c", text, kKeys, "--c eye=0,0,0"); });
    };
    expect_mentions(parse("fov=40"), {"eye is missing", "as in --c eye=0,0,0"});
    expect_mentions(parse(""), {"eye is missing"});
    expect_mentions(parse("eyes=1,2,3"), {"\"eyes\"", "did you mean \"eye\"?", "eye, fov, name"});
    expect_mentions(parse("eye=1,2,3,eye=1,2,3"), {"eye is given twice"});
    expect_mentions(parse("1,2,3"), {"\"1\"", "key=value"});
    expect_mentions(parse("eye="), {"eye has no value"});
}

// ---- cameras and lights

TEST(ParseCamera, LooksFromEyeToTarget) {
    const Camera camera = parse_camera("eye=0,0,5,target=0,0,0,fov=60,near=0.25");
    EXPECT_EQ(camera.eye_ws(), Vec3(0, 0, 5));
    EXPECT_FLOAT_EQ(camera.fov_y_rad, radians(60.0f));
    EXPECT_EQ(camera.near_m, 0.25f);
    const Vec4 target_vs = camera.view_from_world * Vec4(0, 0, 0, 1);
    EXPECT_NEAR(target_vs.z, -5.0f, 1e-5f) << "along -Z of the view; float rounding of 5 m";
}

TEST(ParseCamera, SubtractsTheOffsetInDouble) {
    // At 447,000 m a float is 1/32 m wide; half of that must survive.
    FileFrame frame;
    frame.origin_offset_m = {85000, 0, 447000};
    const Camera camera = parse_camera("eye=85000,2,447000.015625,target=85001,0,447000", frame);
    // look_at keeps no eye but a rotated offset, so a few ulps of 2 m are lost.
    EXPECT_NEAR(camera.eye_ws().z, 0.015625f, 1e-6f);
}

TEST(ParseCamera, RefusesWhatIsNoCamera) {
    const auto parse = [](const char* text) { return message_of([&] { parse_camera(text); }); };
    expect_mentions(parse("eye=nan,0,0,target=0,0,0"), {"--camera: eye", "nan"});
    expect_mentions(parse("eye=1,0,0,target=inf,0,0"), {"--camera: target", "inf"});
    expect_mentions(parse("eye=1,0,0"), {"target is missing"});
    expect_mentions(parse("eye=1,0,0,target=1,0,0"), {"--camera: target"});
    expect_mentions(parse("eye=1,0,0,target=0,0,0,fov=180"), {"fov", "180", "0.1 to 179 degrees"});
    expect_mentions(parse("eye=1e300,0,0,target=0,0,0"), {"eye", "1e300", "metres"});
    expect_mentions(parse("eye=1,0,0,target=0,0,0,near=0"), {"near"});
}

TEST(FileFrame, TurnsZUpIntoYUp) {
    FileFrame frame;
    frame.z_up = true;
    EXPECT_EQ(frame.point({1, 2, 3}), Vec3(1, 3, -2)) << "up and north stay up and north";
    frame.origin_offset_m = {10, 20, 30};
    EXPECT_EQ(frame.file_point_m(frame.point({1, 2, 3})), DVec3(1, 2, 3));
}

TEST(ParseLight, SunStandsAtElevationAndAzimuth) {
    const Light light = parse_light("sun:elevation=30,azimuth=90,diameter=0,irradiance=3,2,1");
    const auto& sun = std::get<DirectionalLight>(light);
    // Azimuth 90° is +X; sin 30° = 1/2. Tolerance: float rounding of the sine.
    EXPECT_NEAR(sun.to_light_ws.x, std::sqrt(0.75f), 1e-6f);
    EXPECT_NEAR(sun.to_light_ws.y, 0.5f, 1e-6f);
    EXPECT_NEAR(sun.to_light_ws.z, 0.0f, 1e-6f);
    EXPECT_EQ(sun.irradiance, Vec3(3, 2, 1));
    EXPECT_FALSE(has_extent(light));
    EXPECT_TRUE(has_extent(parse_light("sun:elevation=30,azimuth=90"))) << "the real sun's disc";
}

TEST(ParseLight, EveryKindParses) {
    const std::pair<const char*, const char*> kTexts[] = {
        {"sun:elevation=35,azimuth=120", "directional"},
        {"point:position=0,3,0,intensity=5", "point"},
        {"spot:position=0,5,0,target=1,0,0,inner=10,outer=30", "spot"},
        {"sphere:center=0,3,0,radius=0.2", "sphere"},
        {"disc:center=0,3,0,normal=0,-2,0,radius=0.5", "disc"},
        {"rect:center=0,3,0,u=0.5,0,0,v=0,0,0.5", "rect"},
    };
    for (const auto& [text, kind] : kTexts) {
        const Light light = parse_light(text);
        EXPECT_EQ(light_kind(light), kind);
        EXPECT_EQ(light_name(light), std::string_view(text).substr(0, light_name(light).size()));
    }
    EXPECT_EQ(light_name(parse_light("point:position=0,1,0,name=lamp")), "lamp");
}

TEST(ParseLight, RefusesWhatIsNoLight) {
    const auto parse = [](const char* text) { return message_of([&] { parse_light(text); }); };
    expect_mentions(parse("son:elevation=1,azimuth=2"), {"\"son\"", "did you mean \"sun\"?"});
    expect_mentions(parse("sun"), {"elevation is missing", "as in --light sun:elevation="});
    expect_mentions(parse("sun:elevtion=1,azimuth=2"), {"did you mean \"elevation\"?"});
    expect_mentions(parse("sun:elevation=95,azimuth=0"), {"elevation", "95", "-90 to 90 degrees"});
    expect_mentions(parse("sun:elevation=nan,azimuth=0"), {"elevation", "nan"});
    expect_mentions(parse("point:position=0,3"), {"position", "0,3"});
    expect_mentions(parse("point:position=0,3,0,intensity=-1"), {"intensity", "-1"});
    expect_mentions(parse("spot:position=0,5,0,target=0,5,0"), {"target"});
    expect_mentions(parse("spot:position=0,5,0,target=0,0,0,inner=40,outer=30"), {"inner", "40"});
    expect_mentions(parse("disc:center=0,0,0,normal=0,0,0,radius=1"), {"normal"});
    expect_mentions(parse("sphere:center=0,0,0,radius=0"), {"radius", "0"});
    expect_mentions(parse("rect:center=0,0,0,u=1,0,0,v=1,1,0"), {"v", "right angles"});
}

// ---- parameters of techniques

bool named_on(const ParamFlag& flag) {
    return flag.param == "on";
}

TEST(ParamFlags, AreTakenOutWithTheirValues) {
    std::vector<std::string> args = {
        "render", "--shadow-map.map-size", "1024", "scene.glb", "--a_b.c_d=-2.5", "-o", "x.png"};
    const std::vector<ParamFlag> flags = take_param_flags(args, named_on);
    EXPECT_EQ(args, (std::vector<std::string>{"render", "scene.glb", "-o", "x.png"}));
    const std::vector<ParamFlag> expected = {
        {"shadow_map", "map_size", "1024", "--shadow-map.map-size"},
        {"a_b", "c_d", "-2.5", "--a_b.c_d"}};
    EXPECT_EQ(flags, expected);
}

TEST(ParamFlags, SwitchesMayStandAlone) {
    std::vector<std::string> args = {"--t.on", "scene.glb", "--t.on", "false", "--t.on"};
    const std::vector<ParamFlag> flags = take_param_flags(args, named_on);
    EXPECT_EQ(args, (std::vector<std::string>{"scene.glb"}));
    ASSERT_EQ(flags.size(), 3u);
    EXPECT_EQ(flags[0].value, std::nullopt);
    EXPECT_EQ(flags[1].value, "false");
    EXPECT_EQ(flags[2].value, std::nullopt);
}

TEST(ParamFlags, LeaveOtherArgumentsAlone) {
    const std::vector<std::string> all = {"--device=a.b", "x.glb", "-o.x", "--", "--t.size"};
    std::vector<std::string> args = all;
    EXPECT_TRUE(take_param_flags(args, named_on).empty());
    EXPECT_EQ(args, all);
}

TEST(ParamFlags, NeedAValue) {
    for (std::vector<std::string> args :
         {std::vector<std::string>{"--t.size"}, {"--t.size", "--quiet"}, {"--t.size", "-o", "x"}}) {
        expect_mentions(message_of([&] { take_param_flags(args, named_on); }),
                        {"--t.size", "value is missing"});
    }
}

// ---- progress

TEST(ProgressBar, FitsItsColumns) {
    EXPECT_EQ(progress_bar("tracing", 0.5, 75.0, 44),
              "tracing [########---------]  50 %  1:15 left");
    for (int columns = 0; columns < 100; ++columns) {
        EXPECT_LE(progress_bar("tracing truth", 0.3, 5000.0, columns).size(),
                  static_cast<std::size_t>(columns));
    }
}

TEST(ProgressText, LeavesOutAnUnknownTime) {
    EXPECT_EQ(progress_text("tracing", 1.0, -1.0), "tracing 100 %");
    EXPECT_EQ(progress_text("tracing", 0.5, 3723.0), "tracing  50 %  1:02:03 left");
}

}  // namespace
}  // namespace gnomon::cli
