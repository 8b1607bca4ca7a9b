#include "lightmap/packing.h"

#include <gtest/gtest.h>

#include <random>

namespace gnomon::lightmap {
namespace {

bool apart(unsigned a, unsigned a_size, unsigned b, unsigned b_size, unsigned padding) {
    return a + a_size + padding <= b || b + b_size + padding <= a;
}

TEST(Packing, RectanglesKeepTheirDistanceAcrossBordersToo) {
    std::mt19937 engine(1);
    std::uniform_int_distribution<unsigned> side(1, 40);
    std::vector<Extent> rectangles;
    for (int i = 0; i < 300; ++i)
        rectangles.push_back({side(engine), side(engine)});
    constexpr unsigned kPadding = 3;
    const Packing packing = pack(rectangles, kPadding, 128);
    EXPECT_GT(packing.page_sides.size(), 1u);
    for (std::size_t i = 0; i < rectangles.size(); ++i) {
        const Placement a = packing.placements[i];
        const unsigned page = packing.page_sides[a.page];
        EXPECT_EQ(page % kPageStep, 0u);
        EXPECT_LE(page, 128u);
        // The padding right of and below it is clear up to the opposite border.
        EXPECT_LE(a.x + rectangles[i].width + kPadding, page);
        EXPECT_LE(a.y + rectangles[i].height + kPadding, page);
        for (std::size_t j = 0; j < i; ++j) {
            const Placement b = packing.placements[j];
            if (a.page != b.page) continue;
            EXPECT_TRUE(apart(a.x, rectangles[i].width, b.x, rectangles[j].width, kPadding) ||
                        apart(a.y, rectangles[i].height, b.y, rectangles[j].height, kPadding));
        }
    }
}

TEST(Packing, OnePageIsAsSmallAsItCanBe) {
    EXPECT_EQ(pack({{10, 10}}, 2, 4096).page_sides, std::vector<unsigned>{12});
    EXPECT_EQ(pack(std::vector<Extent>(4, {10, 10}), 2, 4096).page_sides,
              std::vector<unsigned>{24});
    EXPECT_TRUE(pack({}, 2, 4096).page_sides.empty());
}

TEST(Packing, LargeSquaresHavePagesOfTheirOwn) {
    const std::vector<Extent> squares(2, {1000, 1000});
    EXPECT_EQ(pack(squares, 4, 4096).page_sides, (std::vector<unsigned>{1004, 1004}));
    EXPECT_EQ(pack(std::vector<Extent>(2, {100, 100}), 4, 4096).page_sides.size(), 1u)
        << "small maps stay on one page";
}

}  // namespace
}  // namespace gnomon::lightmap
