#include <gnomon/error.h>

#include "report/timing.h"

#include <gtest/gtest.h>

namespace gnomon::report {
namespace {

const std::vector<ParamInfo>& params() {
    static const std::vector<ParamInfo> params = {
        {.name = "map_size", .type = ParamType::integer, .default_value = 2048, .max = 8192.0},
        {.name = "bias", .type = ParamType::number, .default_value = 0.5, .max = 1.0}};
    return params;
}

const TechniqueInfo kSunny{
    .name = "sunny", .lights = LightKinds::directional | LightKinds::spot, .params = params};

TEST(ChosenTechniques, AreAllWhenNoneIsNamed) {
    const std::vector<TechniqueChoice> chosen = chosen_techniques({});
    ASSERT_EQ(chosen.size(), techniques().size());
    for (std::size_t i = 0; i < chosen.size(); ++i)
        EXPECT_EQ(chosen[i].name, techniques()[i].name);
}

TEST(ChosenTechniques, ThrowForMisspellingsBeforeAnyWork) {
    CompareOptions options;
    options.techniques = {{"ray_traced", {}}, {"ray_tarced", {}}};
    EXPECT_THROW(chosen_techniques(options), Error);
    options.techniques = {{"ray_traced", {{"no_such_parameter", 1024}}}};
    EXPECT_THROW(chosen_techniques(options), Error);
}

TEST(AllParameters, FillInDefaultsAndKeepOneSpelling) {
    const auto all = all_parameters(kSunny, {.name = "sunny", .params = {{"map-size", 1024}}});
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all.at("map_size"), ParamValue(1024));
    EXPECT_EQ(all.at("bias"), ParamValue(0.5));
}

TEST(UnsupportedNote, SaysWhatIsSupportedInstead) {
    EXPECT_EQ(unsupported_note(kSunny, DirectionalLight{}), "");
    EXPECT_EQ(unsupported_note(kSunny, SpotLight{}), "");
    EXPECT_EQ(unsupported_note(kSunny, PointLight{}),
              "no shadows of point lights (it shadows: directional, spot)");
}

}  // namespace
}  // namespace gnomon::report
