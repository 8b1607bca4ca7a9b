#include "bake/texel_edges.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace gnomon::bake {
namespace {

/// Edges can be 200 codes apart, and what is shorter than 25 is short.
constexpr double kPathCodes = 3200.0;

struct Span {
    std::uint16_t rise, fall;
};

/// Of 2 x 2 texels with their intervals.
IntervalPage page_of(const std::array<std::vector<Span>, 4>& texels) {
    IntervalPage page{.side_texels = 2, .pairs = 1, .rises = {}, .falls = {}};
    page.rises.assign(16, IntervalPage::kNoRise);
    page.falls.assign(16, 0);
    for (std::size_t i = 0; i < texels.size(); ++i) {
        for (std::size_t k = 0; k < texels[i].size(); ++k) {
            page.rises[4 * i + k] = texels[i][k].rise;
            page.falls[4 * i + k] = texels[i][k].fall;
        }
    }
    return page;
}

double seen(const IntervalPage& page, double at, glm::dvec2 place = {0.5, 0.5}) {
    BetweenTexels between{.texels = {0, 1, 2, 3}, .path_codes = kPathCodes};
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::dvec2 apart = glm::dvec2(i % 2, i / 2) - place;
        between.places_texels[i] = apart;
        between.weights[i] = (1.0 - std::abs(apart.x)) * (1.0 - std::abs(apart.y));
    }
    return edges_visibility(page, between, {.at_step = at, .width_steps = 4.0, .even = true});
}

// What only mixes results has two halves of an edge here, at 100 and at 200, where there is one.
TEST(TexelEdges, AnEdgePassesBetweenTexelsBetweenTheirTimes) {
    const IntervalPage page = page_of({{{{100, 900}}, {{200, 900}}, {{100, 900}}, {{200, 900}}}});
    EXPECT_DOUBLE_EQ(seen(page, 140), 0.0);
    EXPECT_DOUBLE_EQ(seen(page, 150), 0.5);
    EXPECT_DOUBLE_EQ(seen(page, 160), 1.0);
    EXPECT_DOUBLE_EQ(seen(page, 125, {0.25, 0.5}), 0.5);
    EXPECT_DOUBLE_EQ(seen(page, 100, {0.0, 0.0}), 0.5);
}

// A pole's shadow that is a tenth as wide as it moves from texel to texel is as wide between them.
TEST(TexelEdges, AThinShadowStaysWholeBetweenTexels) {
    const IntervalPage page = page_of({{{{0, 100}, {110, 900}},
                                        {{0, 200}, {210, 900}},
                                        {{0, 100}, {110, 900}},
                                        {{0, 200}, {210, 900}}}});
    EXPECT_DOUBLE_EQ(seen(page, 105), 1.0);
    EXPECT_DOUBLE_EQ(seen(page, 155), 0.0);
    EXPECT_DOUBLE_EQ(seen(page, 205), 1.0);
}

TEST(TexelEdges, WhatOnlySomeTexelsHaveFades) {
    const IntervalPage page =
        page_of({{{{0, 900}}, {{0, 300}, {500, 900}}, {{0, 900}}, {{0, 900}}}});
    EXPECT_DOUBLE_EQ(seen(page, 100), 1.0);
    EXPECT_DOUBLE_EQ(seen(page, 400), 0.75);
    EXPECT_DOUBLE_EQ(seen(page, 600), 1.0);
    EXPECT_DOUBLE_EQ(seen(page_of({{{}, {{0, 900}}, {}, {{0, 900}}}}), 400), 0.5);
    EXPECT_DOUBLE_EQ(seen(page_of({}), 400), 0.0);
}

TEST(TexelEdges, AreTheSameWhenEachIsTheOthersNearest) {
    const auto same = [](const std::array<std::vector<Span>, 4>& texels) {
        return have_same_edges(page_of(texels), {0, 1, 2, 3}, kPathCodes);
    };
    EXPECT_TRUE(same({}));
    EXPECT_TRUE(same({{{{100, 300}}, {{150, 280}}, {{210, 290}}, {{100, 300}}}}));
    EXPECT_FALSE(same({{{{100, 300}}, {{100, 300}}, {}, {{100, 300}}}}));
    EXPECT_FALSE(same({{{{0, 900}}, {{0, 900}}, {{0, 699}}, {{0, 900}}}})) << "far apart";
    EXPECT_FALSE(same({{{{0, 900}}, {{0, 300}, {325, 900}}, {{0, 900}}, {{0, 900}}}}));
    EXPECT_TRUE(same({{{{0, 900}}, {{0, 300}, {324, 900}}, {{0, 900}}, {{0, 900}}}}))
        << "dark for 24 codes only";
    EXPECT_TRUE(same({{{}, {{300, 324}}, {}, {}}})) << "lit for 24 codes only";
}

// The sun goes along x over a plane whose unit is a texel: an edge that lies across its path takes
// the disc's own width to pass, and one that lies at 60 degrees to that twice as long.
TEST(TexelEdges, ObliqueEdgesTakeLongerToCrossTheDisc) {
    const DVec3 along(1, 0, 0);
    const DVec3 across(0, 0, 1);
    BetweenTexels between{
        .texels = {0, 1, 2, 3}, .weights = {0.25, 0.25, 0.25, 0.25}, .path_codes = kPathCodes};
    between.normal_from_slope = normal_from_slope({1, 0, 0}, {0, 0, 1}, along, across);
    for (std::size_t i = 0; i < 4; ++i)
        between.places_texels[i] = glm::dvec2(i % 2, i / 2) - 0.5;
    // Times fall towards the sun. At a quarter of the disc's width an edge hides this much.
    const double quarter = 0.5 + (0.5 * std::sqrt(0.75) + std::asin(0.5)) / std::numbers::pi;
    const auto rising = [&](double down, double at) {
        std::array<std::vector<Span>, 4> texels;
        for (std::size_t i = 0; i < 4; ++i) {
            const glm::dvec2 place = between.places_texels[i];
            texels[i] = {
                {static_cast<std::uint16_t>(std::lround(500.0 - 50.0 * (place.x + down * place.y))),
                 900}};
        }
        return edges_visibility(page_of(texels), between, {.at_step = at, .width_steps = 40.0});
    };
    EXPECT_NEAR(rising(0.0, 510.0), quarter, 1e-6);
    EXPECT_NEAR(rising(std::sqrt(3.0), 520.0), quarter, 2e-3) << "times are whole codes";
    EXPECT_NEAR(rising(-std::sqrt(3.0), 520.0), quarter, 2e-3);
}

// Lit over both ends of a path of 24 hours, but for what a wall darkens: there is no edge at the
// ends, and edges near them are where they were.
TEST(TexelEdges, GoOnOverTheEndsOfAClosedPath) {
    const auto path = static_cast<std::uint16_t>(kPathCodes);
    const std::vector<Span> lit = {{0, path}};
    const std::vector<Span> dark_at_noon = {{0, 1500}, {1700, path}};
    const std::vector<Span> dark_at_begin = {{8, path}};
    const auto seen = [&](const std::vector<Span>& spans, double at) {
        BetweenTexels between{
            .texels = {0, 1, 2, 3},
            .weights = {0.25, 0.25, 0.25, 0.25},
            .places_texels = {glm::dvec2(-0.5), {0.5, -0.5}, {-0.5, 0.5}, {0.5, 0.5}},
            .path_codes = kPathCodes};
        return edges_visibility(page_of({spans, spans, spans, spans}), between,
                                {.at_step = at,
                                 .width_steps = 32.0,
                                 .even = true,
                                 .ends = {.path_steps = kPathCodes, .closed = true}});
    };
    for (const double at : {0.0, 5.0, kPathCodes - 5.0, kPathCodes}) {
        EXPECT_DOUBLE_EQ(seen(lit, at), 1.0) << at;
        EXPECT_DOUBLE_EQ(seen(dark_at_noon, at), 1.0) << at;
    }
    EXPECT_DOUBLE_EQ(seen(dark_at_begin, 0.0), 0.75);
    EXPECT_DOUBLE_EQ(seen(dark_at_begin, kPathCodes), 0.75);
}

}  // namespace
}  // namespace gnomon::bake
