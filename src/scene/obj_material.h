#pragma once

#include <gnomon/scene.h>

#include "scene/load_context.h"
#include "scene/load_texture.h"

#include <string>
#include <vector>

namespace gnomon::scene {

/// The materials of the libraries that `mtllib` lines name; of those with the same name, the first.
/// A line is one name, or several separated by blanks. Libraries and pictures that cannot be read
/// are warnings.
std::vector<Material> read_libraries(const std::vector<std::string>& mtllib_lines,
                                     LoadContext& context, std::vector<Texture>& textures);

/// What faces without a material get.
Material default_obj_material();

}  // namespace gnomon::scene
