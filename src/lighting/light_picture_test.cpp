#include <gnomon/error.h>
#include <gnomon/image.h>
#include <gnomon/lighting.h>

#include "raster/small_scene_test.h"
#include "visibility/context_test.h"
#include "visibility/visibility_impl.h"

#include <glm/ext/matrix_transform.hpp>

#include <cmath>
#include <limits>

namespace gnomon {
namespace {

constexpr Extent kSize{16, 16};

/// Of a display value: one part in a thousand is far below what is seen, and above the rounding of
/// half floats and of the device's own sRGB tables.
constexpr float kTolerance = 1e-3f;

/// A base colour that 8 bits of sRGB hold as it is.
const Vec3 kColor(linear_from_srgb(200 / 255.0f), linear_from_srgb(120 / 255.0f),
                  linear_from_srgb(50 / 255.0f));

/// A wall of 4 m in the plane z = 0 that faces +Z, without gloss.
SceneData wall_data() {
    SceneData data = raster::scene_data({raster::wall(Vec3(0), 4)});
    data.materials[0].base_color = Vec4(kColor, 1.0f);
    data.materials[0].specular = 0.0f;
    return data;
}

/// Seen from +Z by a parallel camera; a pixel is 1/8 m wide, the picture's middle is the origin.
Frame wall_frame(SceneData data = wall_data()) {
    Frame frame{.scene = Scene(std::move(data)), .size = kSize};
    frame.camera = look_at({0, 0, 5}, {0, 0, 0});
    frame.camera.ortho_height_m = 2.0f;
    frame.camera.ortho_depth_m = 10.0f;
    return frame;
}

Vec3 pixel_ws(unsigned x, unsigned y) {
    return {(static_cast<float>(x) + 0.5f) / 8.0f - 1.0f,
            1.0f - (static_cast<float>(y) + 0.5f) / 8.0f, 0.0f};
}

Vec3 shown(Vec3 radiance) {
    Vec3 encoded;
    for (int c = 0; c < 3; ++c)
        encoded[c] = srgb_from_linear(std::min(1.0f, std::max(0.0f, radiance[c])));
    return encoded;
}

Vec3 at(const Image& picture, unsigned x, unsigned y) {
    return {picture.at(x, y, 0), picture.at(x, y, 1), picture.at(x, y, 2)};
}

void expect_near(Vec3 value, Vec3 expected) {
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(value[c], expected[c], kTolerance) << "channel " << c;
}

class LightPictureTest : public ContextTest {
protected:
    /// The same visibility everywhere.
    static Visibility seen(float value) {
        Visibility visibility;
        for (float& v : visibility.impl().host_target(context().impl(), kSize).pixels())
            v = value;
        return visibility;
    }

    /// With light alone, as it is.
    static LightingOptions plain() { return {.ambient = Vec3(0.0f), .exposure = 1.0f}; }

    static Image picture(const Frame& frame, const Light& light,
                         const LightingOptions& options = plain(), float visibility = 1.0f) {
        const Visibility all = seen(visibility);
        const LitBy lit{light, &all};
        return light_picture(context(), frame, {&lit, 1}, options);
    }
};

TEST_F(LightPictureTest, IsLambertsUnderTheSun) {
    for (const float angle : {0.0f, 30.0f, 60.0f, 85.0f}) {
        const DirectionalLight light{
            .to_light_ws = {std::sin(radians(angle)), 0.0f, std::cos(radians(angle))},
            .irradiance = {3.0f, 2.0f, 4.0f}};
        const Vec3 radiance = kColor / kPi * light.irradiance * std::cos(radians(angle));
        const Image image = picture(wall_frame(), light);
        EXPECT_EQ(image.channels(), 3);
        for (const unsigned i : {0u, 7u, 15u})
            expect_near(at(image, i, 15 - i), shown(radiance));
    }
}

TEST_F(LightPictureTest, IsDarkBelowTheHorizon) {
    const Image image = picture(wall_frame(), DirectionalLight{.to_light_ws = {0, 0, -1}});
    expect_near(at(image, 5, 5), Vec3(0.0f));
}

TEST_F(LightPictureTest, FallsOffWithTheDistance) {
    const PointLight light{.position_ws = {0.5f, 0.25f, 1.0f}, .intensity = {2.0f, 3.0f, 4.0f}};
    const Image image = picture(wall_frame(), light);
    for (unsigned y = 0; y < 16; y += 3) {
        for (unsigned x = 0; x < 16; x += 3) {
            const Vec3 to_light = light.position_ws - pixel_ws(x, y);
            const float distance_m = glm::length(to_light);
            const float cosine = to_light.z / distance_m;
            expect_near(at(image, x, y),
                        shown(kColor / kPi * light.intensity * cosine / (distance_m * distance_m)));
        }
    }
}

TEST_F(LightPictureTest, FadesBetweenTheCones) {
    const SpotLight light{.position_ws = {0, 0, 1},
                          .direction_ws = {0, 0, -1},
                          .intensity = Vec3(3.0f),
                          .inner_angle_rad = radians(15.0f),
                          .outer_angle_rad = radians(40.0f)};
    const Image image = picture(wall_frame(), light);
    std::size_t full = 0, faded = 0, dark = 0;
    for (unsigned x = 0; x < 16; ++x) {
        const Vec3 to_light = light.position_ws - pixel_ws(x, 8);
        const float distance_m = glm::length(to_light);
        const float cosine = to_light.z / distance_m;
        // KHR_lights_punctual.
        const float inner = std::cos(light.inner_angle_rad),
                    outer = std::cos(light.outer_angle_rad);
        const float share = std::min(1.0f, std::max(0.0f, (cosine - outer) / (inner - outer)));
        ++(share == 1.0f ? full : share > 0.0f ? faded : dark);
        expect_near(at(image, x, 8), shown(kColor / kPi * light.intensity * share * share * cosine /
                                           (distance_m * distance_m)));
    }
    EXPECT_GE(std::min({full, faded, dark}), 2u);
}

TEST_F(LightPictureTest, HasLightsOfAreaAsPointsOfTheirStrength) {
    // On a receiver right below: intensity along the normal = radiance * projected area.
    const float radius_m = 0.2f;
    const float disc_m2 = kPi * radius_m * radius_m;
    const Vec3 place(pixel_ws(8, 8) + Vec3(0, 0, 2));
    const std::vector<std::pair<Light, float>> lights = {
        {SphereLight{.center_ws = place, .radius_m = radius_m, .radiance = Vec3(20.0f)}, disc_m2},
        {DiscLight{.center_ws = place,
                   .normal_ws = {0, 0, -1},
                   .radius_m = radius_m,
                   .radiance = Vec3(20.0f)},
         disc_m2},
        {RectLight{.center_ws = place,
                   .half_u_ws = {0, 0.1f, 0},
                   .half_v_ws = {0.3f, 0, 0},
                   .radiance = Vec3(20.0f)},
         0.2f * 0.6f},
        // Tilted by 60°: half as much.
        {DiscLight{.center_ws = place,
                   .normal_ws = {0, std::sin(radians(60.0f)), -0.5f},
                   .radius_m = radius_m,
                   .radiance = Vec3(20.0f)},
         0.5f * disc_m2},
        // Shines away.
        {DiscLight{.center_ws = place, .normal_ws = {0, 0, 1}, .radius_m = radius_m}, 0.0f}};
    for (const auto& [light, area_m2] : lights) {
        SCOPED_TRACE(light_kind(light));
        const Image image = picture(wall_frame(), light);
        expect_near(at(image, 8, 8), shown(kColor / kPi * 20.0f * area_m2 / 4.0f));
    }
}

TEST_F(LightPictureTest, HasTheHighlightOfBlinnAndPhong) {
    SceneData data = wall_data();
    data.materials[0].base_color = Vec4(0, 0, 0, 1);
    data.materials[0].specular = 10 / 255.0f;  // alpha is linear, in 8 bits
    data.materials[0].shininess = 20.0f;
    const Frame frame = wall_frame(std::move(data));
    for (const float angle : {0.0f, 20.0f, 40.0f}) {
        const DirectionalLight light{
            .to_light_ws = {std::sin(radians(angle)), 0.0f, std::cos(radians(angle))},
            .irradiance = Vec3(2.0f)};
        // The half vector is at half the angle from the normal.
        const float lobe = std::pow(std::cos(radians(0.5f * angle)), 20.0f);
        const float brdf = 10 / 255.0f * lobe * (20.0f + 8.0f) / (8.0f * kPi);
        expect_near(at(picture(frame, light), 3, 4),
                    shown(Vec3(brdf * 2.0f * std::cos(radians(angle)))));
    }
}

TEST_F(LightPictureTest, MultipliesColorsOfMaterialTextureAndVertices) {
    SceneData data = wall_data();
    data.materials[0].base_color = Vec4(0.5f, 1.0f, 1.0f, 1.0f);
    data.materials[0].base_color_texture = 0;
    data.textures.push_back({.name = "grey", .size = {1, 1}, .rgba = {255, 188, 255, 255}});
    data.meshes[0].colors.assign(4, Vec4(1.0f, 1.0f, 0.2f, 1.0f));
    const Image image =
        picture(wall_frame(std::move(data)),
                DirectionalLight{.to_light_ws = {0, 0, 1}, .irradiance = Vec3(kPi)});
    const Vec3 expected(0.5f, linear_from_srgb(188 / 255.0f), 0.2f);
    // The product is stored in 8 bits.
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(at(image, 2, 2)[c], shown(expected)[c], 1.0f / 255.0f) << c;
}

/// The wall as `cells` x `cells` squares, with the stripes of a texture, which is magnified.
SceneData striped_wall(unsigned cells) {
    SceneData data = wall_data();
    data.materials[0].base_color = Vec4(1.0f);
    data.materials[0].base_color_texture = 0;
    Texture stripes{.name = "stripes", .size = {8, 8}, .rgba = {}};
    for (unsigned i = 0; i < 64; ++i) {
        const std::uint8_t value = i % 2 == 0 ? 40 : 220;
        stripes.rgba.insert(stripes.rgba.end(), {value, value, value, 255});
    }
    data.textures.push_back(stripes);
    Mesh& mesh = data.meshes[0];
    mesh = {};
    for (unsigned y = 0; y <= cells; ++y) {
        for (unsigned x = 0; x <= cells; ++x) {
            const Vec2 uv = Vec2(x, y) / static_cast<float>(cells);
            mesh.positions.emplace_back(4.0f * uv - 2.0f, 0.0f);
            mesh.texcoords.push_back(uv);
        }
    }
    for (unsigned y = 0; y < cells; ++y) {
        for (unsigned x = 0; x < cells; ++x) {
            const unsigned a = y * (cells + 1) + x;
            mesh.triangles.push_back({a, a + 1, a + cells + 2});
            mesh.triangles.push_back({a, a + cells + 2, a + cells + 1});
        }
    }
    return data;
}

TEST_F(LightPictureTest, TexturesSmallTrianglesAsLargeOnes) {
    // Triangles of less than two pixels: the level of detail must not depend on their edges.
    const DirectionalLight light{.to_light_ws = {0, 0, 1}, .irradiance = Vec3(kPi)};
    const Image large = picture(wall_frame(striped_wall(1)), light);
    const Image small = picture(wall_frame(striped_wall(19)), light);
    for (unsigned y = 0; y < kSize.height; ++y) {
        for (unsigned x = 0; x < kSize.width; ++x)
            EXPECT_NEAR(small.at(x, y), large.at(x, y), 3.0f / 255.0f) << x << ", " << y;
    }
}

TEST_F(LightPictureTest, ShadesByTheNormalsOfTheVertices) {
    const Vec3 normal = normalize(Vec3(0.6f, 0.0f, 0.8f));
    for (const bool mirrored : {false, true}) {
        SceneData data = wall_data();
        data.meshes[0].normals.assign(4, normal);
        if (mirrored) {
            data.instances[0].world_from_local = glm::scale(Mat4(1.0f), {-1, 1, 1});
        }
        const Vec3 expected_normal = mirrored ? Vec3(-normal.x, 0, normal.z) : normal;
        const DirectionalLight light{.to_light_ws = normalize(Vec3(1, 0, 1)),
                                     .irradiance = Vec3(2.0f)};
        const float cosine = glm::dot(expected_normal, light.to_light_ws);
        expect_near(at(picture(wall_frame(std::move(data)), light), 4, 4),
                    shown(kColor / kPi * 2.0f * cosine));
    }
}

TEST_F(LightPictureTest, ShadesTheBackAsTheFrontOfTheOtherSide) {
    SceneData data = wall_data();
    data.meshes[0].normals.assign(4, Vec3(0, 0, -1));
    const DirectionalLight light{.to_light_ws = {0, 0, 1}, .irradiance = Vec3(2.0f)};
    expect_near(at(picture(wall_frame(std::move(data)), light), 4, 4), shown(kColor / kPi * 2.0f));
}

TEST_F(LightPictureTest, HasTheBackgroundAsItIs) {
    Frame frame = wall_frame();
    frame.camera.ortho_height_m = 16.0f;  // the wall fills the middle
    LightingOptions options = plain();
    options.background_srgb = {0.1f, 0.5f, 0.9f};
    options.exposure = 7.0f;
    for (const Compose compose : {Compose::additive, Compose::subtractive}) {
        options.compose = compose;
        const Image image = picture(frame, DirectionalLight{}, options, 0.0f);
        for (int c = 0; c < 3; ++c)
            EXPECT_EQ(at(image, 0, 0)[c], options.background_srgb[c]);
        expect_near(at(image, 8, 8), Vec3(0.0f));
    }
}

TEST_F(LightPictureTest, EncodesAsSrgbAndClamps) {
    SceneData data = wall_data();
    data.materials[0].base_color = Vec4(1.0f);
    const Frame frame = wall_frame(std::move(data));
    for (const float ambient : {0.0f, 0.001f, 0.0031308f, 0.01f, 0.5f, 1.0f, 2.0f}) {
        const LightingOptions options{.ambient = Vec3(ambient), .exposure = 1.0f};
        const Image image = light_picture(context(), frame, {}, options);
        expect_near(at(image, 6, 6), shown(Vec3(ambient)));
    }
}

TEST_F(LightPictureTest, IsBrighterByTheExposure) {
    const DirectionalLight light{.to_light_ws = {0, 0, 1}, .irradiance = Vec3(0.5f)};
    LightingOptions options = plain();
    options.exposure = 3.0f;
    expect_near(at(picture(wall_frame(), light, options), 6, 6), shown(kColor / kPi * 1.5f));
}

/// Two suns, straight and at 60°, and what each adds.
struct TwoLights {
    DirectionalLight a{.to_light_ws = {0, 0, 1}, .irradiance = {1, 2, 3}};
    DirectionalLight b{.to_light_ws = {std::sin(radians(60.0f)), 0, 0.5f}, .irradiance = {2, 1, 1}};
    Vec3 radiance_a = kColor / kPi * a.irradiance;
    Vec3 radiance_b = kColor / kPi * b.irradiance * 0.5f;
};

TEST_F(LightPictureTest, SumsWhatIsSeenOfEachLight) {
    const TwoLights lights;
    const Vec3 ambient(0.02f, 0.03f, 0.04f);
    const Visibility half = seen(0.5f), tenth = seen(0.1f);
    const std::vector<LitBy> lit = {{lights.a, &half}, {lights.b, &tenth}};
    const Image image =
        light_picture(context(), wall_frame(), lit, {.ambient = ambient, .exposure = 1.0f});
    expect_near(at(image, 9, 2),
                shown(ambient * kColor + 0.5f * lights.radiance_a + 0.1f * lights.radiance_b));
}

TEST_F(LightPictureTest, DarkensTheWholeWhenSubtractive) {
    const TwoLights lights;
    const Vec3 ambient(0.02f, 0.03f, 0.04f);
    const Visibility half = seen(0.5f), most = seen(0.8f);
    const std::vector<LitBy> lit = {{lights.a, &half}, {lights.b, &most}};
    const Image image =
        light_picture(context(), wall_frame(), lit,
                      {.ambient = ambient, .exposure = 1.0f, .compose = Compose::subtractive});
    expect_near(at(image, 9, 2),
                shown((ambient * kColor + lights.radiance_a + lights.radiance_b) * 0.5f * 0.8f));
}

TEST_F(LightPictureTest, ReadsTheVisibilityOfEachPixel) {
    Visibility visibility;
    Image& values = visibility.impl().host_target(context().impl(), kSize);
    for (unsigned y = 0; y < 16; ++y) {
        for (unsigned x = 0; x < 16; ++x)
            values.at(x, y) = static_cast<float>(16 * y + x) / 255.0f;
    }
    const DirectionalLight light{.to_light_ws = {0, 0, 1}, .irradiance = Vec3(kPi)};
    const LitBy lit{light, &visibility};
    const Image image = light_picture(context(), wall_frame(), {&lit, 1}, plain());
    for (unsigned y = 0; y < 16; ++y) {
        for (unsigned x = 0; x < 16; ++x)
            expect_near(at(image, x, y), shown(kColor * static_cast<float>(16 * y + x) / 255.0f));
    }
}

TEST_F(LightPictureTest, ChoosesAmbientAndExposureByTheFullyLitPicture) {
    SceneData data = wall_data();
    data.materials[0].base_color = Vec4(Vec3(0.5f), 1.0f);
    const Frame frame = wall_frame(std::move(data));
    constexpr float kSameShade = 0.02f;  // of a display value
    for (const float scale : {1e-3f, 1.0f, 1e4f}) {
        const DirectionalLight light{.to_light_ws = {0, 0, 1}, .irradiance = Vec3(scale)};
        const float lit = at(picture(frame, light, {}, 1.0f), 3, 3).x;
        const float shadow = at(picture(frame, light, {}, 0.0f), 3, 3).x;
        EXPECT_GT(lit, srgb_from_linear(0.7f));  // nearly white, and not clamped
        EXPECT_LT(lit, 1.0f);
        // The same exposure: shadows are as dark as ambient's tenth, not stretched to white.
        EXPECT_NEAR(shadow, srgb_from_linear(0.1f * linear_from_srgb(lit)), kSameShade);
    }
}

TEST_F(LightPictureTest, RefusesBadInput) {
    const Frame frame = wall_frame();
    Visibility small;
    small.impl().host_target(context().impl(), {8, 16});
    const Visibility all = seen(1.0f);
    const LitBy by_small{DirectionalLight{}, &small}, by_none{DirectionalLight{}, nullptr},
        fine{DirectionalLight{}, &all};
    EXPECT_THROW(light_picture(context(), frame, {&by_small, 1}), Error);
    EXPECT_THROW(light_picture(context(), frame, {&by_none, 1}), Error);
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    for (const float exposure : {-1.0f, kNan, std::numeric_limits<float>::infinity()})
        EXPECT_THROW(light_picture(context(), frame, {&fine, 1}, {.exposure = exposure}), Error);
    Frame bad = frame;
    bad.camera.near_m = 0.0f;
    EXPECT_THROW(light_picture(context(), bad, {&fine, 1}), Error);
}

}  // namespace
}  // namespace gnomon
