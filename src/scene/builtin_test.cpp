#include "scene/builtin.h"

#include <gnomon/error.h>

#include "scene/builtin_plants.h"
#include "scene/shapes.h"
#include "scene/shapes_check_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>
#include <unordered_map>

namespace gnomon::scene {
namespace {

/// FNV-1a over everything that a scene is made of.
class Hash {
public:
    template <typename T>
    void add(const std::vector<T>& values) {
        add(values.data(), values.size() * sizeof(T));
    }
    void add(std::string_view text) { add(text.data(), text.size()); }
    template <typename T>
    void add_value(const T& value) {
        add(&value, sizeof value);
    }
    std::uint64_t value() const { return value_; }

private:
    void add(const void* bytes, std::size_t size) {
        constexpr std::uint64_t kPrime = 0x100000001b3u;
        for (std::size_t i = 0; i < size; ++i)
            value_ = (value_ ^ static_cast<const unsigned char*>(bytes)[i]) * kPrime;
    }
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

std::uint64_t hash_of(const Scene& scene) {
    Hash hash;
    for (const Texture& texture : scene.textures())
        hash.add(texture.rgba);
    for (const Mesh& mesh : scene.meshes()) {
        hash.add(mesh.positions);
        hash.add(mesh.normals);
        hash.add(mesh.texcoords);
        hash.add(mesh.colors);
        hash.add(mesh.triangles);
        hash.add_value(mesh.material);
    }
    for (const Material& material : scene.materials()) {
        hash.add(material.name);
        hash.add_value(material.base_color);
    }
    for (const Instance& instance : scene.instances()) {
        hash.add(instance.name);
        hash.add_value(instance.world_from_local);
        hash.add_value(instance.mesh);
    }
    for (const Camera& camera : scene.cameras())
        hash.add_value(camera.view_from_world);
    for (const Light& light : scene.lights())
        hash.add(light_name(light));
    return hash.value();
}

/// The meshes that are open by intent: seen from both sides.
bool is_sheet(const Scene& scene, const Mesh& mesh) {
    return scene.materials()[mesh.material].double_sided;
}

class BuiltinScene : public testing::TestWithParam<std::string_view> {
protected:
    Scene scene = make_builtin_scene(GetParam());
};

TEST_P(BuiltinScene, IsTheSameTwice) {
    EXPECT_EQ(hash_of(scene), hash_of(make_builtin_scene(GetParam())));
    EXPECT_EQ(scene.source(), GetParam());
    EXPECT_TRUE(scene.warnings().empty());
}

TEST_P(BuiltinScene, SolidsAreClosedAndWellShaped) {
    for (const Mesh& mesh : scene.meshes()) {
        EXPECT_EQ(shape_fault(mesh), "");
        if (!is_sheet(scene, mesh)) {
            EXPECT_EQ(closedness_fault(mesh), "");
        }
    }
}

TEST_P(BuiltinScene, OnlyGroundsLeavesAndTheTarpAreOpen) {
    const std::set<std::string> open{"ground", "paving", "floor", "terrain", "leaves", "tarp"};
    for (const Mesh& mesh : scene.meshes())
        EXPECT_EQ(is_sheet(scene, mesh), open.count(mesh.name) == 1) << mesh.name;
}

TEST_P(BuiltinScene, ObjectsAreNamedAndTheirOwn) {
    std::set<std::string> names;
    std::set<std::uint32_t> objects;
    for (const Instance& instance : scene.instances()) {
        EXPECT_FALSE(instance.name.empty());
        EXPECT_TRUE(names.insert(instance.name).second) << instance.name;
        EXPECT_TRUE(objects.insert(instance.object).second) << instance.name;
    }
    EXPECT_EQ(*objects.rbegin() + 1, objects.size());
}

TEST_P(BuiltinScene, EyeAndLightsAreInTheOpen) {
    ASSERT_EQ(scene.cameras().size(), 1u);
    ASSERT_FALSE(scene.lights().empty());
    std::vector<Vec3> points{scene.cameras()[0].eye_ws()};
    for (const Light& light : scene.lights()) {
        if (const auto* point = std::get_if<PointLight>(&light))
            points.push_back(point->position_ws);
    }
    for (const Instance& instance : scene.instances()) {
        const Mesh& mesh = scene.meshes()[instance.mesh];
        if (is_sheet(scene, mesh)) continue;
        Box3 box;
        for (const Vec3 p : mesh.positions)
            box.include(Vec3(instance.world_from_local * Vec4(p, 1.0f)));
        for (const Vec3 p : points) {
            if (glm::any(glm::lessThan(p, box.min)) || glm::any(glm::greaterThan(p, box.max))) {
                continue;
            }
            // Whole numbers but for rounding.
            EXPECT_NEAR(winding_number(mesh, instance.world_from_local, p), 0.0, 1e-3)
                << instance.name;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, BuiltinScene,
                         testing::Values("cube", "courtyard", "jack-o-lantern", "gas-station",
                                         "field-small", "field-large", "torches"),
                         [](const auto& tested) {
                             std::string name(tested.param);
                             std::erase(name, '-');
                             return name;
                         });

/// A triangle in the world with the plane it lies in.
struct PlacedTriangle {
    DVec3 corners[3];
    DVec3 normal;  // unit vector, of a sign that does not depend on the side
    double distance_m;
    std::size_t instance;
};

std::vector<PlacedTriangle> placed_triangles(const Scene& scene) {
    std::vector<PlacedTriangle> triangles;
    for (std::size_t i = 0; i < scene.instances().size(); ++i) {
        const Instance& instance = scene.instances()[i];
        const Mesh& mesh = scene.meshes()[instance.mesh];
        for (const UVec3 t : mesh.triangles) {
            PlacedTriangle placed;
            for (int corner = 0; corner < 3; ++corner) {
                const Vec4 p(mesh.positions[t[corner]], 1.0f);
                placed.corners[corner] = DVec3(Vec3(instance.world_from_local * p));
            }
            placed.normal = glm::normalize(glm::cross(placed.corners[1] - placed.corners[0],
                                                      placed.corners[2] - placed.corners[0]));
            constexpr double kZero = 1e-3;
            for (int axis = 0; axis < 3; ++axis) {
                if (std::abs(placed.normal[axis]) < kZero) continue;
                if (placed.normal[axis] < 0.0) placed.normal = -placed.normal;
                break;
            }
            placed.distance_m = glm::dot(placed.normal, placed.corners[0]);
            placed.instance = i;
            triangles.push_back(placed);
        }
    }
    return triangles;
}

/// True when two triangles of one plane overlap by more than `slack_m` in every direction in it
/// (separating axes: S. Gottschalk et al., 1996).
bool overlap(const PlacedTriangle& a, const PlacedTriangle& b, double slack_m) {
    for (const PlacedTriangle* triangle : {&a, &b}) {
        for (int edge = 0; edge < 3; ++edge) {
            const DVec3 along = triangle->corners[(edge + 1) % 3] - triangle->corners[edge];
            const DVec3 axis = glm::normalize(glm::cross(triangle->normal, along));
            const auto range = [&](const PlacedTriangle& t) {
                const auto [low, high] =
                    std::minmax({glm::dot(axis, t.corners[0]), glm::dot(axis, t.corners[1]),
                                 glm::dot(axis, t.corners[2])});
                return std::pair(low, high);
            };
            const auto [a_low, a_high] = range(a);
            const auto [b_low, b_high] = range(b);
            if (std::min(a_high, b_high) - std::max(a_low, b_low) < slack_m) return false;
        }
    }
    return true;
}

/// Names of two instances whose faces coincide, or empty.
std::string coincident_faces(const Scene& scene) {
    constexpr double kSlackM = 1e-3;      // in the plane; neighbours share edges
    constexpr double kSameNormal = 1e-3;  // rad
    constexpr double kSamePlaneM = 1e-3;  // closer faces would be hard to tell apart
    std::vector<PlacedTriangle> triangles = placed_triangles(scene);
    // The same plane falls into the same cell of at least one of two grids, but by rare chance.
    for (const double shift : {0.0, 0.5}) {
        std::unordered_map<std::string, std::vector<const PlacedTriangle*>> planes;
        for (const PlacedTriangle& t : triangles) {
            std::array<long, 4> cell{};
            for (int axis = 0; axis < 3; ++axis) {
                cell[static_cast<std::size_t>(axis)] =
                    std::lround(t.normal[axis] / (4.0 * kSameNormal) + shift);
            }
            cell[3] = std::lround(t.distance_m / (4.0 * kSamePlaneM) + shift);
            planes[std::string(reinterpret_cast<const char*>(cell.data()), sizeof cell)].push_back(
                &t);
        }
        for (const auto& [cell, in_plane] : planes) {
            for (std::size_t i = 0; i < in_plane.size(); ++i) {
                for (std::size_t j = i + 1; j < in_plane.size(); ++j) {
                    const PlacedTriangle& a = *in_plane[i];
                    const PlacedTriangle& b = *in_plane[j];
                    const double apart_m =
                        std::abs(glm::dot(a.normal, b.corners[0] - a.corners[0]));
                    if (apart_m > kSamePlaneM) continue;
                    if (glm::length(a.normal - b.normal) > kSameNormal) continue;
                    if (!overlap(a, b, kSlackM)) continue;
                    return scene.instances()[a.instance].name + " and " +
                           scene.instances()[b.instance].name + " at (" +
                           std::to_string(a.corners[0].x) + ", " + std::to_string(a.corners[0].y) +
                           ", " + std::to_string(a.corners[0].z) + ")";
                }
            }
        }
    }
    return {};
}

TEST(BuiltinScenes, NoFacesCoincide) {
    // But for field-large, where float positions far from the origin are too coarse to tell.
    for (const auto* name :
         {"cube", "courtyard", "jack-o-lantern", "gas-station", "field-small", "torches"}) {
        EXPECT_EQ(coincident_faces(make_builtin_scene(name)), "") << name;
    }
}

TEST(BuiltinScenes, ListAndMakerAgree) {
    EXPECT_EQ(builtin_scenes().size(), 7u);
    for (const BuiltinSceneInfo& info : builtin_scenes()) {
        EXPECT_EQ(make_builtin_scene(info.name).source(), info.name);
        EXPECT_FALSE(info.summary.empty());
    }
}

TEST(BuiltinScenes, MisspeltNameSuggestsTheNearest) {
    try {
        make_builtin_scene("courtyrad");
        FAIL() << "made a scene of no name";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_NE(std::string(error.what()).find("\"courtyard\""), std::string::npos)
            << error.what();
    }
}

std::uint64_t unique_triangles(const Scene& scene) {
    std::uint64_t count = 0;
    for (const Mesh& mesh : scene.meshes())
        count += mesh.triangles.size();
    return count;
}

TEST(BuiltinScenes, CubeStandsOnTheGroundAndItsShadowIsKnown) {
    const Scene scene = make_builtin_scene("cube");
    EXPECT_EQ(scene.triangle_count(), 14u);
    EXPECT_EQ(scene.bounds().max, Vec3(5.0f, 1.0f, 5.0f));
    const auto& light = std::get<DirectionalLight>(scene.lights().at(0));
    EXPECT_EQ(light.angular_diameter_rad, 0.0f);
    // Shadow of a point 1 m high: 0.8 m towards -X and 0.6 m towards +Z.
    const Vec3 shadow = Vec3(0.0f, 1.0f, 0.0f) - light.to_light_ws / light.to_light_ws.y;
    EXPECT_NEAR(shadow.x, -0.8f, 1e-6f);
    EXPECT_NEAR(shadow.y, 0.0f, 1e-6f);
    EXPECT_NEAR(shadow.z, 0.6f, 1e-6f);
}

TEST(BuiltinScenes, CountsArePinned) {
    struct Expected {
        std::string_view name;
        std::uint64_t triangles, unique;
        std::size_t objects, lights;
    };
    const Expected expected[] = {
        {"courtyard", 13'022, 7'642, 25, 1},         {"jack-o-lantern", 80'938, 76'770, 11, 1},
        {"gas-station", 24'962, 17'450, 54, 1},      {"field-small", 11'842, 10'482, 21, 1},
        {"field-large", 997'744, 498'744, 1'000, 1}, {"torches", 11'926, 4'598, 37, 16},
    };
    for (const Expected& e : expected) {
        const Scene scene = make_builtin_scene(e.name);
        EXPECT_EQ(scene.triangle_count(), e.triangles) << e.name;
        EXPECT_EQ(unique_triangles(scene), e.unique) << e.name;
        EXPECT_EQ(scene.instances().size(), e.objects) << e.name;
        EXPECT_EQ(scene.lights().size(), e.lights) << e.name;
    }
}

TEST(BuiltinScenes, FieldsHaveTheSizeOfThePublishedBenchmark) {
    const Scene small = make_builtin_scene("field-small");
    EXPECT_NEAR(static_cast<double>(small.triangle_count()), 12e3, 0.02 * 12e3);
    EXPECT_EQ(small.instances().size(), 20u + 1u);
    EXPECT_EQ(small.bounds().size().x, 200.0f);

    const Scene large = make_builtin_scene("field-large");
    EXPECT_NEAR(static_cast<double>(large.triangle_count()), 1e6, 0.01 * 1e6);
    EXPECT_EQ(large.instances().size(), 1000u);
    EXPECT_EQ(large.bounds().size().x, 1000.0f);
    std::vector<int> uses(large.meshes().size(), 0);
    for (const Instance& instance : large.instances())
        ++uses[instance.mesh];
    EXPECT_EQ(*std::max_element(uses.begin(), uses.end()), 500);
    for (const Scene& scene : {small, large}) {
        EXPECT_EQ(scene.cameras()[0].near_m, 0.5f);
        EXPECT_EQ(scene.cameras()[0].fov_y_rad, radians(50.0f));
        const auto& light = std::get<DirectionalLight>(scene.lights()[0]);
        EXPECT_NEAR(light.to_light_ws.y, std::sin(radians(45.0f)), 1e-6f);
    }
    EXPECT_FLOAT_EQ(small.cameras()[0].eye_ws().y, 1.8f);
}

/// True when the ray hits the triangle (T. Möller, B. Trumbore, 1997).
bool hits(DVec3 origin, DVec3 direction, DVec3 a, DVec3 b, DVec3 c) {
    const DVec3 p = glm::cross(direction, c - a);
    const double determinant = glm::dot(b - a, p);
    if (determinant == 0.0) return false;
    const DVec3 from_a = origin - a;
    const double u = glm::dot(from_a, p) / determinant;
    const DVec3 q = glm::cross(from_a, b - a);
    const double v = glm::dot(direction, q) / determinant;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && glm::dot(c - a, q) / determinant > 0.0;
}

TEST(BuiltinScenes, LanternLetsOutLittleLight) {
    const Scene scene = make_builtin_scene("jack-o-lantern");
    const auto lantern = std::find_if(scene.instances().begin(), scene.instances().end(),
                                      [](const Instance& i) { return i.name == "lantern"; });
    ASSERT_NE(lantern, scene.instances().end());
    const Mesh& mesh = scene.meshes()[lantern->mesh];
    const DVec3 light(std::get<PointLight>(scene.lights().at(0)).position_ws);
    std::vector<DVec3> world;
    for (const Vec3 p : mesh.positions)
        world.emplace_back(Vec3(lantern->world_from_local * Vec4(p, 1.0f)));
    constexpr int kRays = 400;
    Random random(1);
    int escaped = 0;
    for (int i = 0; i < kRays; ++i) {
        const DVec3 direction(random.direction());
        escaped += std::none_of(mesh.triangles.begin(), mesh.triangles.end(), [&](UVec3 t) {
            return hits(light, direction, world[t.x], world[t.y], world[t.z]);
        });
    }
    // The holes take about a tenth of all directions; three standard errors of 400 rays are 0.045.
    EXPECT_GT(escaped, kRays * 0.04);
    EXPECT_LT(escaped, kRays * 0.18);
}

TEST(BuiltinScenes, LeafTextureHasHolesAndLeaves) {
    const Texture texture = leaf_texture();
    int holes = 0;
    int leaves = 0;
    for (std::size_t i = 3; i < texture.rgba.size(); i += 4) {
        holes += texture.rgba[i] == 0;
        leaves += texture.rgba[i] == 255;
    }
    const int pixels = static_cast<int>(texture.size.width * texture.size.height);
    // Both matter: a card is neither nearly full nor nearly empty.
    EXPECT_GT(holes, pixels / 4);
    EXPECT_GT(leaves, pixels / 4);
    // The border is a hole, so that clamping shows no edge.
    for (unsigned x = 0; x < texture.size.width; ++x)
        EXPECT_LT(texture.rgba[std::size_t{4} * x + 3], 128) << x;

    const Scene scene = make_builtin_scene("courtyard");
    const auto masked = std::count_if(scene.materials().begin(), scene.materials().end(),
                                      [](const Material& m) { return m.masked(); });
    EXPECT_EQ(masked, 1);
}

TEST(Random, IsSplitMix64AndUniform) {
    // First outputs for seed 0 as published with the algorithm.
    Random random(0);
    EXPECT_EQ(random.next(), 0xe220a8397b1dcdafu);
    EXPECT_EQ(random.next(), 0x6e789e6aa1b965f4u);
    double sum = 0.0;
    constexpr int kCount = 10'000;
    for (int i = 0; i < kCount; ++i) {
        const float value = random.uniform(2.0f, 4.0f);
        ASSERT_GE(value, 2.0f);
        ASSERT_LE(value, 4.0f);
        sum += value;
    }
    // Five standard errors of the mean of a uniform distribution of width 2.
    EXPECT_NEAR(sum / kCount, 3.0, 5.0 * 2.0 / std::sqrt(12.0 * kCount));
}

}  // namespace
}  // namespace gnomon::scene
