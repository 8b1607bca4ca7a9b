#pragma once

#include "scene/load_draft.h"

#include <cstdint>
#include <vector>

namespace gnomon::scene {

/// Reads a glTF 2.0 file, text or binary. docs/input.md says what is read and which faults are
/// tolerated. Throws Error{input} naming the place in the document and the fault.
Draft load_gltf(std::vector<std::uint8_t> file, LoadContext& context);

}  // namespace gnomon::scene
