#include "scene/builtin.h"

#include "base/check.h"
#include "base/text.h"

#include <array>
#include <cmath>

namespace gnomon {

namespace {

struct Builtin {
    BuiltinSceneInfo info;
    Scene (*make)();
};

const std::vector<Builtin>& builtins() {
    static const std::vector<Builtin> list{
        {{"cube", "1 m cube on a ground plane under a hard sun: its shadow has a closed form"},
         scene::cube_scene},
        {{"courtyard",
          "paved court with an arcade, stairs, thin railings and a tree of "
          "alpha-masked leaves"},
         scene::courtyard_scene},
        {{"jack-o-lantern",
          "point light inside a carved closed shell: all in shadow but the "
          "light from the holes"},
         scene::jack_o_lantern_scene},
        {{"gas-station", "canopy, pumps, a ladder, a car under a tarp, power lines"},
         scene::gas_station_scene},
        {{"field-small", "12 thousand triangles, 20 objects on 200 m of flat ground"},
         scene::field_small_scene},
        {{"field-large",
          "1 million triangles, 1,000 objects, half of them one instanced tree, on "
          "1 km of hills"},
         scene::field_large_scene},
        {{"torches", "16 point lights among the pillars of a hall"}, scene::torches_scene},
    };
    return list;
}

}  // namespace

const std::vector<BuiltinSceneInfo>& builtin_scenes() {
    static const std::vector<BuiltinSceneInfo> infos = [] {
        std::vector<BuiltinSceneInfo> list;
        for (const Builtin& builtin : builtins())
            list.push_back(builtin.info);
        return list;
    }();
    return infos;
}

Scene make_builtin_scene(std::string_view name) {
    std::vector<std::string_view> names;
    for (const Builtin& builtin : builtins()) {
        if (builtin.info.name == name) return builtin.make();
        names.push_back(builtin.info.name);
    }
    fail_input("no built-in scene is called \"{}\"{}", name, suggestion(name, names));
}

namespace scene {

std::uint64_t Random::next() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

float Random::uniform() {
    return static_cast<float>(next() >> 40) * 0x1p-24f;
}

float Random::uniform(float min, float max) {
    return min + (max - min) * uniform();
}

Vec3 Random::direction() {
    // Archimedes: the height on a sphere is uniform.
    const float y = uniform(-1.0f, 1.0f);
    const double angle_rad = 2.0 * 3.14159265358979323846 * uniform();
    const float r = std::sqrt(1.0f - y * y);
    return {r * static_cast<float>(std::cos(angle_rad)), y,
            r * static_cast<float>(std::sin(angle_rad))};
}

SceneBuilder::SceneBuilder(std::string_view source) {
    data_.source = source;
}

std::uint32_t SceneBuilder::solid(std::string_view name, Vec3 linear_color, float specular,
                                  float shininess) {
    return material({.name = std::string(name),
                     .base_color = Vec4(linear_color, 1.0f),
                     .double_sided = false,
                     .specular = specular,
                     .shininess = shininess});
}

std::uint32_t SceneBuilder::sheet(std::string_view name, Vec3 linear_color) {
    return material({.name = std::string(name), .base_color = Vec4(linear_color, 1.0f)});
}

std::uint32_t SceneBuilder::material(Material material) {
    data_.materials.push_back(std::move(material));
    return static_cast<std::uint32_t>(data_.materials.size() - 1);
}

int SceneBuilder::texture(Texture texture) {
    data_.textures.push_back(std::move(texture));
    return static_cast<int>(data_.textures.size()) - 1;
}

std::uint32_t SceneBuilder::mesh(std::string_view name, Mesh mesh, std::uint32_t material) {
    mesh.name = name;
    mesh.material = material;
    data_.meshes.push_back(std::move(mesh));
    return static_cast<std::uint32_t>(data_.meshes.size() - 1);
}

void SceneBuilder::place(std::string_view name, std::uint32_t mesh, const Mat4& world_from_local) {
    data_.instances.push_back({.mesh = mesh,
                               .object = static_cast<std::uint32_t>(data_.instances.size()),
                               .world_from_local = world_from_local,
                               .name = std::string(name)});
}

void SceneBuilder::place(std::string_view name, std::uint32_t mesh, Vec3 position_ws) {
    Mat4 world_from_local(1.0f);
    world_from_local[3] = Vec4(position_ws, 1.0f);
    place(name, mesh, world_from_local);
}

void SceneBuilder::add(std::string_view name, Mesh mesh, std::uint32_t material) {
    place(name, this->mesh(name, std::move(mesh), material), Mat4(1.0f));
}

void SceneBuilder::camera(Vec3 eye_ws, Vec3 target_ws, float fov_y_rad, float near_m) {
    Camera camera = look_at(eye_ws, target_ws, fov_y_rad);
    camera.near_m = near_m;
    data_.cameras.push_back(std::move(camera));
}

void SceneBuilder::light(Light light) {
    data_.lights.push_back(std::move(light));
}

std::string numbered(std::string_view name, int number) {
    return fmt::format("{}-{:03}", name, number);
}

Texture paving_texture() {
    constexpr unsigned kSize = 256;
    constexpr unsigned kRows = 2;
    constexpr unsigned kStone = kSize / kRows;  // pixels from joint to joint
    constexpr unsigned kJoint = 3;              // pixels
    constexpr int kJointGrey = 112;
    constexpr std::array<int, 4> kStoneGrey{176, 190, 184, 170};  // sRGB
    constexpr float kNoise = 10.0f;
    constexpr Vec3 kTint(1.0f, 0.97f, 0.91f);  // sandstone
    Random random(1);
    Texture texture{.name = "paving", .size = {kSize, kSize}};
    texture.rgba.reserve(std::size_t{4} * kSize * kSize);
    for (unsigned y = 0; y < kSize; ++y) {
        const unsigned row = y / kStone;
        for (unsigned x = 0; x < kSize; ++x) {
            const unsigned shifted = (x + row * kStone / 2) % kSize;
            const bool joint = y % kStone < kJoint || shifted % kStone < kJoint;
            const int grey = joint ? kJointGrey : kStoneGrey[2 * row + shifted / kStone];
            const float value = static_cast<float>(grey) + random.uniform(-kNoise, kNoise);
            for (int channel = 0; channel < 3; ++channel)
                texture.rgba.push_back(static_cast<std::uint8_t>(value * kTint[channel]));
            texture.rgba.push_back(255);
        }
    }
    return texture;
}

}  // namespace scene

}  // namespace gnomon
