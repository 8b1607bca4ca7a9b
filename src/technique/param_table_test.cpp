#include "technique/param_table.h"

#include <gnomon/error.h>

#include <gtest/gtest.h>

#include <limits>

namespace gnomon {
namespace {

enum class Filter { nearest, box, disc };

struct Options {
    bool snap = true;
    int map_size = 64;
    double bias = 0.25;
    Filter filter = Filter::box;
};

const ParamTable<Options>& table() {
    static const ParamTable<Options> table(
        "example", {boolean("snap", &Options::snap, "moves in whole texels"),
                    integer("map_size", &Options::map_size, 16, 4096, "texels", "side of the map"),
                    number("bias", &Options::bias, -1.0, 1.0, "m", "towards the light"),
                    choice("filter", &Options::filter, {"nearest", "box", "disc"}, "of the map")});
    return table;
}

/// What the call throws, an Error{input}.
template <typename Call>
std::string refusal(const Call& call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

std::string refusal(const std::string& name, const ParamValue& value) {
    return refusal([&] { table().options({{name, value}}); });
}

void expect_contains(const std::string& text, std::initializer_list<std::string_view> parts) {
    for (const std::string_view part : parts)
        EXPECT_NE(text.find(part), std::string::npos) << text << " lacks " << part;
}

TEST(ParamTable, HasTheDefaultsOfItsOptions) {
    const Options options = table().options({});
    EXPECT_EQ(options.snap, true);
    EXPECT_EQ(options.map_size, 64);
    EXPECT_EQ(options.bias, 0.25);
    EXPECT_EQ(options.filter, Filter::box);
    const std::vector<ParamInfo>& infos = table().infos();
    ASSERT_EQ(infos.size(), 4u);
    EXPECT_EQ(infos[0].default_value, ParamValue(true));
    EXPECT_EQ(infos[1].default_value, ParamValue(64));
    EXPECT_EQ(infos[2].default_value, ParamValue(0.25));
    EXPECT_EQ(infos[3].default_value, ParamValue(std::string("box")));
}

TEST(ParamTable, DescribesItsRows) {
    const ParamInfo& info = table().infos()[1];
    EXPECT_EQ(info.name, "map_size");
    EXPECT_EQ(info.type, ParamType::integer);
    EXPECT_EQ(info.min, 16.0);
    EXPECT_EQ(info.max, 4096.0);
    EXPECT_EQ(info.unit, "texels");
    EXPECT_EQ(info.meaning, "side of the map");
    EXPECT_EQ(table().infos()[3].choices, (std::vector<std::string>{"nearest", "box", "disc"}));
}

TEST(ParamTable, SetsWhatIsNamedAndNothingElse) {
    const Options options = table().options({{"snap", false}, {"filter", std::string("disc")}});
    EXPECT_EQ(options.snap, false);
    EXPECT_EQ(options.filter, Filter::disc);
    EXPECT_EQ(options.map_size, 64);
    EXPECT_EQ(options.bias, 0.25);
    EXPECT_EQ(table().options({{"map-size", 128}}).map_size, 128);
}

TEST(ParamTable, TakesTheEndsOfARangeAndNoMore) {
    for (const int inside : {16, 4096})
        EXPECT_EQ(table().options({{"map_size", inside}}).map_size, inside);
    for (const int outside : {15, 4097, -16}) {
        expect_contains(refusal("map_size", outside),
                        {"example.map_size", '"' + std::to_string(outside) + '"', "[16, 4096]"});
    }
    for (const double inside : {-1.0, 0.0, 1.0})
        EXPECT_EQ(table().options({{"bias", inside}}).bias, inside);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    for (const double outside : {-1.001, 1.001, kInfinity, -kInfinity}) {
        expect_contains(refusal("bias", outside), {"example.bias", "[-1, 1]"});
    }
}

TEST(ParamTable, TakesNoNan) {
    expect_contains(refusal("bias", std::numeric_limits<double>::quiet_NaN()),
                    {"example.bias", "nan", "[-1, 1]"});
}

TEST(ParamTable, TakesAWholeNumberForANumberAndNotTheOtherWay) {
    EXPECT_EQ(table().options({{"bias", 1}}).bias, 1.0);
    expect_contains(refusal("map_size", 64.0), {"map_size", "whole number"});
}

TEST(ParamTable, RefusesOtherTypes) {
    refusal("snap", 1);
    refusal("snap", std::string("true"));
    refusal("map_size", true);
    refusal("map_size", std::string("64"));
    refusal("bias", false);
    refusal("filter", 1);
}

TEST(ParamTable, NamesTheChoices) {
    expect_contains(refusal("filter", std::string("bilinear")),
                    {"example.filter", "\"bilinear\"", "nearest, box, disc"});
    refusal("filter", std::string(""));
    refusal("filter", std::string("Box"));
}

TEST(ParamTable, SuggestsTheNearestName) {
    expect_contains(refusal("map_sise", 64),
                    {"example", "\"map_sise\"", "did you mean \"map_size\"?"});
    // Far from all: it names them.
    const std::string text = refusal("samples_per_pixel", 64);
    expect_contains(text, {"snap, map_size, bias, filter"});
    EXPECT_EQ(text.find("did you mean"), std::string::npos) << text;
}

TEST(ParamTable, MayBeEmpty) {
    const ParamTable<Options> empty("plain", {});
    EXPECT_NO_THROW(empty.options({}));
    expect_contains(refusal([&] { empty.options({{"size", 1}}); }), {"plain", "none at all"});
}

TEST(FindParam, TakesDashesForUnderscores) {
    EXPECT_EQ(find_param("example", table().infos(), "map-size").name, "map_size");
    EXPECT_EQ(find_param("example", table().infos(), "map_size").name, "map_size");
}

ParamValue parsed(std::size_t row, std::string_view text) {
    return parse_param("example", table().infos()[row], text);
}

TEST(ParseParam, ReadsEachType) {
    EXPECT_EQ(parsed(0, "true"), ParamValue(true));
    EXPECT_EQ(parsed(0, "false"), ParamValue(false));
    EXPECT_EQ(parsed(1, "128"), ParamValue(128));
    EXPECT_EQ(parsed(2, "-0.5"), ParamValue(-0.5));
    EXPECT_EQ(parsed(2, "1e-3"), ParamValue(0.001));
    EXPECT_EQ(parsed(2, "1"), ParamValue(1.0));
    EXPECT_EQ(parsed(3, "disc"), ParamValue(std::string("disc")));
}

TEST(ParseParam, RefusesWhatIsNotWhollyAValue) {
    const std::vector<std::pair<std::size_t, std::vector<std::string>>> bad = {
        {0, {"", "1", "True", "yes", "true "}},
        {1, {"", "64.0", "64x", "0x40", " 64", "99999999999", "15", "true"}},
        {2, {"", "0.5m", "half", "nan", "inf", "1e999", "0,5", "2"}},
        {3, {"", "boxes", "BOX"}}};
    for (const auto& [row, texts] : bad) {
        for (const std::string& text : texts) {
            const std::string message = refusal([&, r = row] { parsed(r, text); });
            expect_contains(message, {"example." + table().infos()[row].name, '"' + text + '"'});
        }
    }
}

TEST(ToString, IsReadBackAsTheSameValue) {
    for (const char* text : {"true", "false"})
        EXPECT_EQ(to_string(parsed(0, text)), text);
    for (const int value : {16, 17, 4096})
        EXPECT_EQ(parsed(1, to_string(value)), ParamValue(value));
    for (const double value : {0.8, 1.0, -1.0, 1.0 / 3.0, 1e-300, 0.1 + 0.2})
        EXPECT_EQ(parsed(2, to_string(value)), ParamValue(value));
    EXPECT_EQ(to_string(std::string("disc")), "disc");
    EXPECT_EQ(to_string(0.8), "0.8");
    EXPECT_EQ(to_string(4), "4");
}

TEST(Params, KeepTheLastValueOfAName) {
    Params params{{"bias", 0.5}};
    params.set("bias", 0.75);
    EXPECT_EQ(table().options(params).bias, 0.75);
}

}  // namespace
}  // namespace gnomon
