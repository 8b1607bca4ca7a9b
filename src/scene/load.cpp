#include <gnomon/scene.h>

#include "base/check.h"
#include "base/file.h"
#include "base/text.h"
#include "scene/gltf.h"
#include "scene/load_context.h"
#include "scene/load_draft.h"
#include "scene/load_texture.h"
#include "scene/obj.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <system_error>

namespace gnomon {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMaxSceneFileBytes = std::uint64_t{4} << 30;

enum class Format { gltf, obj, unknown };

Format format_of(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".gltf" || extension == ".glb") return Format::gltf;
    if (extension == ".obj") return Format::obj;
    return Format::unknown;
}

std::vector<std::string_view> builtin_names() {
    std::vector<std::string_view> names;
    for (const BuiltinSceneInfo& info : builtin_scenes())
        names.push_back(info.name);
    return names;
}

[[noreturn]] void fail_unknown(const std::string& name) {
    std::error_code error;
    const fs::file_status status = fs::status(name, error);
    if (fs::is_directory(status)) {
        fail_input("{}: is a folder; name a .gltf, .glb or .obj file in it", name);
    }
    if (fs::exists(status)) {
        fail_input("{}: is no .gltf, .glb or .obj file by its name; convert it to one", name);
    }
    fail_input("{}: no such file, and no built-in scene{}", name,
               suggestion(name, builtin_names()));
}

SceneData load_file(const std::string& path, Format format, const LoadOptions& options,
                    Progress& progress) {
    std::vector<std::uint8_t> bytes = read_file(path, kMaxSceneFileBytes);
    const scene::SceneFolder folder{fs::path(path)};
    scene::Warnings warnings;
    scene::LoadContext context{folder, options, warnings, progress};
    scene::Draft draft = format == Format::obj ? scene::load_obj(std::move(bytes), context)
                                               : scene::load_gltf(std::move(bytes), context);
    SceneData data = scene::finish(std::move(draft), warnings);
    scene::solidify_idle_masks(data.materials, data.textures, data.meshes);
    data.source = path;
    data.warnings = warnings.lines();
    return data;
}

}  // namespace

Scene load_scene(const std::string& path_or_name, const LoadOptions& options) {
    Progress silent;
    return load_scene(path_or_name, options, silent);
}

Scene load_scene(const std::string& path_or_name, const LoadOptions& options, Progress& progress) {
    const Format format = format_of(path_or_name);
    if (format == Format::unknown) {
        const std::vector<std::string_view> names = builtin_names();
        if (std::find(names.begin(), names.end(), path_or_name) != names.end()) {
            return make_builtin_scene(path_or_name);
        }
        fail_unknown(path_or_name);
    }
    try {
        return Scene(load_file(path_or_name, format, options, progress));
    } catch (const Error& error) {
        const std::string_view what = error.what();
        if (error.kind() != ErrorKind::input || what.starts_with(path_or_name)) throw;
        throw Error(ErrorKind::input, fmt::format("{}: {}", path_or_name, what));
    } catch (const std::bad_alloc&) {
        fail_machine("{}: there is not enough memory for it", path_or_name);
    } catch (const std::exception& error) {
        fail_input("{}: {}", path_or_name, scene::quotable(error.what()));
    }
}

}  // namespace gnomon
