#pragma once

#include <gnomon/scene.h>

#include "scene/gltf_document.h"

#include <vector>

namespace gnomon::scene {

/// The materials of a document, in its order.
struct GltfMaterials {
    std::vector<Material> materials;
    std::vector<int> texcoord_sets;  ///< n of the TEXCOORD_n that each material's texture uses
};

/// Converts all materials and decodes their base-colour textures into `textures`.
GltfMaterials read_materials(GltfDocument& document, LoadContext& context,
                             std::vector<Texture>& textures);

/// What glTF gives to primitives without a material.
Material default_gltf_material();

}  // namespace gnomon::scene
