/// A point light inside a carved pumpkin: the hard case of omnidirectional shadow maps, after
/// P. Gerasimov, "Omnidirectional shadow mapping", GPU Gems, 2004. Everything in the room is in
/// shadow but what the light reaches through the holes.

#include "scene/builtin.h"
#include "scene/builtin_carved_shell.h"
#include "scene/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::scene {

namespace {

constexpr float kRadiusM = 0.55f;
constexpr float kWallM = 0.05f;  // thickness of the shell
constexpr int kSides = 192;
constexpr int kRings = 96;

/// Ribbed, flattened and drawn in at both poles; ribs fade out towards them.
Vec3 pumpkin_surface(Vec3 direction) {
    constexpr int kRibs = 10;
    constexpr float kRibDepth = 0.04f;
    constexpr float kFlatness = 0.82f;
    constexpr float kDimple = 0.22f;
    const float horizontal = std::hypot(direction.x, direction.z);
    const float around = std::atan2(direction.z, direction.x);
    const float rib = kRibDepth * horizontal * std::cos(kRibs * around);
    const float y2 = direction.y * direction.y;
    const float r = kRadiusM * (1.0f + rib - kDimple * y2 * y2 * y2);
    return r * direction * Vec3(1.0f, kFlatness, 1.0f);
}

Vec3 inner_surface(Vec3 direction) {
    const Vec3 outer = pumpkin_surface(direction);
    return outer * (1.0f - kWallM / glm::length(outer));
}

/// Distance outside (> 0) or inside a convex polygon, counter-clockwise.
template <std::size_t N>
float polygon_distance(const std::array<Vec2, N>& corners, Vec2 p) {
    float distance = -1.0f;
    for (std::size_t i = 0; i < N; ++i) {
        const Vec2 along = glm::normalize(corners[(i + 1) % N] - corners[i]);
        distance = std::max(distance, glm::dot(p - corners[i], Vec2(along.y, -along.x)));
    }
    return distance;
}

/// The face in the tangent plane at +Z: x to the right as the pumpkin is looked at, y up.
float face_distance(Vec2 p) {
    constexpr std::array kEye{Vec2(0.14f, 0.16f), Vec2(0.56f, 0.22f), Vec2(0.34f, 0.56f)};
    constexpr std::array kNose{Vec2(-0.10f, -0.06f), Vec2(0.10f, -0.06f), Vec2(0.0f, 0.13f)};
    const Vec2 right_half(std::abs(p.x), p.y);
    const float eyes = polygon_distance(kEye, right_half);
    const float nose = polygon_distance(kNose, p);
    // A grin: within the large disc, outside a higher one, less the teeth.
    const float lower = glm::length(p - Vec2(0.0f, 0.22f)) - 0.80f;
    const float upper = 0.86f - glm::length(p - Vec2(0.0f, 0.56f));
    const auto tooth = [](Vec2 q, float x, float y) {
        return std::max(std::abs(q.x - x) - 0.065f, std::abs(q.y - y) - 0.09f);
    };
    const float teeth = std::min(tooth(right_half, 0.26f, -0.28f), tooth(p, 0.0f, -0.56f));
    const float mouth = std::max({lower, upper, -teeth});
    return std::min({eyes, nose, mouth});
}

/// Round holes on the back, so that light falls all around.
float back_distance(Vec3 direction) {
    struct Hole {
        Vec3 direction;
        float radius_rad;
    };
    static const std::array holes{
        Hole{normalize({0.0f, 0.25f, -1.0f}), 0.16f},
        Hole{normalize({0.55f, 0.1f, -1.0f}), 0.10f},
        Hole{normalize({-0.55f, 0.1f, -1.0f}), 0.10f},
        Hole{normalize({0.3f, -0.25f, -1.0f}), 0.08f},
        Hole{normalize({-0.3f, -0.25f, -1.0f}), 0.08f},
        Hole{normalize({1.0f, 0.3f, -0.25f}), 0.12f},
        Hole{normalize({-1.0f, 0.3f, -0.25f}), 0.12f},
    };
    float distance = kPi;
    for (const Hole& hole : holes) {
        const float angle_rad = std::acos(std::min(glm::dot(hole.direction, direction), 1.0f));
        distance = std::min(distance, angle_rad - hole.radius_rad);
    }
    return distance;
}

float carved_outline(Vec3 direction) {
    constexpr float kFaceMinZ = 0.4f;  // beyond, the tangent plane is too far away
    if (direction.z < kFaceMinZ) return back_distance(direction);
    return face_distance(Vec2(direction) / direction.z);
}

Mesh stem() {
    const float top_m = pumpkin_surface({0.0f, 1.0f, 0.0f}).y;
    return tube({{0.0f, top_m - 0.6f * kWallM, 0.0f},
                 {0.0f, top_m + 0.06f, 0.0f},
                 {0.015f, top_m + 0.12f, 0.01f},
                 {0.05f, top_m + 0.18f, 0.02f},
                 {0.09f, top_m + 0.21f, 0.03f}},
                {0.075f, 0.05f, 0.04f, 0.038f, 0.045f}, 10);
}

/// A box of boards with gaps between them.
Mesh crate() {
    constexpr float kHalfM = 0.3f;
    constexpr int kBoards = 4;
    constexpr float kPitchM = 2.0f * kHalfM / kBoards;
    Mesh mesh;
    for (const float x : {-kHalfM, kHalfM}) {
        for (const float z : {-kHalfM, kHalfM}) {
            append(mesh, box({x - 0.03f, -kSunkM, z - 0.03f}, {x + 0.03f, 0.6f, z + 0.03f}));
        }
    }
    for (int board = 0; board < kBoards; ++board) {
        const float y = 0.06f + kPitchM * static_cast<float>(board);
        for (const float side : {-1.0f, 1.0f}) {
            append(mesh, centered_box({0.0f, y, side * (kHalfM + 0.024f)}, {0.68f, 0.10f, 0.02f}));
            append(mesh, centered_box({side * (kHalfM + 0.023f), y + 0.004f, 0.0f},
                                      {0.02f, 0.092f, 0.60f}));
        }
    }
    return mesh;
}

void add_room(SceneBuilder& builder) {
    constexpr float kThicknessM = 0.2f;
    builder.add("floor", ground(Vec2(-3.4f), Vec2(3.4f, 4.4f)),
                builder.sheet("floor", {0.44f, 0.40f, 0.36f}));
    builder.add("walls", rectangular_wall({-2.9f, -kSunkM, -2.6f}, {2.6f, 2.7f, 4.0f}, kThicknessM),
                builder.solid("walls", {0.56f, 0.54f, 0.52f}));
    const std::uint32_t wood = builder.solid("wood", {0.34f, 0.21f, 0.11f});
    builder.place("crate", builder.mesh("crate", crate(), wood),
                  translation({-1.45f, 0.0f, -1.0f}) * rotation_y(0.4f));
    builder.add("post", moved(cylinder(0.05f, -kSunkM, 2.2f, 24), Vec3(1.75f, 0.0f, -0.75f)), wood);
}

}  // namespace

Scene jack_o_lantern_scene() {
    SceneBuilder builder("jack-o-lantern");
    add_room(builder);
    const std::uint32_t skin = builder.solid("pumpkin", {0.72f, 0.27f, 0.04f}, 0.05f, 24.0f);
    const std::uint32_t stalk = builder.solid("stalk", {0.20f, 0.20f, 0.09f});

    Mesh lantern = carved_shell(pumpkin_surface, inner_surface, carved_outline, kSides, kRings);
    float lowest_m = 0.0f;
    for (const Vec3 p : lantern.positions)
        lowest_m = std::min(lowest_m, p.y);
    // The face looks at the right wall and past the camera.
    const float height_m = -lowest_m - kSunkM;
    const Mat4 place = translation({0.0f, height_m, 0.0f}) * rotation_y(radians(34.0f));
    const std::uint32_t stem_mesh = builder.mesh("stem", stem(), stalk);
    builder.place("lantern", builder.mesh("lantern", std::move(lantern), skin), place);
    builder.place("stem", stem_mesh, place);

    // The walls of the holes are radial, so the flame is off the centre in all three directions: it
    // lies in the plane of none.
    const Vec3 flame(0.035f, height_m - 0.10f, 0.02f);
    const float bottom_m = height_m + inner_surface({0.0f, -1.0f, 0.0f}).y;
    builder.add("candle",
                moved(cylinder(0.045f, bottom_m - 0.5f * kWallM, flame.y - 0.07f, 24),
                      Vec3(0.03f, 0.0f, 0.015f)),
                builder.solid("wax", {0.80f, 0.74f, 0.60f}));
    builder.light(
        PointLight{.position_ws = flame, .intensity = {9.0f, 6.6f, 3.6f}, .name = "candle"});

    const std::uint32_t whole = builder.mesh("pumpkin", star_solid(pumpkin_surface, 64, 32), skin);
    struct Small {
        Vec3 position;
        float scale;
        float turn_rad;
    };
    const Small pumpkins[] = {{{1.5f, 0.0f, 0.75f}, 0.40f, 0.7f},
                              {{-1.0f, 0.0f, 0.7f}, 0.5f, 0.2f}};
    int number = 0;
    for (const Small& p : pumpkins) {
        const Vec3 center = p.position + Vec3(0.0f, p.scale * height_m, 0.0f);
        const Mat4 placed = translation(center) * rotation_y(p.turn_rad) * scaling(Vec3(p.scale));
        builder.place(numbered("pumpkin", ++number), whole, placed);
        builder.place(numbered("pumpkin stem", number), stem_mesh, placed);
    }
    builder.camera({-0.85f, 1.4f, 3.3f}, {0.72f, 0.70f, 0.0f}, radians(54.0f), 0.1f);
    return std::move(builder).scene();
}

}  // namespace gnomon::scene
