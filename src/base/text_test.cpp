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

TEST(NearestName, IsEmptyForAnotherWord) {
    EXPECT_EQ(nearest_name("lightning", kNames), "");
    EXPECT_EQ(suggestion("lightning", kNames), "");
}

}  // namespace
}  // namespace gnomon
