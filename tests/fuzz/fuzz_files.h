#pragma once

#include <gnomon/error.h>
#include <gnomon/scene.h>

#include "base/check.h"
#include "scene/load_context.h"
#include "scene/load_draft.h"
#include "scene/load_texture.h"

#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon::fuzz {

/// Files in memory: material libraries have the text `library`, pictures are missing, and all
/// others hold a pattern of bytes.
class FuzzFiles : public scene::SceneFiles {
public:
    explicit FuzzFiles(std::vector<std::uint8_t> library = {}) : library_(std::move(library)) {}

    std::vector<std::uint8_t> read(std::string_view name) const override {
        if (!exists(name)) fail_input("no such file");
        if (name.ends_with(".mtl")) return library_;
        std::vector<std::uint8_t> bytes(kPatternBytes);
        for (std::size_t i = 0; i < bytes.size(); ++i)
            bytes[i] = static_cast<std::uint8_t>(i * 7);
        return bytes;
    }

    bool exists(std::string_view name) const override {
        return name.ends_with(".mtl") || name.ends_with(".bin");
    }

private:
    static constexpr std::size_t kPatternBytes = 4096;
    std::vector<std::uint8_t> library_;
};

/// Loads a scene as load_scene does, but from memory; errors that are Error are fine.
template <typename Load>
void load(const Load& load_draft, std::vector<std::uint8_t> bytes, const FuzzFiles& files) {
    scene::Warnings warnings;
    Progress progress;
    const LoadOptions options{.animation_time_s = 0.5};
    scene::LoadContext context{files, options, warnings, progress};
    try {
        SceneData data = scene::finish(load_draft(std::move(bytes), context), warnings);
        scene::solidify_idle_masks(data.materials, data.textures, data.meshes);
        const Scene scene(std::move(data));
    } catch (const Error&) {
    }
    (void)warnings.lines();
}

}  // namespace gnomon::fuzz
