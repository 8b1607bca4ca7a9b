// Which receivers face a light, as shaders and as rays see it: two formulas of one fact.

#include <gnomon/error.h>
#include <gnomon/technique.h>

#include "trace/light_sample.h"
#include "visibility/context_impl.h"
#include "visibility/context_test.h"

#include <random>

namespace gnomon {
namespace {

class Random {
public:
    float uniform(float low, float high) {
        return std::uniform_real_distribution<float>(low, high)(engine_);
    }
    Vec3 point(float reach) {
        return {uniform(-reach, reach), uniform(-reach, reach), uniform(-reach, reach)};
    }
    Vec3 direction() {
        for (;;) {
            const Vec3 v = point(1.0f);
            if (glm::length(v) > 0.1f && glm::length(v) < 1.0f) return normalize(v);
        }
    }

private:
    std::mt19937 engine_{5};
};

/// Triangles in all directions within 3 m of the origin.
Scene random_scene(Random& random) {
    SceneData data;
    data.materials.emplace_back();
    data.meshes.emplace_back();
    Mesh& mesh = data.meshes[0];
    for (std::uint32_t i = 0; i < 80; ++i) {
        const Vec3 center = random.point(2.0f);
        for (int corner = 0; corner < 3; ++corner)
            mesh.positions.push_back(center + random.point(1.0f));
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    data.instances.emplace_back();
    return Scene(std::move(data));
}

/// One light of each kind, among the triangles as often as not.
std::vector<Light> random_lights(Random& random) {
    const Vec3 u = random.direction();
    const Vec3 v = normalize(glm::cross(u, random.direction()));
    const auto size = [&] { return random.uniform(0.01f, 1.5f); };
    return {
        DirectionalLight{.to_light_ws = random.direction()},
        DirectionalLight{.to_light_ws = random.direction(),
                         .angular_diameter_rad = random.uniform(0.0f, 1.0f)},
        PointLight{.position_ws = random.point(4.0f)},
        SpotLight{.position_ws = random.point(4.0f), .direction_ws = random.direction()},
        SphereLight{.center_ws = random.point(4.0f), .radius_m = size()},
        DiscLight{
            .center_ws = random.point(4.0f), .normal_ws = random.direction(), .radius_m = size()},
        RectLight{
            .center_ws = random.point(4.0f), .half_u_ws = size() * u, .half_v_ws = size() * v}};
}

/// Is the light's highest point so near the receiver's plane, or the receiver so near the light's
/// surface, that rounding may decide? Packed normals are off by 6e-5 rad, positions by less.
bool is_borderline(const trace::Receiver& receiver, const Light& light) {
    constexpr float kRad = 2e-4f;
    const Vec3 highest = normalize(trace::highest_direction(receiver, light));
    if (std::abs(glm::dot(highest, receiver.normal_ws)) < kRad) return true;
    const auto in_plane = [&](Vec3 center, Vec3 normal) {
        return std::abs(glm::dot(normalize(receiver.position_ws - center), normal)) < kRad;
    };
    if (const auto* sphere = std::get_if<SphereLight>(&light)) {
        const float distance_m = glm::distance(receiver.position_ws, sphere->center_ws);
        return std::abs(distance_m - sphere->radius_m) < kRad * sphere->radius_m;
    }
    if (const auto* disc = std::get_if<DiscLight>(&light)) {
        return in_plane(disc->center_ws, disc->normal_ws);
    }
    if (const auto* rect = std::get_if<RectLight>(&light)) {
        return in_plane(rect->center_ws, normalize(glm::cross(rect->half_u_ws, rect->half_v_ws)));
    }
    return false;
}

class LocalIlluminationTest : public ContextTest {};

TEST_F(LocalIlluminationTest, LightsTheReceiversThatFaceTheLight) {
    Random random;
    Frame frame{.scene = random_scene(random), .size = {96, 64}};
    const std::unique_ptr<Technique> technique = make_technique(context(), "local_illumination");
    Progress silent;
    std::size_t lit = 0, dark = 0, borderline = 0;
    for (int round = 0; round < 12; ++round) {
        frame.camera = look_at(6.0f * random.direction(), Vec3(0.0f));
        const std::shared_ptr<FrameReceivers> receivers =
            context().impl().receiver_points(frame, silent);
        for (const Light& light : random_lights(random)) {
            frame.light = light;
            const Visibility visibility = technique->render(frame);
            for (std::size_t i = 0; i < receivers->points.size(); ++i) {
                const trace::Receiver& receiver = receivers->points[i];
                const float value = visibility.image().pixels()[i];
                if (!receiver.exists()) {
                    EXPECT_EQ(value, 1.0f);
                } else if (is_borderline(receiver, light)) {
                    ++borderline;
                } else {
                    const bool faces = trace::faces_light(receiver, light);
                    EXPECT_EQ(value, faces ? 1.0f : 0.0f)
                        << light_kind(light) << ", round " << round << ", pixel " << i;
                    ++(faces ? lit : dark);
                }
            }
        }
    }
    EXPECT_GT(lit, 10'000u);
    EXPECT_GT(dark, 10'000u);
    EXPECT_LT(borderline, (lit + dark) / 200);
}

TEST_F(LocalIlluminationTest, TakesNoParameters) {
    EXPECT_THROW(make_technique(context(), "local_illumination", {{"samples", 1}}), Error);
}

}  // namespace
}  // namespace gnomon
