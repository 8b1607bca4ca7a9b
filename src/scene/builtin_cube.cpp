/// The cube: its top corner at (x, 1, z) casts its shadow to (x - 0.8, 0, z + 0.6), so every edge
/// of the shadow is known. The sun stands off the axes because it would graze two faces there.

#include "scene/builtin.h"
#include "scene/shapes.h"

namespace gnomon::scene {

Scene cube_scene() {
    constexpr float kGroundHalfM = 5.0f;
    SceneBuilder builder("cube");
    builder.add("ground", ground(Vec2(-kGroundHalfM), Vec2(kGroundHalfM)),
                builder.sheet("ground", {0.46f, 0.45f, 0.42f}));
    // A cube of 1 m above the ground, whose foot is in it.
    builder.add("cube", box({-0.5f, -kSunkM, -0.5f}, {0.5f, 1.0f, 0.5f}),
                builder.solid("cube", {0.58f, 0.22f, 0.12f}));

    DirectionalLight light = sun(radians(45.0f), 0.0f, 0.0f);
    light.to_light_ws = normalize({0.8f, 1.0f, -0.6f});  // elevation 45°, azimuth 53.13°
    builder.light(light);
    builder.camera({1.9f, 2.3f, 3.9f}, {-0.25f, 0.3f, 0.1f}, radians(40.0f), 0.1f);
    return std::move(builder).scene();
}

}  // namespace gnomon::scene
