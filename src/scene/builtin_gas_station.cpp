/// A gas station: thin and thick things, high and low, at once: a canopy on posts over pumps with
/// hoses, a kiosk with a ladder, a car under a tarp, power lines whose shadows cross it all.

#include "scene/builtin.h"
#include "scene/shapes.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::scene {

namespace {

constexpr float kGroundHalfM = 30.0f;
constexpr float kCanopyBottomM = 4.6f;
constexpr float kIslandXM = 3.2f;  // two islands, at -x and +x, along z
constexpr float kPostZM = 2.3f;
constexpr float kPumpZM = 0.95f;
constexpr float kIslandTopM = 0.14f;

constexpr float kPoleXM = -10.0f;  // the power line runs along z
constexpr float kPoleHeightM = 8.5f;
constexpr float kPolePitchM = 17.0f;
constexpr int kPoles = 4;
constexpr float kFirstPoleZM = -1.5f * kPolePitchM + 2.0f;
constexpr float kArmYM = kPoleHeightM - 0.6f;
constexpr float kWireYM = kArmYM + 0.24f;
constexpr float kWireRadiusM = 0.012f;

struct Materials {
    std::uint32_t white, red, concrete, steel, rubber, glass, wood, plaster, roof;
};

Materials make_materials(SceneBuilder& builder) {
    return {.white = builder.solid("white paint", {0.66f, 0.66f, 0.63f}, 0.05f, 48.0f),
            .red = builder.solid("red paint", {0.46f, 0.07f, 0.05f}, 0.05f, 48.0f),
            .concrete = builder.solid("concrete", {0.42f, 0.41f, 0.39f}),
            .steel = builder.solid("steel", {0.36f, 0.38f, 0.40f}, 0.15f, 64.0f),
            .rubber = builder.solid("rubber", {0.03f, 0.03f, 0.03f}),
            .glass = builder.solid("glass", {0.05f, 0.07f, 0.08f}, 0.10f, 128.0f),
            .wood = builder.solid("wood", {0.22f, 0.16f, 0.11f}),
            .plaster = builder.solid("plaster", {0.52f, 0.50f, 0.42f}),
            .roof = builder.solid("roof", {0.24f, 0.26f, 0.27f})};
}

void add_canopy(SceneBuilder& builder, const Materials& m) {
    builder.add("canopy", box({-6.4f, kCanopyBottomM, -3.9f}, {6.4f, kCanopyBottomM + 0.35f, 3.9f}),
                m.white);
    builder.add("fascia",
                rectangular_wall({-6.5f, kCanopyBottomM - 0.1f, -4.0f},
                                 {6.5f, kCanopyBottomM + 0.7f, 4.0f}, 0.15f),
                m.red);
    const std::uint32_t post = builder.mesh(
        "post", cylinder(0.13f, 0.5f * kIslandTopM, kCanopyBottomM + 0.1f, 28), m.white);
    const std::uint32_t island = builder.mesh(
        "island", box({-0.65f, -kSunkM, -2.8f}, {0.65f, kIslandTopM, 2.8f}), m.concrete);
    int number = 0;
    for (const float x : {-kIslandXM, kIslandXM}) {
        builder.place(numbered("island", x < 0.0f ? 1 : 2), island, Vec3(x, 0.0f, 0.0f));
        for (const float z : {-kPostZM, kPostZM})
            builder.place(numbered("post", ++number), post, Vec3(x, 0.0f, z));
    }
}

/// The hose hangs from the pump's head to the nozzle in its side.
Mesh hose() {
    std::vector<Vec3> path;
    constexpr int kPoints = 20;
    for (int i = 0; i <= kPoints; ++i) {
        const float t = static_cast<float>(i) / kPoints;
        const float sag = 4.0f * t * (1.0f - t);
        path.emplace_back(0.30f + 0.22f * sag, 1.55f - 0.55f * t - 0.55f * sag, 0.16f - 0.32f * t);
    }
    Mesh mesh = tube(path, 0.018f, 8);
    append(mesh,
           tube({{0.27f, 1.06f, -0.16f}, {0.32f, 1.0f, -0.16f}, {0.38f, 0.96f, -0.16f}}, 0.03f, 8));
    return mesh;
}

void add_pumps(SceneBuilder& builder, const Materials& m) {
    Mesh body = box({-0.30f, -kSunkM, -0.24f}, {0.30f, 1.30f, 0.24f});
    append(body, box({-0.36f, 1.48f, -0.28f}, {0.36f, 1.72f, 0.28f}));
    Mesh face = box({-0.27f, 1.28f, -0.20f}, {0.27f, 1.50f, 0.20f});  // the neck
    append(face, box({-0.22f, 0.72f, -0.255f}, {0.22f, 1.20f, 0.255f}));
    const std::uint32_t body_mesh = builder.mesh("pump", std::move(body), m.red);
    const std::uint32_t face_mesh = builder.mesh("pump face", std::move(face), m.glass);
    const std::uint32_t hose_mesh = builder.mesh("hose", hose(), m.rubber);
    int number = 0;
    for (const float x : {-kIslandXM, kIslandXM}) {
        for (const float z : {-kPumpZM, kPumpZM}) {
            ++number;
            const Mat4 place = translation({x, kIslandTopM, z}) * rotation_y(x < 0.0f ? kPi : 0.0f);
            builder.place(numbered("pump", number), body_mesh, place);
            builder.place(numbered("pump face", number), face_mesh, place);
            builder.place(numbered("hose", number), hose_mesh, place);
        }
    }
}

/// Against the kiosk's front, which is the plane z = 0; its feet stand at z > 0.
Mesh ladder() {
    constexpr float kHeightM = 3.9f;
    constexpr float kFootM = 1.1f;  // distance of the feet from the wall
    constexpr float kHalfWidthM = 0.22f;
    constexpr int kRungs = 12;
    const Vec3 foot(0.0f, -kSunkM, kFootM);
    const Vec3 top(0.0f, kHeightM, -0.05f);
    Mesh mesh;
    for (const float x : {-kHalfWidthM, kHalfWidthM})
        append(mesh, tube({foot + Vec3(x, 0, 0), top + Vec3(x, 0, 0)}, 0.025f, 10));
    for (int i = 1; i <= kRungs; ++i) {
        const Vec3 p = glm::mix(foot, top, static_cast<float>(i) / (kRungs + 1));
        append(mesh, tube({p - Vec3(kHalfWidthM, 0, 0), p + Vec3(kHalfWidthM, 0, 0)}, 0.014f, 8));
    }
    return mesh;
}

void add_kiosk(SceneBuilder& builder, const Materials& m) {
    constexpr float kFrontZM = -8.0f;
    constexpr float kProudM = 0.03f;
    builder.add("kiosk", box({-4.5f, -kSunkM, kFrontZM - 4.5f}, {4.5f, 3.1f, kFrontZM}), m.plaster);
    builder.add("kiosk roof", box({-5.0f, 3.05f, kFrontZM - 5.0f}, {5.0f, 3.3f, kFrontZM + 0.7f}),
                m.roof);
    Mesh panes;
    for (const float x : {-3.0f, -0.9f}) {
        append(panes,
               box({x - 0.95f, 0.9f, kFrontZM - 0.1f}, {x + 0.95f, 2.5f, kFrontZM + kProudM}));
    }
    append(panes, box({1.0f, 0.05f, kFrontZM - 0.1f}, {2.1f, 2.3f, kFrontZM + kProudM}));  // door
    builder.add("kiosk panes", std::move(panes), m.glass);
    // Leans on the eaves.
    builder.add("ladder", moved(ladder(), Vec3(3.2f, 0.0f, kFrontZM + 0.72f)), m.steel);
    Mesh tyres;
    for (int i = 0; i < 4; ++i) {
        const float shift = i % 2 == 0 ? 0.02f : -0.02f;
        append(tyres, moved(torus(0.24f, 0.10f, 32, 12),
                            translation({shift, 0.09f + 0.185f * static_cast<float>(i), shift}) *
                                rotation_x(shift)));
    }
    builder.add("tyres", moved(std::move(tyres), Vec3(4.4f, 0.0f, kFrontZM + 0.9f)), m.rubber);
}

/// 0 outside a box's edge, 1 within, over `soft_m`.
float plateau(float distance_inside_m, float soft_m) {
    return glm::smoothstep(-soft_m, soft_m, distance_inside_m);
}

/// Height of a tarp over a car that stands along x, in its own space.
float tarp_height_m(float x, float z) {
    constexpr float kHemM = 0.03f;
    const float body =
        0.86f * plateau(2.12f - std::abs(x), 0.22f) * plateau(0.88f - std::abs(z), 0.16f);
    const float roof_front = 0.75f - x;
    const float roof_back = x + 1.65f;
    const float cabin = 0.52f * plateau(std::min(roof_front, roof_back), 0.5f) *
                        plateau(0.70f - std::abs(z), 0.18f);
    // Folds hang from the edge of the body and die out on it and on the ground.
    const float slope = body / 0.86f;
    const float folds = 0.16f * slope * (1.0f - slope) *
                        std::sin(11.0f * x + 2.0f * std::sin(3.0f * z)) * std::cos(9.0f * z);
    return kHemM + body + cabin * slope + folds;
}

void add_car(SceneBuilder& builder) {
    constexpr int kCellsX = 110;
    constexpr int kCellsZ = 56;
    const std::uint32_t cloth = builder.sheet("tarp", {0.20f, 0.28f, 0.36f});
    const std::uint32_t mesh = builder.mesh(
        "tarp", height_field({-2.5f, -1.2f}, {2.5f, 1.2f}, kCellsX, kCellsZ, tarp_height_m), cloth);
    builder.place("car under a tarp", mesh,
                  translation({7.7f, 0.0f, 3.6f}) * rotation_y(radians(38.0f)));
}

Mesh pole() {
    Mesh mesh = lathe({{0.0f, -0.2f},
                       {0.16f, -0.2f},
                       {0.10f, kPoleHeightM - 0.06f},
                       {0.06f, kPoleHeightM},
                       {0.0f, kPoleHeightM}},
                      16);
    append(mesh, centered_box({0.0f, kArmYM, 0.0f}, {2.4f, 0.12f, 0.10f}));
    return mesh;
}

Mesh insulator() {
    return lathe({{0.0f, -0.02f},
                  {0.02f, -0.02f},
                  {0.02f, 0.08f},
                  {0.05f, 0.09f},
                  {0.05f, 0.13f},
                  {0.025f, 0.15f},
                  {0.04f, 0.19f},
                  {0.0f, 0.20f}},
                 10);
}

/// One span, from z = 0 to the next pole: y = a cosh(z / a), hung from both ends.
Mesh wire() {
    constexpr int kPoints = 33;
    constexpr float kCatenaryM = 60.0f;  // tension over weight per length: a sag of 0.6 m
    const auto height_m = [](float z) { return kCatenaryM * std::cosh(z / kCatenaryM); };
    const float half_m = 0.5f * kPolePitchM;
    std::vector<Vec3> path;
    for (int i = 0; i < kPoints; ++i) {
        const float z = kPolePitchM * static_cast<float>(i) / (kPoints - 1) - half_m;
        path.emplace_back(0.0f, height_m(z) - height_m(half_m), z + half_m);
    }
    return tube(path, kWireRadiusM, 8);
}

void add_power_line(SceneBuilder& builder, const Materials& m) {
    const std::uint32_t pole_mesh = builder.mesh("pole", pole(), m.wood);
    const std::uint32_t insulator_mesh = builder.mesh("insulator", insulator(), m.white);
    const std::uint32_t wire_mesh = builder.mesh("wire", wire(), m.rubber);
    int count = 0;
    for (int i = 0; i < kPoles; ++i) {
        const float z = kFirstPoleZM + kPolePitchM * static_cast<float>(i);
        builder.place(numbered("pole", i + 1), pole_mesh, Vec3(kPoleXM, 0.0f, z));
        for (const float x : {-1.05f, 0.45f, 1.05f}) {
            ++count;
            builder.place(numbered("insulator", count), insulator_mesh,
                          Vec3(kPoleXM + x, kArmYM + 0.06f, z));
            if (i + 1 == kPoles) continue;
            builder.place(numbered("wire", count), wire_mesh, Vec3(kPoleXM + x, kWireYM, z));
        }
    }
}

void add_sign(SceneBuilder& builder, const Materials& m) {
    const Mat4 place = translation({-8.3f, 0.0f, 4.6f}) * rotation_y(radians(30.0f));
    Mesh posts;
    for (const float x : {-0.7f, 0.7f})
        append(posts, moved(cylinder(0.06f, -kSunkM, 5.6f, 16), Vec3(x, 0.0f, 0.0f)));
    Mesh boards = centered_box({0.0f, 4.9f, 0.0f}, {1.9f, 1.1f, 0.22f});
    for (const float y : {3.9f, 3.45f, 3.0f})
        append(boards, centered_box({0.0f, y, 0.0f}, {1.7f, 0.36f, 0.18f}));
    builder.place("sign posts", builder.mesh("sign posts", std::move(posts), m.steel), place);
    builder.place("sign", builder.mesh("sign", std::move(boards), m.red), place);
}

}  // namespace

Scene gas_station_scene() {
    SceneBuilder builder("gas-station");
    builder.add("ground", ground(Vec2(-kGroundHalfM), Vec2(kGroundHalfM)),
                builder.sheet("asphalt", {0.21f, 0.21f, 0.22f}));
    const Materials materials = make_materials(builder);
    add_canopy(builder, materials);
    add_pumps(builder, materials);
    add_kiosk(builder, materials);
    add_car(builder);
    add_power_line(builder, materials);
    add_sign(builder, materials);
    builder.light(sun(radians(38.0f), radians(228.0f)));
    builder.camera({5.4f, 2.9f, 16.4f}, {-0.2f, 2.3f, -1.0f}, radians(50.0f), 0.1f);
    return std::move(builder).scene();
}

}  // namespace gnomon::scene
