#include "lightmap/atlas.h"

#include <gnomon/error.h>

#include "lightmap/scenes_test.h"
#include "lightmap/texels.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace gnomon::lightmap {
namespace {

std::string error_of(const Scene& scene, const Options& options) {
    try {
        make_atlas(scene, options);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    ADD_FAILURE() << "no error";
    return {};
}

double area_m2(const Facet& facet) {
    return glm::length(glm::cross(facet.u_ws, facet.v_ws));
}

TEST(Atlas, ACubeHasSixChartsOfItsSides) {
    const Atlas atlas = make_atlas(scene_of({unit_cube()}), {.texel_size_m = 0.1});
    ASSERT_EQ(atlas.charts.size(), 6u);
    ASSERT_EQ(atlas.facets.size(), 6u);
    std::set<std::pair<int, int>> sides;
    for (const Chart& chart : atlas.charts) {
        EXPECT_EQ(chart.size, (Extent{10, 10}));
        EXPECT_EQ(chart.triangle_count, 2u);
    }
    for (const Facet& facet : atlas.facets) {
        // 1e-7: float has the corners of 0.5 m exactly, the directions are in double.
        EXPECT_NEAR(glm::length(facet.u_ws), 0.1, 1e-9);
        EXPECT_NEAR(glm::length(facet.v_ws), 0.1, 1e-9);
        EXPECT_NEAR(glm::dot(facet.u_ws, facet.v_ws), 0.0, 1e-9);
        // Seen from the front, u points right and v down.
        EXPECT_LT(glm::dot(glm::cross(facet.u_ws, facet.v_ws), facet.normal_ws), 0.0);
        for (int axis = 0; axis < 3; ++axis) {
            if (std::abs(facet.normal_ws[axis]) > 0.5) {
                sides.insert({axis, facet.normal_ws[axis] > 0.0 ? 1 : -1});
            }
        }
    }
    EXPECT_EQ(sides.size(), 6u);
}

TEST(Atlas, AChartTurnsToTheLeastRectangle) {
    // Turned by 30 degrees about its normal, 2 m by 1 m.
    Mesh sheet = scene::moved(scene::ground({-1.0f, -0.5f}, {1.0f, 0.5f}),
                              scene::rotation_y(radians(30.0f)));
    sheet.texcoords.clear();
    const Atlas atlas = make_atlas(scene_of({sheet}), {.texel_size_m = 0.1});
    ASSERT_EQ(atlas.charts.size(), 1u);
    EXPECT_EQ(atlas.charts[0].size, (Extent{20, 10}));
}

TEST(Atlas, InstancesHaveTexelsOfTheirOwnAndOfOneSize) {
    const Scene scene =
        placed(unit_cube(), {Mat4(1.0f), scene::translation({3, 0, 0}), scene::scaling({1, 2, 3}),
                             scene::scaling({-2, 1, 1})});
    const Atlas atlas = make_atlas(scene, {.texel_size_m = 0.1});
    ASSERT_EQ(atlas.charts.size(), 24u);
    std::vector<std::multiset<std::pair<unsigned, unsigned>>> sizes(4);
    for (const Chart& chart : atlas.charts)
        sizes[chart.instance].insert({chart.size.width, chart.size.height});
    using Sizes = std::multiset<std::pair<unsigned, unsigned>>;
    EXPECT_EQ(sizes[0], (Sizes{{10, 10}, {10, 10}, {10, 10}, {10, 10}, {10, 10}, {10, 10}}));
    EXPECT_EQ(sizes[1], sizes[0]);
    EXPECT_EQ(sizes[2], (Sizes{{20, 10}, {20, 10}, {30, 10}, {30, 10}, {30, 20}, {30, 20}}));
    EXPECT_EQ(sizes[3], (Sizes{{10, 10}, {10, 10}, {20, 10}, {20, 10}, {20, 10}, {20, 10}}));
    for (const Facet& facet : atlas.facets)
        EXPECT_NEAR(area_m2(facet), 0.01, 1e-8);
}

TEST(Atlas, ASphereIsCutIntoChartsThatTurnLittle) {
    Mesh sphere = scene::sphere(1.0f, 48, 24);
    const Options options{.texel_size_m = 0.02, .chart_normal_deg = 20.0};
    const Atlas atlas = make_atlas(scene_of({sphere}), options);
    EXPECT_LT(atlas.charts.size(), sphere.triangles.size() / 4);
    for (const Facet& facet : atlas.facets) {
        const double stretch = area_m2(facet) / (options.texel_size_m * options.texel_size_m);
        EXPECT_GT(stretch, 1.0 - 1e-6);
        EXPECT_LT(stretch, 1.0 / std::cos(glm::radians(options.chart_normal_deg)) + 1e-6);
    }
}

TEST(Atlas, SheetsThatLieOnEachOtherAndRampsAreCut) {
    Mesh twice = scene::ground(Vec2(0), Vec2(1));
    scene::append(twice, scene::ground(Vec2(0), Vec2(1)));
    twice.texcoords.clear();
    EXPECT_EQ(make_atlas(scene_of({twice}), {.texel_size_m = 0.1}).charts.size(), 2u);

    // Two turns of a winding ramp, 5 m wide and 4 m high a turn: its normals stay within 45
    // degrees, its projection covers itself.
    std::vector<Vec3> corners;
    constexpr int kSteps = 64;
    const auto at = [](int step, float radius_m) {
        const float angle_rad = 4.0f * kPi * static_cast<float>(step) / kSteps;
        return Vec3(radius_m * std::cos(angle_rad), 4.0f * angle_rad / (2.0f * kPi),
                    -radius_m * std::sin(angle_rad));
    };
    Mesh ramp = named(Mesh{}, "ramp");
    for (int step = 0; step <= kSteps; ++step) {
        ramp.positions.push_back(at(step, 5.0f));
        ramp.positions.push_back(at(step, 10.0f));
    }
    for (std::uint32_t i = 0; i < 2 * kSteps; i += 2) {
        ramp.triangles.emplace_back(i, i + 1, i + 3);
        ramp.triangles.emplace_back(i, i + 3, i + 2);
    }
    const Scene scene = scene_of({ramp});
    const Atlas atlas = make_atlas(scene, {.texel_size_m = 0.1, .chart_normal_deg = 45.0});
    EXPECT_GE(atlas.charts.size(), 2u);
    std::size_t triangles = 0;
    for (const Chart& chart : atlas.charts)
        triangles += chart.triangle_count;
    EXPECT_EQ(triangles, ramp.triangles.size());
    // No texel's centre has two triangles, so each chart's texels have its area.
    const Texels texels = make_texels(scene, atlas);
    double texels_m2 = 0.0;
    for (const Texel& texel : texels.texels)
        texels_m2 += texel.clamped ? 0.0 : area_m2(atlas.facets[texel.facet]);
    double ramp_m2 = 0.0;
    for (const UVec3 t : ramp.triangles) {
        ramp_m2 += 0.5 * glm::length(glm::cross(ramp.positions[t.y] - ramp.positions[t.x],
                                                ramp.positions[t.z] - ramp.positions[t.x]));
    }
    // The error of counting centres: a part of the texels along the border of some 200 m.
    EXPECT_NEAR(texels_m2, ramp_m2, 0.01 * ramp_m2);
}

TEST(Atlas, AHollowChartIsCut) {
    // The top of a wall around a court of 20 m, 0.5 m thick: 39 m2, whose rectangle has 400.
    const Scene scene = scene_of({scene::rectangular_wall({-10, 0, -10}, {10, 1, 10}, 0.5f)});
    const Atlas atlas = make_atlas(scene, {.texel_size_m = 0.1});
    double rectangles = 0.0;
    for (const Chart& chart : atlas.charts)
        rectangles += static_cast<double>(chart.size.width) * chart.size.height;
    // Uncut, the top's and the bottom's rectangles alone would be 80,000 texels.
    EXPECT_LT(rectangles, 2.0 * static_cast<double>(make_texels(scene, atlas).texels.size()));
}

TEST(Atlas, IsTheSameForAnyNumberOfThreads) {
    const Scene scene = make_builtin_scene("courtyard");
    const auto run = [&](int threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const Atlas atlas = make_atlas(scene, {.texel_size_m = 0.2});
        return std::pair(atlas, make_texels(scene, atlas));
    };
    const auto [one, one_texels] = run(1);
    const auto [two, two_texels] = run(2);
    ASSERT_EQ(one.triangles.size(), two.triangles.size());
    for (std::size_t i = 0; i < one.triangles.size(); ++i)
        ASSERT_EQ(one.triangles[i].corners_texels, two.triangles[i].corners_texels);
    ASSERT_EQ(one_texels.texels.size(), two_texels.texels.size());
    for (std::size_t i = 0; i < one_texels.texels.size(); ++i)
        ASSERT_EQ(one_texels.texels[i].point_ws, two_texels.texels[i].point_ws);
    ASSERT_EQ(one_texels.tiles.size(), two_texels.tiles.size());
}

TEST(Atlas, EstimatesAreNearWhatComes) {
    for (const char* name : {"courtyard", "gas-station", "field-small"}) {
        const Scene scene = make_builtin_scene(name);
        const Options options{.texel_size_m = 0.2};
        const Estimate expected = estimate(scene, options);
        const Atlas atlas = make_atlas(scene, options);
        const Texels texels = make_texels(scene, atlas);
        const auto count = static_cast<double>(texels.texels.size());
        // Its formula is a mean over shapes that are convex: some per cent.
        EXPECT_NEAR(static_cast<double>(expected.texels), count, 0.1 * count) << name;
        EXPECT_EQ(expected.pages, 1u) << name;
        EXPECT_GT(static_cast<double>(expected.bytes),
                  count * sizeof(Texel) + static_cast<double>(texels.tiles.size() * sizeof(Tile)))
            << name;
    }
}

TEST(Atlas, AHugeRequestIsRefusedWithASizeThatFits) {
    const Scene scene = make_builtin_scene("courtyard");
    Options options{.texel_size_m = 1e-5, .memory_limit_bytes = std::uint64_t{64} << 20};
    const std::string message = error_of(scene, options);
    EXPECT_NE(message.find("memory_limit_bytes allows 64 MiB"), std::string::npos) << message;
    const std::string before = "texel_size_m ";
    const std::size_t at = message.rfind(before);
    ASSERT_NE(at, std::string::npos) << message;
    options.texel_size_m = std::stod(message.substr(at + before.size()));
    EXPECT_GT(options.texel_size_m, 1e-3);
    EXPECT_LE(estimate(scene, options).bytes, options.memory_limit_bytes);
    options.memory_limit_bytes = 1000;
    EXPECT_NE(error_of(scene, options).find("no texel_size_m would fit"), std::string::npos);
    options.texel_option = "--texel";
    EXPECT_NE(error_of(scene, options).find("no --texel would fit"), std::string::npos);
    options.texel_size_m = -1.0;
    EXPECT_NE(error_of(scene, options).find("light map: --texel is -1; it must be in"),
              std::string::npos);
}

TEST(Atlas, EstimatesCountWhatIsHeldBesides) {
    const Scene scene = make_builtin_scene("courtyard");
    const Options options{.texel_size_m = 0.2};
    const Estimate alone = estimate(scene, options);
    const auto with = [&](Options more) { return estimate(scene, more).bytes - alone.bytes; };
    Options more = options;
    more.more_texel_bytes = 100;
    EXPECT_NEAR(static_cast<double>(with(more)), 100.0 * static_cast<double>(alone.texels), 100.0);
    more = options;
    more.more_place_bytes = 100;
    EXPECT_GT(with(more), 100 * alone.texels);  // pages have gaps between charts
}

TEST(Atlas, ATriangleLargerThanAPageIsRefusedWithASizeThatFits) {
    const Scene scene = scene_of({named(scene::ground(Vec2(0), Vec2(100)), "ground")});
    Options options{.texel_size_m = 0.1, .max_page_texels = 256, .keep_texcoords = false};
    const std::string message = error_of(scene, options);
    EXPECT_NE(message.find("mesh \"ground\": a triangle"), std::string::npos) << message;
    const std::string before = "at least ";
    options.texel_size_m = std::stod(message.substr(message.find(before) + before.size()));
    EXPECT_EQ(make_atlas(scene, options).charts.size(), 1u);
}

TEST(Atlas, LargeMeshesOfSmallTrianglesAreCutToPages) {
    Mesh field = scene::height_field(Vec2(0), Vec2(100), 50, 50, [](float, float) { return 0.0f; });
    field.texcoords.clear();
    const Atlas atlas =
        make_atlas(scene_of({field}), {.texel_size_m = 0.1, .max_page_texels = 512});
    EXPECT_GE(atlas.page_sides_texels.size(), 4u);
    for (const Chart& chart : atlas.charts)
        EXPECT_LE(std::max(chart.size.width, chart.size.height) + 2, 512u);
}

TEST(Atlas, OptionsOutOfRangeAndEmptyScenesAreNamed) {
    const Scene cube = scene_of({unit_cube()});
    EXPECT_NE(error_of(cube, {.texel_size_m = 0.0}).find("texel_size_m is 0"), std::string::npos);
    EXPECT_NE(error_of(cube, {.texel_size_m = NAN}).find("texel_size_m"), std::string::npos);
    EXPECT_NE(error_of(cube, {.padding_texels = 65}).find("padding_texels"), std::string::npos);
    EXPECT_NE(error_of(cube, {.max_page_texels = 8}).find("max_page_texels"), std::string::npos);
    EXPECT_NE(error_of(cube, {.chart_normal_deg = 61}).find("chart_normal_deg"), std::string::npos);
    EXPECT_NE(error_of(Scene(), {}).find("no triangles with an area"), std::string::npos);
    const Scene lines = scene_of({soup({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}})});
    EXPECT_NE(error_of(lines, {}).find("no triangles with an area"), std::string::npos);
}

class Canceller : public Progress {
public:
    bool cancelled() const override { return true; }
};

TEST(Atlas, CanBeCancelled) {
    const Scene scene = scene_of({unit_cube()});
    const Atlas atlas = make_atlas(scene);
    Canceller canceller;
    const auto expect_cancelled = [](const auto& call) {
        try {
            call();
            ADD_FAILURE() << "went on";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::cancelled);
        }
    };
    expect_cancelled([&] { make_atlas(scene, {}, canceller); });
    expect_cancelled([&] { make_texels(scene, atlas, canceller); });
}

}  // namespace
}  // namespace gnomon::lightmap
