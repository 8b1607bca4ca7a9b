#include "lightmap/dilate.h"

#include "lightmap/scenes_test.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gnomon::lightmap {
namespace {

struct Colour {
    std::uint8_t r, g, b;
};

TEST(Dilate, GivesTexelsTheNearestChartsValue) {
    const Scene scene = scene_of({unit_cube(), scene::sphere(0.5f, 12, 6)});
    const Atlas atlas = make_atlas(scene, {.texel_size_m = 0.1, .padding_texels = 3});
    const Texels found = make_texels(scene, atlas);
    ASSERT_EQ(atlas.page_sides_texels.size(), 1u);
    const int side = static_cast<int>(atlas.page_sides_texels[0]);
    std::vector<int> charts(static_cast<std::size_t>(side) * side, -1);
    for (const Texel& t : found.texels)
        charts[std::size_t{t.y} * side + t.x] = static_cast<int>(atlas.facets[t.facet].chart);

    const std::vector<std::uint32_t> sources = dilation_sources(atlas, found, 0, 3);
    ASSERT_EQ(sources.size(), charts.size());
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            int least = -1;
            for (int dy = -3; dy <= 3; ++dy) {
                for (int dx = -3; dx <= 3; ++dx) {
                    const int cx = x + dx;
                    const int cy = y + dy;
                    if (cx < 0 || cy < 0 || cx >= side || cy >= side) continue;
                    if (charts[static_cast<std::size_t>(cy) * side + cx] < 0) continue;
                    const int distance2 = dx * dx + dy * dy;
                    if (least < 0 || distance2 < least) least = distance2;
                }
            }
            const std::uint32_t source = sources[static_cast<std::size_t>(y) * side + x];
            ASSERT_EQ(source == kNoTexel, least < 0);
            if (least < 0) continue;
            const int dx = static_cast<int>(source) % side - x;
            const int dy = static_cast<int>(source) / side - y;
            ASSERT_EQ(dx * dx + dy * dy, least);
            ASSERT_GE(charts[source], 0);
        }
    }
}

TEST(Dilate, BilinearLookUpsOnAChartSeeThatChartAlone) {
    const Scene scene = scene_of({unit_cube(), scene::sphere(0.5f, 12, 6)});
    const Atlas atlas = make_atlas(scene, {.texel_size_m = 0.1});
    const Texels found = make_texels(scene, atlas);
    const std::size_t side = atlas.page_sides_texels.at(0);
    constexpr std::uint8_t kNothing = 255;
    std::vector<Colour> page(side * side, Colour{kNothing, 0, 0});
    const auto mark = [&](std::uint32_t chart) {
        return Colour{static_cast<std::uint8_t>(chart % kNothing), 1, 2};
    };
    for (const Texel& t : found.texels)
        page[t.y * side + t.x] = mark(atlas.facets[t.facet].chart);
    dilate<Colour>(page, dilation_sources(atlas, found, 0, atlas.options.padding_texels));
    std::size_t lookups = 0;
    for (const PlacedTriangle& placed : atlas.triangles) {
        const std::uint32_t chart = atlas.facets[placed.facet].chart;
        for (int i = 0; i <= 8; ++i) {
            for (int j = 0; i + j <= 8; ++j) {
                const dvec2 p =
                    weighted(placed.corners_texels, {i / 8.0, j / 8.0, (8 - i - j) / 8.0});
                const dvec2 first = glm::floor(p - 0.5);
                for (int k = 0; k < 4; ++k) {
                    const double x = first.x + k % 2;
                    const double y = first.y + k / 2;
                    if (x < 0 || y < 0) continue;  // clamped by the sampler
                    const auto index =
                        static_cast<std::size_t>(y) * side + static_cast<std::size_t>(x);
                    ASSERT_EQ(page[index].r, mark(chart).r);
                    ++lookups;
                }
            }
        }
    }
    EXPECT_GT(lookups, 1000u);
}

}  // namespace
}  // namespace gnomon::lightmap
