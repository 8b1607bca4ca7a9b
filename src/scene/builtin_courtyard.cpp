/// A paved court: an arcade at the back, a terrace with stairs and thin railings on the left, a
/// tree of alpha-masked leaves in the middle, benches and urns.

#include "scene/builtin.h"
#include "scene/builtin_plants.h"
#include "scene/shapes.h"

#include <cmath>

namespace gnomon::scene {

namespace {

constexpr float kCourtHalfM = 10.0f;
constexpr float kWallThicknessM = 0.6f;
constexpr float kWallHeightM = 4.7f;
constexpr float kIntoWallM = 0.2f;  // how far things that touch the wall reach into it

constexpr int kArches = 7;
constexpr float kBayM = 2.0f * kCourtHalfM / kArches;
constexpr float kArchRadiusM = 1.12f;
constexpr float kSpringingM = 2.55f;  // height where the arches begin
constexpr float kArcadeZM = -7.0f;
constexpr float kArcadeTopM = 4.3f;

// The terrace's corner towards the court, and its floor.
constexpr float kTerraceXM = -6.4f;
constexpr float kTerraceMinZM = -3.2f;
constexpr float kTerraceMaxZM = 2.6f;
constexpr float kStepHeightM = 0.15f;
constexpr float kStepDepthM = 0.30f;
constexpr int kSteps = 7;  // of the stairs; the terrace's edge is the last
constexpr float kTerraceHeightM = kStepHeightM * (kSteps + 1);
constexpr float kStairsMinXM = -9.6f;
constexpr float kStairsMaxXM = -7.4f;

constexpr float kRailHeightM = 1.0f;
constexpr float kRailRadiusM = 0.025f;
constexpr float kBalusterRadiusM = 0.010f;
constexpr float kBalusterPitchM = 0.14f;

constexpr Vec3 kTree{1.2f, 0.0f, -0.6f};

Mesh column() {
    return lathe({{0.0f, -kSunkM},
                  {0.30f, -kSunkM},
                  {0.30f, 0.12f},
                  {0.26f, 0.18f},
                  {0.26f, 0.24f},
                  {0.20f, 0.30f},
                  {0.19f, 1.2f},
                  {0.165f, 2.26f},
                  {0.20f, 2.32f},
                  {0.29f, 2.48f},
                  {0.29f, kSpringingM + 0.03f},
                  {0.0f, kSpringingM + 0.03f}},
                 28);
}

/// The wall over the columns, with its arches.
Mesh arcade() {
    constexpr int kArchPoints = 20;
    const float half_width_m = kCourtHalfM + kIntoWallM;
    const std::vector<Vec2> circle = unit_circle(2 * kArchPoints);
    std::vector<Vec2> outline{{-half_width_m, kSpringingM}};
    for (int bay = 0; bay < kArches; ++bay) {
        const float x = -kCourtHalfM + kBayM * (static_cast<float>(bay) + 0.5f);
        for (int i = kArchPoints; i >= 0; --i) {
            const Vec2 c = circle[static_cast<std::size_t>(i)];
            // The ends of a half circle in float may lie a hair off the springing.
            const float y = i == 0 || i == kArchPoints ? 0.0f : kArchRadiusM * c.y;
            outline.emplace_back(x + kArchRadiusM * c.x, kSpringingM + y);
        }
    }
    outline.emplace_back(half_width_m, kSpringingM);
    outline.emplace_back(half_width_m, kArcadeTopM);
    outline.emplace_back(-half_width_m, kArcadeTopM);
    return extrude(outline, kArcadeZM - 0.22f, kArcadeZM + 0.22f);
}

/// Rising towards -Z, into the terrace.
Mesh stairs() {
    const float overlap_m = 0.05f;
    // The profile in (-z, y), extruded along x.
    const float start = -kTerraceMaxZM - kStepDepthM * kSteps;
    const float foot = -2.0f * kSunkM;
    std::vector<Vec2> outline{{start, foot}, {-kTerraceMaxZM + overlap_m, foot}};
    for (int step = kSteps; step >= 1; --step) {
        const float y = kStepHeightM * static_cast<float>(step);
        const float end = step == kSteps ? -kTerraceMaxZM + overlap_m
                                         : start + kStepDepthM * static_cast<float>(step);
        outline.emplace_back(end, y);
        outline.emplace_back(start + kStepDepthM * static_cast<float>(step - 1), y);
    }
    // (x, y, z) = (extrusion, y, -profile x): profile x becomes -z when turned about Y by 90°.
    return moved(extrude(outline, kStairsMinXM, kStairsMaxXM), rotation_y(0.5f * kPi));
}

/// A handrail and a lower rail from `a` to `b` at the height of the floor, with thin balusters.
void append_railing(Mesh& mesh, Vec3 a, Vec3 b) {
    constexpr float kLowRailM = 0.12f;
    const Vec3 up(0.0f, 1.0f, 0.0f);
    const Vec3 along = normalize(b - a);
    const Vec3 overhang = 0.06f * along;
    append(mesh, tube({a + kRailHeightM * up - overhang, b + kRailHeightM * up + overhang},
                      kRailRadiusM, 10));
    append(mesh, tube({a + kLowRailM * up, b + kLowRailM * up}, 0.6f * kRailRadiusM, 8));
    const int count = static_cast<int>(std::lround(glm::length(b - a) / kBalusterPitchM));
    for (int i = 0; i <= count; ++i) {
        const Vec3 foot = a + (b - a) * (static_cast<float>(i) / static_cast<float>(count));
        const bool post = i == 0 || i == count;
        append(mesh, moved(cylinder(post ? kRailRadiusM : kBalusterRadiusM,
                                    post ? -0.05f : 0.5f * kLowRailM, kRailHeightM, post ? 10 : 6),
                           foot));
    }
}

Mesh railings() {
    constexpr float kFromEdgeM = 0.12f;
    const float x = kTerraceXM - kFromEdgeM;
    const float front = kTerraceMaxZM - kFromEdgeM;
    const float back = kTerraceMinZM + kFromEdgeM;
    const float y = kTerraceHeightM;
    Mesh mesh;
    append_railing(mesh, {x, y, front}, {x, y, back});
    append_railing(mesh, {x - 0.14f, y, back}, {-kCourtHalfM + 0.1f, y, back});
    append_railing(mesh, {x - 0.14f, y, front}, {kStairsMaxXM + 0.2f, y, front});
    // Down the stairs, from the top step's middle to the lowest one's.
    const float top_z = kTerraceMaxZM + 0.5f * kStepDepthM;
    const Vec3 rise(0.0f, kStepHeightM * (kSteps - 1), -kStepDepthM * (kSteps - 1));
    const Vec3 low(kStairsMaxXM - 0.1f, kStepHeightM, top_z + kStepDepthM * (kSteps - 1));
    append_railing(mesh, low, low + rise);
    return mesh;
}

Mesh bench() {
    Mesh mesh;
    for (int slat = 0; slat < 4; ++slat) {
        const float z = -0.21f + 0.14f * static_cast<float>(slat);
        append(mesh, centered_box({0.0f, 0.45f, z}, {1.8f, 0.03f, 0.10f}));
    }
    for (int slat = 0; slat < 3; ++slat) {
        const float y = 0.60f + 0.14f * static_cast<float>(slat);
        append(mesh, centered_box({0.0f, y, -0.27f}, {1.8f, 0.10f, 0.03f}));
    }
    for (const float x : {-0.7f, 0.7f}) {
        append(mesh, box({x - 0.03f, 0.36f, -0.25f}, {x + 0.03f, 0.445f, 0.24f}));
        append(mesh, box({x - 0.025f, -kSunkM, 0.16f}, {x + 0.025f, 0.40f, 0.21f}));
        append(mesh, box({x - 0.025f, -kSunkM, -0.275f}, {x + 0.025f, 0.95f, -0.235f}));
    }
    return mesh;
}

Mesh urn() {
    return lathe({{0.0f, -kSunkM},
                  {0.20f, -kSunkM},
                  {0.20f, 0.05f},
                  {0.10f, 0.12f},
                  {0.12f, 0.18f},
                  {0.30f, 0.42f},
                  {0.34f, 0.60f},
                  {0.30f, 0.78f},
                  {0.22f, 0.86f},
                  {0.27f, 0.94f},
                  {0.24f, 0.94f},
                  {0.18f, 0.86f},
                  {0.0f, 0.82f}},
                 32);
}

/// A round stone bed with earth in it.
Mesh planter() {
    return lathe({{0.0f, -kSunkM},
                  {1.15f, -kSunkM},
                  {1.15f, 0.36f},
                  {1.22f, 0.38f},
                  {1.22f, 0.46f},
                  {0.95f, 0.46f},
                  {0.95f, 0.36f},
                  {0.0f, 0.40f}},
                 48);
}

void add_tree(SceneBuilder& builder) {
    constexpr std::uint64_t kSeed = 11;
    const TreeSkeleton tree = tree_skeleton(kSeed, 5.4f, 22, 8);
    const std::uint32_t bark = builder.solid("bark", {0.20f, 0.14f, 0.09f});
    const std::uint32_t leaves = builder.material({
        .name = "leaves",
        .base_color_texture = builder.texture(leaf_texture()),
        .alpha_cutoff = 0.5f,
    });
    const Vec3 foot = kTree + Vec3(0.0f, 0.40f, 0.0f);
    builder.place("trunk", builder.mesh("trunk", tree.wood, bark), foot);
    builder.place("leaves",
                  builder.mesh("leaves", leaf_cards(tree.tips, kSeed, 420, 0.62f), leaves), foot);
}

void add_buildings(SceneBuilder& builder) {
    const std::uint32_t plaster = builder.solid("plaster", {0.62f, 0.50f, 0.36f});
    const std::uint32_t stone = builder.solid("limestone", {0.60f, 0.56f, 0.48f});
    const std::uint32_t tiles = builder.solid("roof", {0.42f, 0.18f, 0.11f});
    const std::uint32_t iron = builder.solid("iron", {0.06f, 0.07f, 0.07f}, 0.08f, 64.0f);

    const float outer = kCourtHalfM + kWallThicknessM;
    builder.add(
        "wall",
        rectangular_wall({-outer, -kSunkM, -outer}, {outer, kWallHeightM, outer}, kWallThicknessM),
        plaster);
    builder.add("coping",
                rectangular_wall({-outer - 0.06f, kWallHeightM - 0.04f, -outer - 0.06f},
                                 {outer + 0.06f, kWallHeightM + 0.12f, outer + 0.06f},
                                 kWallThicknessM + 0.12f),
                tiles);
    builder.add("arcade", arcade(), plaster);
    const float roof_half = kCourtHalfM + 0.5f * kIntoWallM;
    builder.add("arcade roof",
                box({-roof_half, kArcadeTopM - 0.04f, -kCourtHalfM - kIntoWallM},
                    {roof_half, kArcadeTopM + 0.16f, kArcadeZM + 0.45f}),
                tiles);
    const std::uint32_t column_mesh = builder.mesh("column", column(), stone);
    for (int i = 1; i < kArches; ++i) {
        builder.place(numbered("column", i), column_mesh,
                      Vec3(-kCourtHalfM + kBayM * static_cast<float>(i), 0.0f, kArcadeZM));
    }
    builder.add("terrace",
                box({-kCourtHalfM - kIntoWallM, -3.0f * kSunkM, kTerraceMinZM},
                    {kTerraceXM, kTerraceHeightM, kTerraceMaxZM}),
                stone);
    builder.add("stairs", stairs(), stone);
    builder.add("railings", railings(), iron);
    builder.place("planter", builder.mesh("planter", planter(), stone), kTree);
}

void add_furniture(SceneBuilder& builder) {
    const std::uint32_t bench_mesh =
        builder.mesh("bench", bench(), builder.solid("teak", {0.34f, 0.19f, 0.09f}));
    const std::uint32_t urn_mesh =
        builder.mesh("urn", urn(), builder.solid("terracotta", {0.48f, 0.19f, 0.10f}));
    struct Placement {
        Vec3 position;
        float turn_rad;
    };
    const Placement benches[] = {{{-2.4f, 0.0f, 3.6f}, radians(150.0f)},
                                 {{4.3f, 0.0f, -3.2f}, radians(-40.0f)},
                                 {{-1.2f, 0.0f, -9.3f}, 0.0f},
                                 {{9.3f, 0.0f, -1.0f}, radians(-90.0f)}};
    int number = 0;
    for (const Placement& p : benches) {
        builder.place(numbered("bench", ++number), bench_mesh,
                      translation(p.position) * rotation_y(p.turn_rad));
    }
    number = 0;
    for (const Vec3 p : {Vec3(-5.6f, 0.0f, 3.2f), Vec3(-5.5f, 0.0f, -4.0f), Vec3(5.6f, 0.0f, -5.6f),
                         Vec3(8.8f, 0.0f, -5.9f)}) {
        builder.place(numbered("urn", ++number), urn_mesh, p);
    }
}

}  // namespace

Scene courtyard_scene() {
    SceneBuilder builder("courtyard");
    const std::uint32_t paving = builder.material({
        .name = "paving",
        .base_color_texture = builder.texture(paving_texture()),
        .uv_scale_rotation = glm::mat2(0.5f),  // a tile is 2 m
    });
    builder.add("paving", ground(Vec2(-11.0f), Vec2(11.0f)), paving);
    add_buildings(builder);
    add_tree(builder);
    add_furniture(builder);
    builder.light(sun(radians(36.0f), radians(142.0f)));
    builder.camera({6.6f, 3.0f, 7.6f}, {-2.1f, 1.65f, -2.6f}, radians(50.0f), 0.1f);
    return std::move(builder).scene();
}

}  // namespace gnomon::scene
