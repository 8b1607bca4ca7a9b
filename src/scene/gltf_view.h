#pragma once

#include "scene/gltf_document.h"
#include "scene/load_draft.h"

#include <glm/ext/matrix_double4x4.hpp>

#include <span>

namespace gnomon::scene {

/// The cameras and the lights of `nodes`, at their places, into the draft.
void read_cameras_and_lights(const GltfDocument& document, std::span<const int> nodes,
                             std::span<const glm::dmat4> world_from_node, LoadContext& context,
                             Draft& draft);

}  // namespace gnomon::scene
