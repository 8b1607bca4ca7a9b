#include "scene/gltf_material.h"

#include "base/check.h"
#include "scene/load_texture.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gnomon::scene {

namespace {

// What is blended in glTF is a mask here: it holds light off where it is more than half opaque.
constexpr float kBlendCutoff = 0.5f;

// Blinn-Phong for a metallic-roughness surface. Reflectance: 4 % for what is no metal; metals
// reflect more, but spread it over so wide a lobe when rough that little is left of a highlight.
constexpr float kDielectricReflectance = 0.04f;
constexpr float kMetalReflectance = 0.3f;
constexpr float kMinShininess = 1.0f;
constexpr float kMaxShininess = 1024.0f;

struct BaseColor {
    std::vector<double> factor{1.0, 1.0, 1.0, 1.0};
    int texture = -1;
    int texcoord_set = 0;
    const tinygltf::Value* transform = nullptr;  // KHR_texture_transform
};

BaseColor metallic_roughness_color(const tinygltf::Material& material) {
    const auto& pbr = material.pbrMetallicRoughness;
    BaseColor color;
    if (pbr.baseColorFactor.size() == 4) color.factor = pbr.baseColorFactor;
    color.texture = pbr.baseColorTexture.index;
    color.texcoord_set = pbr.baseColorTexture.texCoord;
    color.transform = find_extension(pbr.baseColorTexture.extensions, "KHR_texture_transform");
    return color;
}

BaseColor specular_glossiness_color(const tinygltf::Value& extension) {
    BaseColor color;
    if (extension.Has("diffuseFactor")) {
        for (std::size_t i = 0; i < 4; ++i) {
            color.factor[i] =
                extension.Get("diffuseFactor").Get(static_cast<int>(i)).GetNumberAsDouble();
        }
    }
    if (!extension.Has("diffuseTexture")) return color;
    const tinygltf::Value& info = extension.Get("diffuseTexture");
    color.texture = static_cast<int>(number_in(info, "index", -1.0));
    color.texcoord_set = static_cast<int>(number_in(info, "texCoord", 0.0));
    return color;
}

bool finite(Vec2 v) {
    return std::isfinite(v.x) && std::isfinite(v.y);
}

void set_texture_transform(const tinygltf::Value& transform, Material& material, int& texcoord_set,
                           Warnings& warnings) {
    const auto vector = [&](const std::string& name, float otherwise) {
        if (!transform.Has(name)) return Vec2(otherwise);
        const tinygltf::Value& value = transform.Get(name);
        return Vec2(static_cast<float>(value.Get(0).GetNumberAsDouble()),
                    static_cast<float>(value.Get(1).GetNumberAsDouble()));
    };
    const auto rotation_rad = static_cast<float>(number_in(transform, "rotation", 0.0));
    const float c = std::cos(rotation_rad);
    const float s = std::sin(rotation_rad);
    const Vec2 scale = vector("scale", 1.0f);
    // Counter-clockwise as seen with V pointing down; the listing in the extension's text turns the
    // other way, which is a known slip of it (KhronosGroup/glTF, issue 1563).
    const glm::mat2 scale_rotation(scale.x * Vec2(c, -s), scale.y * Vec2(s, c));
    const Vec2 offset = vector("offset", 0.0f);
    if (finite(scale_rotation[0]) && finite(scale_rotation[1]) && finite(offset)) {
        material.uv_scale_rotation = scale_rotation;
        material.uv_offset = offset;
    } else {
        warnings.add("a texture transform that is not finite is left out", material.name);
    }
    texcoord_set = static_cast<int>(number_in(transform, "texCoord", texcoord_set));
}

TextureWrap wrap_of(int gltf_wrap) {
    if (gltf_wrap == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return TextureWrap::clamp;
    if (gltf_wrap == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return TextureWrap::mirror;
    return TextureWrap::repeat;
}

int read_texture(GltfDocument& document, int index, TextureShelf& shelf, Warnings& warnings) {
    const tinygltf::Model& model = document.model();
    const tinygltf::Texture& texture = model.textures[static_cast<std::size_t>(index)];
    if (texture.source < 0) {
        warnings.add("a texture in no format that can be read is left out",
                     fmt::format("textures[{}]", index));
        return -1;
    }
    TextureWrap wrap_u = TextureWrap::repeat;
    TextureWrap wrap_v = TextureWrap::repeat;
    if (texture.sampler >= 0) {
        const tinygltf::Sampler& sampler =
            model.samplers[static_cast<std::size_t>(texture.sampler)];
        wrap_u = wrap_of(sampler.wrapS);
        wrap_v = wrap_of(sampler.wrapT);
    }
    const std::string key =
        fmt::format("{} {} {}", texture.source, static_cast<int>(wrap_u), static_cast<int>(wrap_v));
    return shelf.get(key, [&]() -> Texture {
        const std::string name = document.image_name(texture.source);
        image::Rgba8 picture = image::decode(document.image_bytes(texture.source), name);
        return {name, picture.size, std::move(picture.rgba), wrap_u, wrap_v};
    });
}

float alpha_cutoff_of(const tinygltf::Material& material, Warnings& warnings) {
    if (material.alphaMode == "MASK") {
        constexpr double kEverything = 2.0;  // all cutoffs above 1 leave nothing
        return static_cast<float>(std::clamp(material.alphaCutoff, 0.0, kEverything));
    }
    if (material.alphaMode == "BLEND") return kBlendCutoff;
    if (material.alphaMode != "OPAQUE") {
        warnings.add("an unknown alphaMode is taken as OPAQUE", material.alphaMode);
    }
    return 0.0f;
}

void set_highlight(const tinygltf::Material& source, Material& material) {
    if (source.extensions.count("KHR_materials_unlit") > 0) {
        material.specular = 0.0f;
        return;
    }
    const auto& pbr = source.pbrMetallicRoughness;
    const auto roughness = static_cast<float>(std::clamp(pbr.roughnessFactor, 0.0, 1.0));
    const auto metallic = static_cast<float>(std::clamp(pbr.metallicFactor, 0.0, 1.0));
    // B. Karis, "Specular BRDF Reference", 2013: the exponent of the Blinn-Phong lobe that is as
    // wide as the GGX lobe of alpha = roughness².
    const float alpha = roughness * roughness;
    material.shininess =
        std::clamp(2.0f / std::max(alpha * alpha, 1e-6f) - 2.0f, kMinShininess, kMaxShininess);
    material.specular =
        std::lerp(kDielectricReflectance, kMetalReflectance, metallic) * (1.0f - roughness);
}

Material convert(GltfDocument& document, const tinygltf::Material& source, TextureShelf& shelf,
                 Warnings& warnings, int& texcoord_set) {
    const tinygltf::Value* glossy =
        find_extension(source.extensions, "KHR_materials_pbrSpecularGlossiness");
    const BaseColor color =
        glossy != nullptr ? specular_glossiness_color(*glossy) : metallic_roughness_color(source);
    Material material;
    material.name = source.name;
    for (int i = 0; i < 4; ++i) {
        const auto channel = static_cast<float>(color.factor[static_cast<std::size_t>(i)]);
        material.base_color[i] = std::clamp(channel, 0.0f, 1.0f);
    }
    texcoord_set = color.texcoord_set;
    if (color.texture >= 0) {
        material.base_color_texture = read_texture(document, color.texture, shelf, warnings);
        if (color.transform != nullptr) {
            set_texture_transform(*color.transform, material, texcoord_set, warnings);
        }
    }
    material.alpha_cutoff = alpha_cutoff_of(source, warnings);
    material.double_sided = source.doubleSided;
    set_highlight(source, material);
    return material;
}

}  // namespace

GltfMaterials read_materials(GltfDocument& document, LoadContext& context,
                             std::vector<Texture>& textures) {
    TextureShelf shelf(textures, context.warnings);
    GltfMaterials result;
    for (const tinygltf::Material& source : document.model().materials) {
        int texcoord_set = 0;
        result.materials.push_back(
            convert(document, source, shelf, context.warnings, texcoord_set));
        result.texcoord_sets.push_back(texcoord_set);
    }
    return result;
}

Material default_gltf_material() {
    Material material;
    material.name = "default";
    material.base_color = Vec4(1.0f);
    material.double_sided = false;
    return material;
}

}  // namespace gnomon::scene
