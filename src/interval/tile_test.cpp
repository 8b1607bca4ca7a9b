#include "interval/tile.h"

#include "interval/exact.h"
#include "interval/mask.h"
#include "interval/test_days.h"
#include "interval/walk.h"
#include "trace/test_scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace gnomon::interval {
namespace {

using trace::Receiver;

using Masks = std::vector<std::uint64_t>;

struct Case {
    Scene scene;
    Frame frame;
    std::vector<DVec3> day;
    std::vector<Receiver> receivers;
    bool ignore_alpha = false;
};

/// What every triangle says of every receiver and step, in double: no tree, no ranges, no float.
Masks by_brute_force(const Case& c) {
    const std::size_t words = (c.day.size() + 63) / 64;
    Masks masks(c.receivers.size() * words);
    for (std::size_t i = 0; i < c.receivers.size(); ++i) {
        for (std::size_t k = 0; k < c.day.size(); ++k) {
            const DVec3 to_sun = glm::normalize(c.day[k]);
            bool lit = glm::dot(DVec3(c.receivers[i].normal_ws), to_sun) > 0.0;
            for (std::uint32_t j = 0; lit && j < c.scene.instances().size(); ++j) {
                const Mesh& mesh = c.scene.meshes()[c.scene.instances()[j].mesh];
                for (std::uint32_t p = 0; lit && p < mesh.triangles.size(); ++p)
                    lit = !blocks(c.scene, c.ignore_alpha, {j, p}, c.receivers[i], to_sun);
            }
            masks[i * words + k / 64] |= std::uint64_t{lit} << (k % 64);
        }
    }
    return masks;
}

Masks by_tiles(const Case& c, int texels_per_tile) {
    Progress progress;
    const Tree tree(c.scene, c.frame, c.ignore_alpha, progress);
    const DayPath path(c.day, c.frame);
    TileTracer tracer(tree, path);
    Masks masks(c.receivers.size() * static_cast<std::size_t>(path.words()));
    tracer.trace(c.receivers, texels_per_tile, masks);
    return masks;
}

int differing(const Masks& a, const Masks& b) {
    int count = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        count += std::popcount(a[i] ^ b[i]);
    return count;
}

/// Tiles of all sizes say what brute force says, to the last bit.
void expect_exact(const Case& c, const std::string& what) {
    const Masks truth = by_brute_force(c);
    for (const int texels : {1, 2, 7, 16, 33, 64}) {
        EXPECT_EQ(differing(by_tiles(c, texels), truth), 0) << what << ", tiles of " << texels;
    }
}

/// `count` triangles of about `size` in [-reach, reach]³.
Mesh scattered(Random& random, int count, float reach, float size) {
    Mesh mesh;
    for (unsigned i = 0; i < static_cast<unsigned>(count); ++i) {
        const Vec3 corner = random.in_box(reach);
        mesh.positions.insert(mesh.positions.end(),
                              {corner, corner + random.in_box(size), corner + random.in_box(size)});
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return mesh;
}

constexpr double kTurn = 2.0 * std::numbers::pi;

TEST(TileTracer, SaysWhatBruteForceSays) {
    int lit = 0, all = 0;
    for (unsigned seed = 1; seed <= 12; ++seed) {
        Random random(seed);
        const Frame frame = frame_around(DVec3(random.in_box(1.0f)));
        const double declination = random.between(-1.3f, 1.3f);
        const double from = random.between(-3.0f, 1.0f);
        const double to = from + random.between(0.1f, 6.28f);
        const Mesh mesh = scattered(random, 300, 10.0f, 3.0f);
        const Vec3 u = random.in_box(2.0f), v = random.in_box(2.0f);
        Case c{trace::make_scene({{mesh}, {mesh, {trace::far_and_turned()}}}), frame,
               circle(frame, declination, from, to, 37 + 20 * static_cast<int>(seed)),
               receivers_on(random.in_box(5.0f), u, v, 8)};
        if (seed % 2 == 0) std::ranges::reverse(c.day);
        expect_exact(c, fmt::format("seed {}", seed));
        const Masks masks = by_tiles(c, 64);
        lit += lit_steps(masks);
        all += static_cast<int>(c.day.size() * c.receivers.size());
    }
    EXPECT_GT(lit, all / 20);  // the sun is behind half of the receivers all day
    EXPECT_LT(lit, all / 2);
}

/// Ground of texels 0.1 m wide among small triangles, all of it around a place.
struct Patch {
    std::vector<Mesh> casters;
    std::vector<Receiver> receivers;
};

Patch patch_at(Vec3 place, Random& random) {
    Patch patch{
        .casters = {scattered(random, 200, 3.0f, 0.5f)},
        .receivers = receivers_on(place - Vec3(0.4f, 0.0f, -0.4f), {0.8f, 0, 0}, {0, 0, -0.8f}, 8)};
    for (Vec3& p : patch.casters[0].positions)
        p += place;
    // On the ground itself, whose corners are far away.
    constexpr float kGround_m = 40.0f;
    patch.casters.push_back(trace::quad(place + Vec3(-kGround_m, 0, kGround_m),
                                        {2 * kGround_m, 0, 0}, {0, 0, -2 * kGround_m}));
    for (Receiver& receiver : patch.receivers)
        receiver.id = {1, 0};
    return patch;
}

// Floats are a millimetre apart at 10 km: what they cannot tell is much, and all of it is told.
TEST(TileTracer, TilesFarFromTheOrigin) {
    const Frame frame = frame_around(pole_at(0.84));
    for (const Vec3 place : {Vec3(10'000, 30, -7'000), Vec3(-10'000, 0, 0), Vec3(0, 0, 10'000)}) {
        Random random(5);
        const Patch patch = patch_at(place, random);
        const Case c{trace::make_scene({{patch.casters[0]}, {patch.casters[1]}}), frame,
                     circle(frame, 0.409, -1.9, 1.9, 200), patch.receivers};
        expect_exact(c, fmt::format("at {}, {}, {}", place.x, place.y, place.z));
        const int lit = lit_steps(by_tiles(c, 64));
        EXPECT_GT(lit, 1000);
        EXPECT_LT(lit, 200 * 64 - 1000);
    }
}

// Two kilometres of scene, whose boxes reach from one corner to the other, and a tile at a corner.
TEST(TileTracer, ATileAtTheCornerOfALargeScene) {
    const Frame frame = frame_around(pole_at(0.84));
    Random random(6);
    const Patch here = patch_at({1000, 0, 1000}, random);
    const Patch there = patch_at({-1000, 5, -1000}, random);
    // Towers that cast long shadows over all of it when the sun is low.
    const Mesh towers = [&] {
        Mesh mesh = scattered(random, 300, 1000.0f, 60.0f);
        for (Vec3& p : mesh.positions)
            p.y = 0.02f * std::abs(p.y);
        return mesh;
    }();
    const Case c{trace::make_scene({{here.casters[0]},
                                    {here.casters[1]},
                                    {there.casters[0]},
                                    {there.casters[1]},
                                    {towers}}),
                 frame, circle(frame, -0.2, -1.4, 1.4, 200), here.receivers};
    expect_exact(c, "at the corner");
    const int lit = lit_steps(by_tiles(c, 64));
    EXPECT_GT(lit, 1000);
    EXPECT_LT(lit, 200 * 64 - 1000);
}

TEST(TileTracer, SaysTheSameWithAnyInstructions) {
    Random random(11);
    const Frame frame = frame_around(pole_at(0.84));
    const Case c{trace::make_scene({{scattered(random, 300, 6.0f, 3.0f)}}), frame,
                 circle(frame, 0.3, -2.0, 2.0, 300),
                 receivers_on({-2, -1, 2}, {4, 0, 1}, {0, 0, -4}, 8)};
    // Leaves above the receivers, seen at few steps.
    const Case few{
        trace::make_scene({{scattered(random, 1500, 4.0f, 0.3f), {trace::moved({0, 6, 0})}}}),
        frame, circle(frame, 0.2, -0.9, 0.8, 20),
        receivers_on({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, 6)};
    const std::int64_t all = hwy::SupportedTargets();
    for (std::int64_t rest = walk_targets() & all; rest != 0; rest &= rest - 1) {
        const std::int64_t target = rest & -rest;
        hwy::GetChosenTarget().Update(target);
        expect_exact(c, hwy::TargetName(target));
        expect_exact(few, hwy::TargetName(target));
    }
    hwy::GetChosenTarget().Update(all);
}

TEST(TileTracer, LeavesSeenAtFewSteps) {
    // Small triangles over the receivers, at a few steps that are far apart beside them; the second
    // mesh touches the receivers' plane and reaches below it.
    for (unsigned seed = 1; seed <= 4; ++seed) {
        Random random(seed);
        const Mesh above = scattered(random, 1500, 4.0f, 0.3f);
        const Mesh around = scattered(random, 300, 4.0f, 0.3f);
        const Scene scene = trace::make_scene({{above, {trace::moved({0, 6, 0})}}, {around}});
        for (const int steps : {1, 3, 40}) {
            const Frame frame = frame_around(pole_at(0.84));
            expect_exact({scene, frame, circle(frame, 0.2, -0.9, 0.8, steps),
                          receivers_on({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, 6)},
                         fmt::format("seed {}, {} steps", seed, steps));
        }
    }
}

TEST(TileTracer, RaysAlongAxesAndTheSidesOfBoxes) {
    // Suns on the frame's axes and next to them, their coordinates 0 of both signs; receivers are
    // on lines along the axes through corners of walls, so that rays run in the sides of boxes.
    const Frame frame{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    std::vector<DVec3> day;
    for (const double x : {0.0, 1e-12, 1e-8}) {
        for (const double z : {-0.0, 1e-10, -1e-7, 0.5}) {
            day.insert(day.end(), {{x, 1, z}, {-x, 1, z}, {z, 1, -x}});
        }
    }
    std::vector<Mat4> places;
    for (int i = 0; i < 400; ++i) {
        const auto at = static_cast<float>(i);
        places.push_back(trace::moved(
            {std::fmod(at, 20.0f), 1.0f + std::fmod(at, 7.0f), std::floor(at / 20.0f)}));
    }
    const Scene scene =
        trace::make_scene({{trace::quad({0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0.5f}), places}});
    std::vector<Receiver> receivers;
    for (int i = 0; i < 80; ++i) {
        const auto at = static_cast<float>(i);
        receivers.push_back({{std::floor(at / 4.0f), 0, 0.5f * std::fmod(at, 4.0f)},
                             {0, 1, 0},
                             {trace::kNoSurface, 0}});
    }
    expect_exact({scene, frame, day, receivers}, "along axes");
}

TEST(TileTracer, EdgesRightAboveReceivers) {
    // A ceiling of a chessboard's squares, and receivers right below corners, edges and middles of
    // squares when the sun is overhead: float cannot tell whether it is hit.
    constexpr float kSide = 0.25f;
    Mesh ceiling;
    for (int i = 0; i < 400; ++i) {
        if ((i / 20 + i) % 2 == 0) continue;
        const auto x = static_cast<float>(i % 20), z = static_cast<float>(i / 20);
        const auto first = static_cast<unsigned>(ceiling.positions.size());
        for (const Vec3 corner : {Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(1, 0, 0)})
            ceiling.positions.push_back(kSide * (Vec3(x, 13.0f, z) + corner));
        ceiling.triangles.push_back({first, first + 1, first + 2});
        ceiling.triangles.push_back({first, first + 2, first + 3});
    }
    std::vector<Receiver> receivers;
    for (int i = 0; i < 256; ++i) {
        const Vec3 at(static_cast<float>(i % 16), 0.0f, static_cast<float>(i / 16));
        receivers.push_back({0.5f * kSide * at, {0, 1, 0}, {trace::kNoSurface, 0}});
    }
    const Case c{trace::make_scene({{ceiling}}), frame_around(pole_at(0.84)),
                 std::vector<DVec3>(5, DVec3(0.0, 1.0, 0.0)), receivers};
    expect_exact(c, "overhead");
    const int lit = lit_steps(by_tiles(c, 1));
    EXPECT_GT(lit, 0);
    EXPECT_LT(lit, 5 * 256);
}

/// A day of `steps` at the latitude of 48 degrees, on a scene with the Y axis up.
Case ordinary_day(Scene scene, std::vector<Receiver> receivers, int steps = 96,
                  double declination_rad = 0.4) {
    const Frame frame = frame_around(pole_at(0.84));
    return {std::move(scene), frame, circle(frame, declination_rad, -2.2, 2.2, steps),
            std::move(receivers)};
}

TEST(TileTracer, ReceiversOnTheCastersThemselves) {
    // Receivers that lie on the ground's own triangles, at feet of walls, in the planes of walls,
    // and on a corner where all coordinates are round: each is a tie that float alone would lose.
    const Mesh ground = trace::tiles(10);
    for (const Mat4& place : {Mat4(1.0f), trace::far_and_turned()}) {
        const glm::mat3 turn(place);
        const auto at = [&](Vec3 p) { return Vec3(place * Vec4(p, 1.0f)); };
        const Scene scene = trace::make_scene(
            {{ground, {place * glm::scale(Mat4(1.0f), Vec3(5.0f))}},
             {trace::cube(),
              {place * trace::moved({1, 1, 1}), place * trace::moved({-3, 0.5f, -2})}},
             {trace::quad({-2, 0, 2}, {4, 0, 0}, {0, 2, 0}), {place}}});
        std::vector<Receiver> receivers =
            receivers_on(at({-4, 0, 4}), turn * Vec3(8, 0, 0), turn * Vec3(0, 0, -8), 16);
        const std::vector<Receiver> walls =
            receivers_on(at({0, 0, 2}), turn * Vec3(2, 0, 0), turn * Vec3(0, 2, 0), 8);
        receivers.insert(receivers.end(), walls.begin(), walls.end());
        receivers.resize(256 + 64);
        receivers[3].id = {0, 7};  // its own triangle is known
        receivers[5] = {};         // no receiver
        Case c = ordinary_day(scene, receivers);
        Masks truth = by_brute_force(c);
        truth[5 * 2] = ~std::uint64_t{0};  // all is lit where there is none
        truth[5 * 2 + 1] = 0xffffffff;
        for (const int texels : {1, 16, 64})
            EXPECT_EQ(differing(by_tiles(c, texels), truth), 0) << "tiles of " << texels;
    }
}

/// Opaque columns, two texels apart.
Texture fence() {
    Texture texture;
    texture.size = {4, 1};
    texture.rgba = {0, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0, 255, 0, 0, 0, 0};
    return texture;
}

/// Of the first texture's holes.
Material with_holes() {
    Material material;
    material.base_color_texture = 0;
    material.alpha_cutoff = 0.5f;
    return material;
}

TEST(TileTracer, HolesLetLightThrough) {
    const Scene scene = trace::make_scene({{trace::quad({-3, 0, -1}, {6, 0, 0}, {0, 3, 0})}},
                                          with_holes(), {fence()});
    Case c = ordinary_day(scene, receivers_on({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, 8));
    expect_exact(c, "masked");
    const Masks masked = by_tiles(c, 64);
    c.ignore_alpha = true;
    expect_exact(c, "solid");
    EXPECT_GT(lit_steps(masked), lit_steps(by_tiles(c, 64)) + 100);
}

TEST(TileTracer, SmallHolesSeenAtFewSteps) {
    Random random(21);
    std::vector<Mat4> places;
    for (int i = 0; i < 300; ++i)
        places.push_back(trace::moved(Vec3(0, 5, 0) + random.in_box(3.0f)));
    const Scene scene = trace::make_scene(
        {{trace::quad({0, 0, 0}, {0.6f, 0, 0}, {0, 0.2f, 0.4f}), places}}, with_holes(), {fence()});
    Case c = ordinary_day(scene, receivers_on({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, 8), 40);
    expect_exact(c, "masked");
    const Masks masked = by_tiles(c, 1);
    c.ignore_alpha = true;
    expect_exact(c, "solid");
    EXPECT_GT(lit_steps(masked), lit_steps(by_tiles(c, 1)) + 100);
}

TEST(TileTracer, AnyPathAroundAnyPole) {
    Random random(5);
    const Scene scene = trace::make_scene({{scattered(random, 400, 8.0f, 3.0f)}});
    const std::vector<Receiver> receivers = receivers_on({-2, -1, 2}, {3, 1, 0}, {0, 1, -3}, 8);
    const Frame frame = frame_around(pole_at(1.2));
    const auto expect = [&](std::vector<DVec3> day, const std::string& what) {
        expect_exact({scene, frame, std::move(day), receivers}, what);
    };
    // A polar day that begins anywhere; half a day at the equinox; a circle close to the pole, and
    // one that goes past it.
    for (const double from : {-3.1, -1.0, 0.5, 3.0})
        expect(circle(frame, 0.4, from, from + kTurn, 101), fmt::format("polar day from {}", from));
    expect(circle(frame, 0.0, -1.5, 1.5, 64), "equinox");
    expect(circle(frame, -0.4, -1.2, 1.2, 1), "one step");
    expect(circle(frame, 1.569, -3.0, 3.0, 65), "at the pole");
    // Drift by half a degree, refraction at the ends, and the pole itself.
    std::vector<DVec3> day = circle(frame, 0.1, -1.7, 1.7, 128);
    for (std::size_t k = 0; k < day.size(); ++k) {
        const double end = std::abs(static_cast<double>(k) / 63.5 - 1.0);
        day[k] +=
            7e-5 * static_cast<double>(k) * frame.z_ws + DVec3(0, 0.01 * std::pow(end, 20), 0);
    }
    expect(day, "drifting");
    day[17] = frame.z_ws;
    expect(day, "the pole among others");
    expect(std::vector<DVec3>(66, frame.z_ws), "the pole alone");
    expect(std::vector<DVec3>(3, -frame.z_ws), "the other pole alone");
    std::vector<DVec3> anywhere(70);
    std::ranges::generate(anywhere, [&] { return DVec3(random.in_box(1.0f)); });
    expect(anywhere, "no order at all");
    expect(std::vector<DVec3>(66, DVec3(0.3, 1.0, 0.2)), "a sun that stands still");
}

TEST(TileTracer, SunsThatGrazeTheReceivers) {
    // Shadows are endless where the sun is in the receivers' plane. It comes as near as a
    // billionth, on both sides, over a square of receivers, a line of them, and all at one place.
    Random random(7);
    const Frame frame = frame_around(pole_at(0.84));
    std::vector<DVec3> day;
    for (int k = 0; k < 70; ++k) {
        const double azimuth = random.between(0.0f, 6.28f);
        const double height = (k % 4 == 0 ? -1.0 : 1.0) * std::pow(10.0, -0.13 * k);
        const bool is_tie = k % 2 == 0;
        day.emplace_back(is_tie ? 0.0 : std::cos(azimuth), height,
                         is_tie ? -1.0 : std::sin(azimuth));
    }
    std::vector<Receiver> receivers = receivers_on({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 8);
    for (int i = 0; i < 128; ++i) {
        receivers.push_back(receivers[0]);
        if (i < 64) receivers.back().position_ws.x += 0.01f * static_cast<float>(i);
    }
    Mesh mesh = scattered(random, 200, 4.0f, 1.0f);
    for (Vec3& position : mesh.positions)
        position.y *= 0.1f;
    Mesh walls;
    for (unsigned i = 0; i < 16; ++i) {
        const Vec3 foot(receivers[i / 2].position_ws.x, -0.1f,
                        -2.0f - 0.1f * static_cast<float>(i));
        const Vec3 beside(i % 2 == 0 ? 0.03f : -0.03f, 0.2f, 0.0f);
        walls.positions.insert(walls.positions.end(), {foot, foot + Vec3(0, 1, 0), foot + beside});
        walls.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    expect_exact({trace::make_scene({{mesh}}), frame, day, receivers}, "grazing");
    expect_exact({trace::make_scene({{walls}}), frame, day, receivers}, "grazing, ties");
}

TEST(TileTracer, PoleAndWallCastTheShadowsOfTrigonometry) {
    // On the ground south of a wall of height h that runs east and west for ever, the sun is behind
    // the wall while its shadow's length along north and south exceeds the distance to the wall.
    const float height = 3.0f, distance = 2.0f;
    const Scene scene =
        trace::make_scene({{trace::quad({-1e4f, 0, 0}, {2e4f, 0, 0}, {0, height, 0})}});
    // A receiver to the north of the wall: -Z is north, so the sun comes from +Z over the wall.
    const Receiver receiver{{0, 0, -distance}, {0, 1, 0}, {trace::kNoSurface, 0}};
    const Case c = ordinary_day(scene, {receiver}, 720, -0.3);
    const Masks masks = by_tiles(c, 1);
    for (int k = 0; k < 720; ++k) {
        const DVec3 d = c.day[static_cast<std::size_t>(k)];
        const bool over = d.y > 0.0 && d.z > 0.0;
        const bool dark = d.y <= 0.0 || (over && d.y * distance < d.z * height);
        EXPECT_EQ(is_lit(masks, k), !dark) << "step " << k;
    }
    const std::vector<Interval> lit = intervals(masks);
    EXPECT_EQ(lit.size(), 0u);  // the winter sun never rises above atan(3 / 2)
}

TEST(TileTracer, DegenerateTrianglesAreNotThere) {
    Random random(3);
    Mesh mesh = scattered(random, 50, 4.0f, 2.0f);
    const auto before = mesh.triangles.size();
    for (unsigned i = 0; i < 40; ++i) {
        mesh.triangles.push_back({3 * i, 3 * i, 3 * i + 1});
        mesh.triangles.push_back({3 * i + 2, 3 * i + 2, 3 * i + 2});
    }
    // Needles have an area, and hide as little.
    mesh.positions.insert(mesh.positions.end(), {{-3, 1, 0}, {3, 1, 0}, {0, 1.0000001f, 0}});
    mesh.triangles.push_back({150, 151, 152});
    const Scene scene = trace::make_scene({{mesh}});
    const Case c = ordinary_day(scene, receivers_on({-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, 8));
    expect_exact(c, "degenerate");
    Progress progress;
    EXPECT_EQ(Tree(scene, c.frame, false, progress).triangle_count(), before + 1);
}

TEST(TileTracer, WithoutTrianglesWhatFacesTheSunIsLit) {
    for (const Scene& scene : {Scene(), trace::make_scene({{Mesh{}}})}) {
        const Case c = ordinary_day(scene, receivers_on({0, 0, 0}, {1, 0, 0}, {0, 0, -1}, 3));
        expect_exact(c, "empty");
        EXPECT_GT(lit_steps(by_tiles(c, 64)), 0);
    }
}

TEST(TileTracer, CurvedChartsAndMixedNormals) {
    // Each receiver of a sphere has its own plane; some share a normal without sharing a plane.
    Random random(9);
    std::vector<Receiver> receivers;
    for (int i = 0; i < 40; ++i) {
        const Vec3 normal = glm::normalize(random.in_box(1.0f));
        receivers.push_back({2.0f * normal, normal, {trace::kNoSurface, 0}});
        receivers.push_back({random.in_box(2.0f), normal, {trace::kNoSurface, 0}});
        receivers.push_back({random.in_box(2.0f), normal, {trace::kNoSurface, 0}});
        receivers.push_back({random.in_box(2.0f), normal, {trace::kNoSurface, 0}});
    }
    expect_exact(ordinary_day(trace::make_scene({{scattered(random, 200, 6.0f, 3.0f)}}), receivers),
                 "curved");
}

}  // namespace
}  // namespace gnomon::interval
