#include "base/text.h"

#include <gtest/gtest.h>

#include <array>

namespace gnomon {
namespace {

constexpr std::array<std::string_view, 3> kNames = {"shadow_map", "shadow_volumes", "ray_traced"};

TEST(NearestName, FindsAMisspelling) {
    EXPECT_EQ(nearest_name("shadow_mpa", kNames), "shadow_map");
    EXPECT_EQ(nearest_name("raytraced", kNames), "ray_traced");
}

TEST(NearestName, ToleratesTwoErrorsOrAThirdOfTheWord) {
    constexpr std::array<std::string_view, 1> kLong = {"abcdefghijkl"};
    EXPECT_EQ(nearest_name("abcdefgh", kLong), "");            // 4 of 8 are missing
    EXPECT_EQ(nearest_name("abcdefghi", kLong), kLong[0]);     // 3 of 9
    EXPECT_EQ(nearest_name("abcdefghxxxx", kLong), kLong[0]);  // 4 of 12 are others
    EXPECT_EQ(nearest_name("abcdefgxxxxx", kLong), "");        // 5 of 12
    constexpr std::array<std::string_view, 1> kShort = {"abc"};
    EXPECT_EQ(nearest_name("axx", kShort), "abc");
    EXPECT_EQ(nearest_name("xxx", kShort), "");
}

TEST(NearestName, PrefersTheNearerAndThenTheFirst) {
    constexpr std::array<std::string_view, 3> kFilters = {"box_3x3", "box_4x4", "box_4x5"};
    EXPECT_EQ(nearest_name("box_4x4", kFilters), "box_4x4");
    EXPECT_EQ(nearest_name("box_4x6", kFilters), "box_4x4");
}

TEST(NearestName, IsEmptyWithoutCandidates) {
    EXPECT_EQ(nearest_name("word", {}), "");
}

TEST(Suggestion, IsPartOfASentence) {
    EXPECT_EQ("no such name" + suggestion("raytraced", kNames),
              "no such name, did you mean \"ray_traced\"?");
}

TEST(NearestName, IsEmptyForAnotherWord) {
    EXPECT_EQ(nearest_name("lightning", kNames), "");
    EXPECT_EQ(suggestion("lightning", kNames), "");
}

}  // namespace
}  // namespace gnomon
