#pragma once

#include <gnomon/scene.h>

#include "image/decode.h"
#include "scene/load_context.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace gnomon::scene {

/// Textures by key, each made once. One that cannot be made is a warning.
class TextureShelf {
public:
    TextureShelf(std::vector<Texture>& textures, Warnings& warnings)
        : textures_(textures), warnings_(warnings) {}

    /// The index of the texture `key`, made when it is asked for the first time; -1 when `make`
    /// threw Error{input}.
    int get(const std::string& key, const std::function<Texture()>& make);

private:
    std::vector<Texture>& textures_;
    Warnings& warnings_;
    std::map<std::string, int> indices_;
};

/// `color` with the alpha of `mask`, both scaled to the larger width and height of the two. The
/// mask's own alpha counts when it has any below 255, else its mean of red, green and blue.
image::Rgba8 with_mask(const image::Rgba8& color, const image::Rgba8& mask);

/// Materials whose mask cuts nothing, as no alpha of theirs is below the cutoff, become solid:
/// tracing and drawing them is faster. To be called when meshes, materials and textures are there.
void solidify_idle_masks(std::vector<Material>& materials, const std::vector<Texture>& textures,
                         const std::vector<Mesh>& meshes);

}  // namespace gnomon::scene
