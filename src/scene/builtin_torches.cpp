/// A hall with two rows of pillars, each of which carries two torches.

#include "scene/builtin.h"
#include "scene/shapes.h"

#include <array>

namespace gnomon::scene {

namespace {

constexpr float kHalfLengthM = 12.0f;  // x
constexpr float kHalfWidthM = 8.0f;    // z
constexpr float kWallHeightM = 5.0f;
constexpr float kWallThicknessM = 0.5f;
constexpr float kPillarZM = 3.2f;
constexpr std::array kPillarXM{-7.5f, -2.5f, 2.5f, 7.5f};
constexpr float kTorchHeightM = 2.1f;   // of the bowl's rim
constexpr float kTorchReachM = 0.75f;   // from the pillar's axis to the bowl's
constexpr float kFlameHeightM = 0.16f;  // of the light above the rim

Mesh pillar() {
    Mesh mesh = lathe({{0.0f, 0.25f},
                       {0.46f, 0.25f},
                       {0.46f, 0.45f},
                       {0.40f, 0.50f},
                       {0.36f, 0.60f},
                       {0.31f, 4.10f},
                       {0.34f, 4.16f},
                       {0.46f, 4.45f},
                       {0.46f, 4.55f},
                       {0.0f, 4.55f}},
                      32);
    append(mesh, box({-0.55f, -kSunkM, -0.55f}, {0.55f, 0.3f, 0.55f}));
    append(mesh, box({-0.52f, 4.5f, -0.52f}, {0.52f, 4.75f, 0.52f}));
    return mesh;
}

/// The bowl's rim is at the origin; the bracket reaches back along -Z into the pillar.
Mesh torch() {
    Mesh mesh = lathe({{0.0f, -0.20f},
                       {0.05f, -0.19f},
                       {0.10f, -0.12f},
                       {0.14f, 0.0f},
                       {0.12f, 0.0f},
                       {0.09f, -0.07f},
                       {0.0f, -0.10f}},
                      16);
    append(mesh, tube({{0.0f, -0.16f, 0.0f},
                       {0.0f, -0.30f, -0.08f},
                       {0.0f, -0.36f, -0.22f},
                       {0.0f, -0.32f, -0.50f}},
                      0.022f, 8));
    return mesh;
}

Mesh bench() {
    Mesh mesh = box({-1.1f, 0.40f, -0.24f}, {1.1f, 0.48f, 0.24f});
    for (const float x : {-0.85f, 0.85f})
        append(mesh, box({x - 0.09f, -kSunkM, -0.20f}, {x + 0.09f, 0.42f, 0.20f}));
    return mesh;
}

Mesh statue() {
    Mesh mesh = box({-0.6f, -kSunkM, -0.6f}, {0.6f, 0.9f, 0.6f});
    append(mesh, moved(sphere(0.55f, 48, 24), Vec3(0.0f, 1.40f, 0.0f)));
    append(mesh,
           moved(torus(0.85f, 0.07f, 64, 12), translation({0.0f, 1.42f, 0.0f}) * rotation_x(0.5f)));
    return mesh;
}

void add_torches(SceneBuilder& builder) {
    const std::uint32_t mesh =
        builder.mesh("torch", torch(), builder.solid("iron", {0.10f, 0.10f, 0.11f}, 0.08f));
    Random random(7);
    int number = 0;
    for (const float x : kPillarXM) {
        for (const float row : {-1.0f, 1.0f}) {
            for (const float side : {-1.0f, 1.0f}) {
                ++number;
                const Vec3 rim(x, kTorchHeightM, row * kPillarZM + side * kTorchReachM);
                builder.place(numbered("torch", number), mesh,
                              translation(rim) * rotation_y(side > 0.0f ? 0.0f : kPi));
                // Flames flicker: none is quite above its bowl, as bright or as red as the next.
                const Vec3 flame = rim + Vec3(random.uniform(-0.03f, 0.03f),
                                              kFlameHeightM + random.uniform(0.0f, 0.04f),
                                              random.uniform(-0.03f, 0.03f));
                const Vec3 color(1.0f, random.uniform(0.5f, 0.62f), random.uniform(0.18f, 0.3f));
                builder.light(PointLight{.position_ws = flame,
                                         .intensity = random.uniform(2.2f, 3.4f) * color,
                                         .name = numbered("torch", number)});
            }
        }
    }
}

}  // namespace

Scene torches_scene() {
    SceneBuilder builder("torches");
    const std::uint32_t floor = builder.material({
        .name = "flagstones",
        .base_color = Vec4(0.85f, 0.85f, 0.85f, 1.0f),
        .base_color_texture = builder.texture(paving_texture()),
        .uv_scale_rotation = glm::mat2(0.5f),  // a tile is 2 m
    });
    const std::uint32_t stone = builder.solid("stone", {0.50f, 0.46f, 0.40f});
    const std::uint32_t wall = builder.solid("wall", {0.40f, 0.36f, 0.32f});
    const std::uint32_t wood = builder.solid("wood", {0.26f, 0.15f, 0.08f});
    const Vec3 outer(kHalfLengthM + kWallThicknessM, 0.0f, kHalfWidthM + kWallThicknessM);
    builder.add("floor", ground(Vec2(-13.0f, -9.0f), Vec2(13.0f, 9.0f)), floor);
    builder.add("walls",
                rectangular_wall({-outer.x, -kSunkM, -outer.z}, {outer.x, kWallHeightM, outer.z},
                                 kWallThicknessM),
                wall);

    const std::uint32_t pillar_mesh = builder.mesh("pillar", pillar(), stone);
    const std::uint32_t beam =
        builder.mesh("beam", box({-0.2f, 4.70f, -8.2f}, {0.2f, 4.98f, 8.2f}), wood);
    int number = 0;
    for (const float x : kPillarXM)
        builder.place(numbered("beam", ++number), beam, Vec3(x, 0.0f, 0.0f));
    number = 0;
    for (const float x : kPillarXM) {
        for (const float z : {-kPillarZM, kPillarZM})
            builder.place(numbered("pillar", ++number), pillar_mesh, Vec3(x, 0.0f, z));
    }
    add_torches(builder);

    builder.add("statue", statue(), builder.solid("bronze", {0.30f, 0.34f, 0.28f}, 0.1f, 64.0f));
    const std::uint32_t bench_mesh = builder.mesh("bench", bench(), wood);
    number = 0;
    for (const float x : {-5.0f, 0.3f, 5.0f}) {
        builder.place(numbered("bench", ++number), bench_mesh, Vec3(x, 0.0f, -6.9f));
        builder.place(numbered("bench", ++number), bench_mesh, Vec3(x, 0.0f, 6.9f));
    }
    builder.camera({11.4f, 3.0f, 1.5f}, {-1.0f, 1.7f, -0.9f}, radians(50.0f), 0.1f);
    return std::move(builder).scene();
}

}  // namespace gnomon::scene
