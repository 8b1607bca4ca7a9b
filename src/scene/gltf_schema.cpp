#include "scene/gltf_schema.h"

#include "base/check.h"
#include "scene/load_context.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

namespace gnomon::scene {

namespace {

using nlohmann::json;

// Deeper than any real document; the JSON library recurses when it frees and writes values.
constexpr int kMaxDepth = 128;

enum class Kind {
    object,
    array,
    string,
    boolean,
    number,
    numbers,  // array of `length` numbers; 0 = of any length
    index,    // whole number >= 0 that fits an int; of an array when `of` names one
    size,     // whole number >= 0
    stride,   // multiple of 4 in [0, 252]
};

constexpr bool kRequired = true;
constexpr std::uint64_t kMaxStride = 252;

// `path`: members separated by '.', "[]" every element of an array, "{}" every member of an object.
struct Rule {
    std::string_view path;
    Kind kind;
    std::string_view of = {};
    std::size_t length = 0;
    bool required = false;
};

constexpr Rule kRules[] = {
    {"asset", Kind::object, {}, 0, kRequired},
    {"asset.version", Kind::string, {}, 0, kRequired},
    {"asset.minVersion", Kind::string},
    {"extensionsUsed[]", Kind::string},
    {"extensionsRequired[]", Kind::string},
    {"extensions", Kind::object},
    {"buffers[].byteLength", Kind::size, {}, 0, kRequired},
    {"buffers[].uri", Kind::string},
    {"bufferViews[].buffer", Kind::index, "buffers", 0, kRequired},
    {"bufferViews[].byteOffset", Kind::size},
    {"bufferViews[].byteLength", Kind::size, {}, 0, kRequired},
    {"bufferViews[].byteStride", Kind::stride},
    {"accessors[].bufferView", Kind::index, "bufferViews"},
    {"accessors[].byteOffset", Kind::size},
    {"accessors[].componentType", Kind::index, {}, 0, kRequired},
    {"accessors[].normalized", Kind::boolean},
    {"accessors[].count", Kind::index, {}, 0, kRequired},
    {"accessors[].type", Kind::string, {}, 0, kRequired},
    {"accessors[].sparse", Kind::object},
    {"accessors[].sparse.count", Kind::index, {}, 0, kRequired},
    {"accessors[].sparse.indices", Kind::object, {}, 0, kRequired},
    {"accessors[].sparse.indices.bufferView", Kind::index, "bufferViews", 0, kRequired},
    {"accessors[].sparse.indices.byteOffset", Kind::index},
    {"accessors[].sparse.indices.componentType", Kind::index, {}, 0, kRequired},
    {"accessors[].sparse.values", Kind::object, {}, 0, kRequired},
    {"accessors[].sparse.values.bufferView", Kind::index, "bufferViews", 0, kRequired},
    {"accessors[].sparse.values.byteOffset", Kind::index},
    {"images[].uri", Kind::string},
    {"images[].bufferView", Kind::index, "bufferViews"},
    {"samplers[].wrapS", Kind::index},
    {"samplers[].wrapT", Kind::index},
    {"textures[].source", Kind::index, "images"},
    {"textures[].sampler", Kind::index, "samplers"},
    {"materials[].name", Kind::string},
    {"materials[].alphaMode", Kind::string},
    {"materials[].alphaCutoff", Kind::number},
    {"materials[].doubleSided", Kind::boolean},
    {"materials[].pbrMetallicRoughness", Kind::object},
    {"materials[].pbrMetallicRoughness.baseColorFactor", Kind::numbers, {}, 4},
    {"materials[].pbrMetallicRoughness.metallicFactor", Kind::number},
    {"materials[].pbrMetallicRoughness.roughnessFactor", Kind::number},
    {"materials[].pbrMetallicRoughness.baseColorTexture", Kind::object},
    {"materials[].pbrMetallicRoughness.baseColorTexture.index", Kind::index, "textures", 0,
     kRequired},
    {"materials[].pbrMetallicRoughness.baseColorTexture.texCoord", Kind::index},
    {"materials[].pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.offset",
     Kind::numbers,
     {},
     2},
    {"materials[].pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.scale",
     Kind::numbers,
     {},
     2},
    {"materials[].pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.rotation",
     Kind::number},
    {"materials[].pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.texCoord",
     Kind::index},
    {"materials[].extensions.KHR_materials_pbrSpecularGlossiness.diffuseFactor",
     Kind::numbers,
     {},
     4},
    {"materials[].extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture.index", Kind::index,
     "textures", 0, kRequired},
    {"materials[].extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture.texCoord",
     Kind::index},
    {"meshes[].name", Kind::string},
    {"meshes[].primitives", Kind::array, {}, 0, kRequired},
    {"meshes[].primitives[].attributes", Kind::object, {}, 0, kRequired},
    {"meshes[].primitives[].attributes{}", Kind::index, "accessors"},
    {"meshes[].primitives[].indices", Kind::index, "accessors"},
    {"meshes[].primitives[].material", Kind::index, "materials"},
    {"meshes[].primitives[].mode", Kind::index},
    {"meshes[].primitives[].targets[]{}", Kind::index, "accessors"},
    {"meshes[].weights", Kind::numbers},
    {"cameras[].type", Kind::string, {}, 0, kRequired},
    {"cameras[].name", Kind::string},
    {"cameras[].perspective.yfov", Kind::number, {}, 0, kRequired},
    {"cameras[].perspective.znear", Kind::number, {}, 0, kRequired},
    {"cameras[].orthographic.xmag", Kind::number, {}, 0, kRequired},
    {"cameras[].orthographic.ymag", Kind::number, {}, 0, kRequired},
    {"cameras[].orthographic.znear", Kind::number, {}, 0, kRequired},
    {"cameras[].orthographic.zfar", Kind::number, {}, 0, kRequired},
    {"nodes[].name", Kind::string},
    {"nodes[].children[]", Kind::index, "nodes"},
    {"nodes[].mesh", Kind::index, "meshes"},
    {"nodes[].skin", Kind::index, "skins"},
    {"nodes[].camera", Kind::index, "cameras"},
    {"nodes[].matrix", Kind::numbers, {}, 16},
    {"nodes[].translation", Kind::numbers, {}, 3},
    {"nodes[].rotation", Kind::numbers, {}, 4},
    {"nodes[].scale", Kind::numbers, {}, 3},
    {"nodes[].weights", Kind::numbers},
    {"nodes[].extensions.KHR_lights_punctual.light", Kind::index,
     "extensions.KHR_lights_punctual.lights", 0, kRequired},
    {"nodes[].extensions.EXT_mesh_gpu_instancing.attributes{}", Kind::index, "accessors"},
    {"extensions.KHR_lights_punctual.lights[].type", Kind::string, {}, 0, kRequired},
    {"extensions.KHR_lights_punctual.lights[].name", Kind::string},
    {"extensions.KHR_lights_punctual.lights[].color", Kind::numbers, {}, 3},
    {"extensions.KHR_lights_punctual.lights[].intensity", Kind::number},
    {"extensions.KHR_lights_punctual.lights[].range", Kind::number},
    {"extensions.KHR_lights_punctual.lights[].spot.innerConeAngle", Kind::number},
    {"extensions.KHR_lights_punctual.lights[].spot.outerConeAngle", Kind::number},
    {"skins[].joints[]", Kind::index, "nodes"},
    {"skins[].joints", Kind::array, {}, 0, kRequired},
    {"skins[].inverseBindMatrices", Kind::index, "accessors"},
    {"animations[].samplers", Kind::array, {}, 0, kRequired},
    {"animations[].samplers[].input", Kind::index, "accessors", 0, kRequired},
    {"animations[].samplers[].output", Kind::index, "accessors", 0, kRequired},
    {"animations[].samplers[].interpolation", Kind::string},
    {"animations[].channels", Kind::array, {}, 0, kRequired},
    {"animations[].channels[].sampler", Kind::index, {}, 0, kRequired},
    {"animations[].channels[].target", Kind::object, {}, 0, kRequired},
    {"animations[].channels[].target.path", Kind::string, {}, 0, kRequired},
    {"animations[].channels[].target.node", Kind::index, "nodes"},
    {"scenes[].nodes[]", Kind::index, "nodes"},
    {"scene", Kind::index, "scenes"},
};

// A place in the document, spelled out only when something is wrong there.
struct Where {
    const Where* parent = nullptr;
    std::string_view member;
    std::size_t element = 0;
    bool is_element = false;
};

std::string spelled(const Where& where) {
    if (where.parent == nullptr) return {};
    const std::string above = spelled(*where.parent);
    if (where.is_element) return fmt::format("{}[{}]", above, where.element);
    return above.empty() ? std::string(where.member) : fmt::format("{}.{}", above, where.member);
}

[[noreturn]] void fail_at(const Where& where, std::string_view fault) {
    const std::string place = spelled(where);
    fail_input("{}{}", place.empty() ? "" : quotable(place) + ": ", fault);
}

// A whole number >= 0, be it written 3 or 3.0; makes the value an unsigned integer.
std::optional<std::uint64_t> whole_number(json& value) {
    constexpr double kMaxExact = 9007199254740992.0;  // 2^53: all whole doubles up to it are exact
    if (value.is_number_float()) {
        const double number = value.get<double>();
        if (number >= 0.0 && number <= kMaxExact && number == std::floor(number)) {
            value = static_cast<std::uint64_t>(number);
        }
    }
    if (!value.is_number_unsigned()) return std::nullopt;
    return value.get<std::uint64_t>();
}

class Checker {
public:
    Checker(const Rule& rule, json& root) : rule_(rule) {
        if (!rule.of.empty()) {
            const json* target = find(root, rule.of);
            count_ = target != nullptr && target->is_array() ? target->size() : 0;
        }
        visit(root, rule.path, {});
    }

private:
    static const json* find(const json& root, std::string_view path) {
        const json* value = &root;
        while (!path.empty()) {
            const std::size_t end = std::min(path.find('.'), path.size());
            if (!value->is_object()) return nullptr;
            const auto member = value->find(path.substr(0, end));
            if (member == value->end()) return nullptr;
            value = &*member;
            path.remove_prefix(std::min(end + 1, path.size()));
        }
        return value;
    }

    void visit(json& value, std::string_view path, const Where& where) {
        if (path.empty()) return check(value, where);
        if (path.starts_with("[]")) return visit_elements(value, path.substr(2), where);
        if (path.starts_with("{}")) return visit_members(value, path.substr(2), where);
        if (path.front() == '.') path.remove_prefix(1);
        if (!value.is_object()) fail_at(where, "must be an object");
        const std::size_t end = std::min(path.find_first_of(".[{"), path.size());
        const std::string_view name = path.substr(0, end);
        const Where inside{.parent = &where, .member = name};
        const auto member = value.find(name);
        if (member != value.end()) return visit(*member, path.substr(end), inside);
        if (rule_.required && end == path.size()) fail_at(inside, "is missing");
    }

    void visit_elements(json& value, std::string_view path, const Where& where) {
        if (!value.is_array()) fail_at(where, "must be an array");
        for (std::size_t i = 0; i < value.size(); ++i) {
            visit(value[i], path, {.parent = &where, .element = i, .is_element = true});
        }
    }

    void visit_members(json& value, std::string_view path, const Where& where) {
        if (!value.is_object()) fail_at(where, "must be an object");
        for (auto member = value.begin(); member != value.end(); ++member) {
            visit(*member, path, {.parent = &where, .member = member.key()});
        }
    }

    void check(json& value, const Where& where) const {
        switch (rule_.kind) {
            case Kind::object:
                return require(value.is_object(), where, "must be an object");
            case Kind::array:
                return require(value.is_array(), where, "must be an array");
            case Kind::string:
                return require(value.is_string(), where, "must be a string");
            case Kind::boolean:
                return require(value.is_boolean(), where, "must be true or false");
            case Kind::number:
                return require(value.is_number(), where, "must be a number");
            case Kind::numbers:
                return check_numbers(value, where);
            case Kind::index:
                return check_index(value, where);
            case Kind::size:
                return require(whole_number(value).has_value(), where,
                               "must be a whole number of at least 0");
            case Kind::stride: {
                const std::optional<std::uint64_t> stride = whole_number(value);
                return require(stride && *stride % 4 == 0 && *stride <= kMaxStride, where,
                               "must be a multiple of 4 of at most 252");
            }
        }
    }

    void check_numbers(const json& value, const Where& where) const {
        bool fits = value.is_array() && (rule_.length == 0 || value.size() == rule_.length);
        for (std::size_t i = 0; fits && i < value.size(); ++i) {
            fits = value[i].is_number();
        }
        if (rule_.length == 0) return require(fits, where, "must be an array of numbers");
        require(fits, where, fmt::format("must be an array of {} numbers", rule_.length));
    }

    void check_index(json& value, const Where& where) const {
        const std::optional<std::uint64_t> index = whole_number(value);
        if (!index || *index > std::numeric_limits<int>::max()) {
            fail_at(where, fmt::format("must be a whole number in [0, {}]",
                                       std::numeric_limits<int>::max()));
        }
        if (!rule_.of.empty() && *index >= count_) {
            fail_at(where, fmt::format("is {}, but there are {} {}", *index, count_, rule_.of));
        }
    }

    static void require(bool fits, const Where& where, std::string_view fault) {
        if (!fits) fail_at(where, fault);
    }

    const Rule& rule_;
    std::size_t count_ = 0;
};

// Before anything recursive sees the text.
void check_depth(std::string_view text) {
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\') {
                ++i;
            } else if (c == '"') {
                in_string = false;
            }
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            if (++depth > kMaxDepth) fail_input("JSON is nested more than {} deep", kMaxDepth);
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
}

}  // namespace

json parse_gltf_json(std::string_view text) {
    if (text.empty()) fail_input("is empty");
    check_depth(text);
    json document;
    try {
        document = json::parse(text);
    } catch (const json::exception& error) {
        // "[json.exception.parse_error.101] parse error at line 1, column 2: ..."
        const std::string_view what = error.what();
        const std::size_t start = what.find("] ");
        constexpr std::size_t kMaxQuoted = 240;
        fail_input("JSON {}",
                   quotable(what.substr(start == what.npos ? 0 : start + 2), kMaxQuoted));
    }
    if (!document.is_object()) fail_input("the JSON text is not an object");
    return document;
}

void check_gltf_json(json& document) {
    for (const Rule& rule : kRules)
        Checker(rule, document);
}

}  // namespace gnomon::scene
