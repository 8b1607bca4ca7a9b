/// Binary glTF 2.0 (Khronos, ISO/IEC 12113): a header, a chunk of JSON and a chunk of data. Lights
/// by KHR_lights_punctual, texture placement by KHR_texture_transform.

#include <gnomon/scene.h>

#include "base/check.h"
#include "base/file.h"
#include "image/decode.h"

#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>

namespace gnomon {

namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "glTF data is little-endian");

constexpr std::uint32_t kGlbMagic = 0x46546C67;   // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kDataChunk = 0x004E4942;  // "BIN"
constexpr std::size_t kChunkAlignment = 4;

// Numbers of OpenGL that glTF took over.
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;
constexpr int kLinear = 9729;
constexpr int kRepeat = 10497;
constexpr int kClampToEdge = 33071;
constexpr int kMirroredRepeat = 33648;

int gltf_wrap(TextureWrap wrap) {
    switch (wrap) {
        case TextureWrap::mirror:
            return kMirroredRepeat;
        case TextureWrap::clamp:
            return kClampToEdge;
        case TextureWrap::repeat:
            break;
    }
    return kRepeat;
}

Json array(Vec2 v) {
    return {v.x, v.y};
}

Json array(Vec3 v) {
    return {v.x, v.y, v.z};
}

Json array(Vec4 v) {
    return {v.x, v.y, v.z, v.w};
}

Json array(const Mat4& m) {
    Json values = Json::array();
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row)
            values.push_back(m[column][row]);
    }
    return values;
}

/// A rotation that turns -Z, along which glTF's lights shine, to `direction`.
Mat4 world_from_light(Vec3 direction_ws) {
    const Vec3 z = -normalize(direction_ws);
    const Vec3 helper = std::abs(z.y) < 0.9f ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
    const Vec3 x = normalize(glm::cross(helper, z));
    return {Vec4(x, 0.0f), Vec4(glm::cross(z, x), 0.0f), Vec4(z, 0.0f), Vec4(0, 0, 0, 1)};
}

Mat4 at(Vec3 position_ws) {
    Mat4 m(1.0f);
    m[3] = Vec4(position_ws, 1.0f);
    return m;
}

/// glTF separates a light's strength from its colour, whose channels are at most 1.
void set_strength(Json& light, Vec3 strength) {
    const float intensity = std::max({strength.x, strength.y, strength.z});
    light["color"] = array(intensity > 0.0f ? strength / intensity : Vec3(1.0f));
    light["intensity"] = intensity;
}

struct LightNode {
    Json light;
    Mat4 world_from_node;
};

struct LightConverter {
    LightNode operator()(const DirectionalLight& sun) const {
        LightNode node = make(sun.name, "directional", sun.irradiance);
        // glTF's suns have no size; a reader that knows the name finds it here.
        node.light["extras"]["angular_diameter_rad"] = sun.angular_diameter_rad;
        node.world_from_node = world_from_light(-sun.to_light_ws);
        return node;
    }
    LightNode operator()(const PointLight& light) const {
        return point(light.name, light.intensity, light.position_ws);
    }
    LightNode operator()(const SpotLight& spot) const {
        LightNode node = make(spot.name, "spot", spot.intensity);
        node.light["spot"] = {{"innerConeAngle", spot.inner_angle_rad},
                              {"outerConeAngle", spot.outer_angle_rad}};
        node.world_from_node = at(spot.position_ws) * world_from_light(spot.direction_ws);
        return node;
    }
    LightNode operator()(const SphereLight& light) const {
        return point(light.name, light.radiance * (kPi * light.radius_m * light.radius_m),
                     light.center_ws);
    }
    LightNode operator()(const DiscLight& light) const {
        return point(light.name, light.radiance * (kPi * light.radius_m * light.radius_m),
                     light.center_ws);
    }
    LightNode operator()(const RectLight& light) const {
        const float area_m2 = 4.0f * glm::length(light.half_u_ws) * glm::length(light.half_v_ws);
        return point(light.name, light.radiance * area_m2, light.center_ws);
    }

private:
    static LightNode make(const std::string& name, std::string_view type, Vec3 strength) {
        LightNode node{{{"name", name}, {"type", type}}, Mat4(1.0f)};
        set_strength(node.light, strength);
        return node;
    }
    static LightNode point(const std::string& name, Vec3 intensity, Vec3 position_ws) {
        LightNode node = make(name, "point", intensity);
        node.world_from_node = at(position_ws);
        return node;
    }
};

/// The rotation and scale of a material's texture placement. As glTF means it, angles count
/// counter-clockwise as seen with V pointing down: uv = rotation * scale * texcoord + offset.
Json texture_transform(const Material& material) {
    const glm::mat2 m = material.uv_scale_rotation;
    const float rotation_rad = std::atan2(-m[0].y, m[0].x);
    const float mirror = glm::determinant(m) < 0.0f ? -1.0f : 1.0f;
    return {{"offset", array(material.uv_offset)},
            {"rotation", rotation_rad},
            {"scale", {glm::length(m[0]), mirror * glm::length(m[1])}}};
}

/// The inverse of Blinn-Phong's usual match to glTF's roughness (B. Karis, "Specular BRDF
/// Reference", 2013): shininess = 2 / roughness^4 - 2.
float roughness(float shininess) {
    return std::pow(2.0f / (std::max(shininess, 0.0f) + 2.0f), 0.25f);
}

/// Builds the JSON and the data beside it.
class GlbWriter {
public:
    explicit GlbWriter(const Scene& scene) : scene_(scene) {
        json_["asset"] = {{"version", "2.0"}, {"generator", "gnomon"}};
        json_["scene"] = 0;
        json_["scenes"] = Json::array({{{"nodes", Json::array()}}});
        if (!scene_.source().empty()) json_["scenes"][0]["name"] = scene_.source();
    }

    std::string bytes() && {
        for (const Texture& texture : scene_.textures())
            add_texture(texture);
        for (const Material& material : scene_.materials())
            add_material(material);
        add_instances();
        for (const Camera& camera : scene_.cameras())
            add_camera(camera);
        for (const Light& light : scene_.lights())
            add_light(light);
        add_nodes();
        if (!extensions_.empty()) json_["extensionsUsed"] = extensions_;
        return assemble();
    }

private:
    /// Adds to an array that appears in the file only if it is not empty, as glTF demands.
    std::size_t add(const char* kind, Json item) {
        json_[kind].push_back(std::move(item));
        return json_[kind].size() - 1;
    }

    void use_extension(const char* name) {
        if (std::find(extensions_.begin(), extensions_.end(), name) == extensions_.end()) {
            extensions_.emplace_back(name);
        }
    }

    std::size_t add_view(const void* bytes, std::size_t size, std::optional<int> target) {
        data_.resize((data_.size() + kChunkAlignment - 1) / kChunkAlignment * kChunkAlignment);
        Json view = {{"buffer", 0}, {"byteOffset", data_.size()}, {"byteLength", size}};
        if (target) view["target"] = *target;
        data_.append(static_cast<const char*>(bytes), size);
        return add("bufferViews", std::move(view));
    }

    template <typename T>
    std::size_t add_accessor(const std::vector<T>& values, const char* type, int component = kFloat,
                             int target = kArrayBuffer, std::size_t components = 1) {
        const std::size_t view = add_view(values.data(), values.size() * sizeof(T), target);
        return add("accessors", {{"bufferView", view},
                                 {"componentType", component},
                                 {"count", values.size() * components},
                                 {"type", type}});
    }

    void add_texture(const Texture& texture) {
        const std::vector<std::uint8_t> png = image::encode_png({texture.size, texture.rgba});
        const std::size_t view = add_view(png.data(), png.size(), std::nullopt);
        const std::size_t image = add(
            "images", {{"name", texture.name}, {"bufferView", view}, {"mimeType", "image/png"}});
        const std::size_t sampler = add("samplers", {{"magFilter", kLinear},
                                                     {"minFilter", kLinear},
                                                     {"wrapS", gltf_wrap(texture.wrap_u)},
                                                     {"wrapT", gltf_wrap(texture.wrap_v)}});
        add("textures", {{"name", texture.name}, {"sampler", sampler}, {"source", image}});
    }

    void add_material(const Material& material) {
        Json pbr = {{"baseColorFactor", array(material.base_color)},
                    {"metallicFactor", 0.0},
                    {"roughnessFactor", roughness(material.shininess)}};
        if (material.base_color_texture >= 0) {
            Json& texture = pbr["baseColorTexture"];
            texture["index"] = material.base_color_texture;
            if (material.uv_scale_rotation != glm::mat2(1.0f) || material.uv_offset != Vec2(0.0f)) {
                texture["extensions"]["KHR_texture_transform"] = texture_transform(material);
                use_extension("KHR_texture_transform");
            }
        }
        Json json = {{"name", material.name},
                     {"pbrMetallicRoughness", std::move(pbr)},
                     {"doubleSided", material.double_sided}};
        if (material.masked()) {
            json["alphaMode"] = "MASK";
            json["alphaCutoff"] = material.alpha_cutoff;
        }
        add("materials", std::move(json));
    }

    /// A mesh of the scene as a primitive; made once.
    const Json& primitive(std::uint32_t index) {
        Json& json = primitives_[index];
        if (!json.is_null()) return json;
        const Mesh& mesh = scene_.meshes()[index];
        Box3 bounds;
        for (const Vec3 p : mesh.positions)
            bounds.include(p);
        const std::size_t positions = add_accessor(mesh.positions, "VEC3");
        json_["accessors"][positions]["min"] = array(bounds.min);
        json_["accessors"][positions]["max"] = array(bounds.max);
        json["attributes"]["POSITION"] = positions;
        if (!mesh.normals.empty()) {
            json["attributes"]["NORMAL"] = add_accessor(mesh.normals, "VEC3");
        }
        if (!mesh.texcoords.empty()) {
            json["attributes"]["TEXCOORD_0"] = add_accessor(mesh.texcoords, "VEC2");
        }
        if (!mesh.lightmap_texcoords.empty()) {
            json["attributes"]["TEXCOORD_1"] = add_accessor(mesh.lightmap_texcoords, "VEC2");
        }
        if (!mesh.colors.empty()) {
            json["attributes"]["COLOR_0"] = add_accessor(mesh.colors, "VEC4");
        }
        constexpr std::size_t kCorners = 3;
        json["indices"] =
            add_accessor(mesh.triangles, "SCALAR", kUnsignedInt, kElementArrayBuffer, kCorners);
        json["material"] = mesh.material;
        return json;
    }

    /// A glTF mesh is what one node shows: one or more of ours. Made once for the same ones.
    std::size_t gltf_mesh(const std::vector<std::uint32_t>& parts) {
        const auto [entry, is_new] = gltf_meshes_.try_emplace(parts, gltf_meshes_.size());
        if (is_new) {
            Json json = {{"name", scene_.meshes()[parts.front()].name},
                         {"primitives", Json::array()}};
            for (const std::uint32_t part : parts)
                json["primitives"].push_back(primitive(part));
            add("meshes", std::move(json));
        }
        return entry->second;
    }

    /// Neighbouring instances of one object in one place become one node, as they came from one.
    void add_instances() {
        const std::vector<Instance>& all = scene_.instances();
        for (std::size_t first = 0; first < all.size();) {
            std::size_t last = first;
            std::vector<std::uint32_t> parts;
            while (last < all.size() && all[last].object == all[first].object &&
                   all[last].name == all[first].name &&
                   all[last].world_from_local == all[first].world_from_local) {
                // glTF has no empty meshes.
                if (!scene_.meshes()[all[last].mesh].triangles.empty()) {
                    parts.push_back(all[last].mesh);
                }
                ++last;
            }
            if (!parts.empty()) {
                add_node(all[first].name, all[first].world_from_local,
                         {{"mesh", gltf_mesh(parts)}});
            }
            first = last;
        }
    }

    void add_camera(const Camera& camera) {
        Json json = {{"name", camera.name}};
        if (camera.ortho_height_m > 0.0f) {
            json["type"] = "orthographic";
            json["orthographic"] = {{"xmag", 0.5f * camera.ortho_height_m},
                                    {"ymag", 0.5f * camera.ortho_height_m},
                                    {"znear", camera.near_m},
                                    {"zfar", camera.ortho_depth_m}};
        } else {
            json["type"] = "perspective";
            json["perspective"] = {{"yfov", camera.fov_y_rad}, {"znear", camera.near_m}};
        }
        add_node(camera.name, glm::inverse(camera.view_from_world),
                 {{"camera", add("cameras", std::move(json))}});
    }

    void add_light(const Light& light) {
        constexpr const char* kExtension = "KHR_lights_punctual";
        use_extension(kExtension);
        LightNode node = std::visit(LightConverter{}, light);
        Json& lights = json_["extensions"][kExtension]["lights"];
        lights.push_back(std::move(node.light));
        Json content;
        content["extensions"][kExtension]["light"] = lights.size() - 1;
        add_node(light_name(light), node.world_from_node, std::move(content));
    }

    void add_node(const std::string& name, const Mat4& world_from_node, Json content) {
        Json node = {{"name", name}};
        if (world_from_node != Mat4(1.0f)) node["matrix"] = array(world_from_node);
        node.update(content);
        nodes_.push_back(std::move(node));
    }

    /// A scene that was moved to the origin goes back to its place: JSON's numbers can hold it.
    void add_nodes() {
        Json& roots = json_["scenes"][0]["nodes"];
        Json children = Json::array();
        for (Json& node : nodes_)
            children.push_back(add("nodes", std::move(node)));
        if (scene_.origin_offset_m() == DVec3(0.0)) {
            roots = std::move(children);
        } else if (!children.empty()) {
            const DVec3 offset = scene_.origin_offset_m();
            roots.push_back(add("nodes", {{"name", "origin"},
                                          {"translation", {offset.x, offset.y, offset.z}},
                                          {"children", std::move(children)}}));
        }
        if (roots.empty()) json_["scenes"][0].erase("nodes");
    }

    std::string assemble() {
        if (!data_.empty()) json_["buffers"] = Json::array({{{"byteLength", data_.size()}}});
        // Names from damaged files may not be UTF-8, which JSON must be.
        std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
        const auto pad = [](std::string& chunk, char with) {
            while (chunk.size() % kChunkAlignment != 0)
                chunk.push_back(with);
        };
        pad(text, ' ');
        pad(data_, '\0');
        constexpr std::size_t kHeaderBytes = 12;
        constexpr std::size_t kChunkHeaderBytes = 8;
        const std::size_t total = kHeaderBytes + kChunkHeaderBytes + text.size() +
                                  (data_.empty() ? 0 : kChunkHeaderBytes + data_.size());
        if (total > std::numeric_limits<std::uint32_t>::max()) {
            fail_machine("the scene makes {} bytes of binary glTF, which cannot hold 4 GiB", total);
        }
        std::string file;
        file.reserve(total);
        const auto put = [&](std::size_t value) {
            const auto word = static_cast<std::uint32_t>(value);
            char raw[sizeof word];
            std::memcpy(raw, &word, sizeof word);
            file.append(raw, sizeof raw);
        };
        constexpr std::uint32_t kVersion = 2;
        for (const std::size_t word : {std::size_t{kGlbMagic}, std::size_t{kVersion}, total,
                                       text.size(), std::size_t{kJsonChunk}}) {
            put(word);
        }
        file += text;
        if (data_.empty()) return file;
        put(data_.size());
        put(kDataChunk);
        file += data_;
        return file;
    }

    const Scene& scene_;
    Json json_;
    std::string data_;
    std::vector<Json> nodes_;
    std::vector<std::string> extensions_;
    std::map<std::uint32_t, Json> primitives_;                       // by mesh
    std::map<std::vector<std::uint32_t>, std::size_t> gltf_meshes_;  // by the meshes in it
};

}  // namespace

void write_glb(const std::filesystem::path& path, const Scene& scene) {
    write_file(path, GlbWriter(scene).bytes());
}

}  // namespace gnomon
