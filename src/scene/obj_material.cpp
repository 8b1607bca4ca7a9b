#include "scene/obj_material.h"

#include "base/check.h"
#include "scene/obj_parser.h"
#include "scene/obj_text.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <utility>

namespace gnomon::scene {

namespace {

// Where alpha comes from a picture or from `d`, what is more than half transparent is a hole.
constexpr float kCutoff = 0.5f;
constexpr float kMinShininess = 1.0f;
constexpr float kMaxShininess = 1024.0f;

// A value from a file in [0, 1]; NaN becomes `otherwise`.
float unit(double value, float otherwise) {
    return value >= 0.0 ? static_cast<float>(std::min(value, 1.0)) : value < 0.0 ? 0.0f : otherwise;
}

std::string folder_of(const std::string& name) {
    const std::size_t slash = name.rfind('/');
    return slash == std::string::npos ? std::string() : name.substr(0, slash + 1);
}

std::string with_slashes(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    return trimmed(name);
}

// A name as a library in `folder` gives it: relative to the library or to the scene; or, as
// exporters write paths of the machine they ran on, the last part alone.
std::string located(const std::string& name, const std::string& folder, const SceneFiles& files) {
    const std::string last = name.substr(folder_of(name).size());
    for (const std::string& candidate : {folder + name, name, folder + last, last}) {
        if (files.exists(candidate)) return candidate;
    }
    return name;
}

// The parser takes three numbers after -o, -s and -t, though two may be left out, and would take
// the file's name for one.
std::string with_all_numbers(const std::string& line) {
    std::istringstream words(line);
    std::string result;
    std::string word;
    while (words >> word) {
        result += (result.empty() ? "" : " ") + word;
        if (word != "-o" && word != "-s" && word != "-t") continue;
        const std::string missing = word == "-s" ? " 1" : " 0";
        for (int i = 0; i < 3; ++i) {
            const std::streampos before = words.tellg();
            double number = 0.0;
            if (words >> number) {
                result += fmt::format(" {}", number);
            } else {
                words.clear();
                words.seekg(before);
                result += missing;
            }
        }
    }
    return result;
}

std::string with_whole_options(const std::string& text) {
    std::istringstream lines(text);
    std::string result;
    std::string line;
    while (std::getline(lines, line)) {
        const bool has_options =
            line.find("map_") != std::string::npos && line.find(" -") != std::string::npos;
        result += has_options ? with_all_numbers(line) : line;
        result += '\n';
    }
    return result;
}

class LibraryReader {
public:
    LibraryReader(LoadContext& context, std::vector<Texture>& textures)
        : context_(context), shelf_(textures, context.warnings) {}

    std::vector<Material> materials;

    void read_line(const std::string& line) {
        const std::string whole = located(with_slashes(line), "", context_.files);
        if (context_.files.exists(whole)) return read(whole);
        std::istringstream names(line);
        std::string name;
        bool any = false;
        while (names >> name) {
            const std::string library = located(with_slashes(name), "", context_.files);
            if (!context_.files.exists(library)) continue;
            read(library);
            any = true;
        }
        if (!any) {
            context_.warnings.add("a material library is not there or outside the scene's folder",
                                  line);
        }
    }

private:
    void read(const std::string& library) {
        if (!libraries_.insert(library).second) return;
        std::vector<std::uint8_t> bytes;
        try {
            bytes = context_.files.read(library);
        } catch (const Error& error) {
            context_.warnings.add("a material library cannot be read", error.what());
            return;
        }
        std::istringstream stream(with_whole_options({bytes.begin(), bytes.end()}));
        std::map<std::string, int> numbers;
        std::vector<tinyobj::material_t> sources;
        std::string warnings;
        std::string errors;
        tinyobj::LoadMtl(&numbers, &sources, &stream, &warnings, &errors);
        for (const tinyobj::material_t& source : sources) {
            const std::string name = trimmed(source.name);
            if (name.empty() || !names_.insert(name).second) continue;
            materials.push_back(convert(source, name, folder_of(library)));
        }
    }

    Material convert(const tinyobj::material_t& source, const std::string& name,
                     const std::string& folder) {
        Material material;
        material.name = name;
        for (int i = 0; i < 3; ++i)
            material.base_color[i] = unit(source.diffuse[i], 0.8f);
        material.base_color.a = unit(source.dissolve, 1.0f);
        material.base_color_texture = read_texture(source, folder);
        if (material.base_color_texture >= 0) {
            set_texture_transform(source.diffuse_texopt, material);
            // Exporters write a black Kd beside a texture and mean the texture.
            if (Vec3(material.base_color) == Vec3(0.0f)) {
                material.base_color = Vec4(Vec3(1.0f), material.base_color.a);
            }
        }
        const bool may_have_holes =
            material.base_color_texture >= 0 || material.base_color.a < 1.0f;
        if (may_have_holes) material.alpha_cutoff = kCutoff;
        if (material.base_color.a < kCutoff) {
            context_.warnings.add("a material is so transparent (d, Tr) that it is not there",
                                  name);
        }
        constexpr int kNoHighlight = 1;  // illum 0 and 1
        const double mean = (source.specular[0] + source.specular[1] + source.specular[2]) / 3.0;
        material.specular = source.illum <= kNoHighlight ? 0.0f : unit(mean, 0.0f);
        material.shininess = source.shininess >= kMinShininess
                                 ? std::min(static_cast<float>(source.shininess), kMaxShininess)
                                 : kMinShininess;
        return material;
    }

    int read_texture(const tinyobj::material_t& source, const std::string& folder) {
        const std::string color = file_of(source.diffuse_texname, folder);
        const std::string mask = file_of(source.alpha_texname, folder);
        if (color.empty() && mask.empty()) return -1;
        const TextureWrap wrap =
            source.diffuse_texopt.clamp ? TextureWrap::clamp : TextureWrap::repeat;
        const int texture = shelf_.get(fmt::format("{}|{}|{}", color, mask, static_cast<int>(wrap)),
                                       [&] { return make_texture(color, mask, wrap); });
        // A picture that is not there must not take its partner along.
        if (texture >= 0 || color.empty() || mask.empty()) return texture;
        return shelf_.get(fmt::format("{}||{}", color, static_cast<int>(wrap)),
                          [&] { return make_texture(color, {}, wrap); });
    }

    std::string file_of(const std::string& name, const std::string& folder) const {
        const std::string clean = with_slashes(name);
        return clean.empty() ? clean : located(clean, folder, context_.files);
    }

    Texture make_texture(const std::string& color, const std::string& mask,
                         TextureWrap wrap) const {
        image::Rgba8 picture{{1, 1}, {255, 255, 255, 255}};
        if (!color.empty()) picture = image::decode(context_.files.read(color), quotable(color));
        if (!mask.empty() && mask != color) {
            picture = with_mask(picture, image::decode(context_.files.read(mask), quotable(mask)));
        }
        return {color.empty() ? mask : color, picture.size, std::move(picture.rgba), wrap, wrap};
    }

    // u' = s u + o in the file's coordinates, whose v points up; ours points down: v' -> 1 - v'.
    static void set_texture_transform(const tinyobj::texture_option_t& option, Material& material) {
        const Vec2 scale(option.scale[0], option.scale[1]);
        const Vec2 offset(option.origin_offset[0], option.origin_offset[1]);
        for (const float value : {scale.x, scale.y, offset.x, offset.y}) {
            if (!std::isfinite(value)) return;
        }
        material.uv_scale_rotation = glm::mat2(scale.x, 0.0f, 0.0f, scale.y);
        material.uv_offset = {offset.x, 1.0f - scale.y - offset.y};
    }

    LoadContext& context_;
    TextureShelf shelf_;
    std::set<std::string> libraries_;
    std::set<std::string> names_;
};

}  // namespace

std::vector<Material> read_libraries(const std::vector<std::string>& mtllib_lines,
                                     LoadContext& context, std::vector<Texture>& textures) {
    LibraryReader reader(context, textures);
    for (const std::string& line : mtllib_lines)
        reader.read_line(line);
    return std::move(reader.materials);
}

Material default_obj_material() {
    Material material;
    material.name = "default";
    return material;
}

}  // namespace gnomon::scene
