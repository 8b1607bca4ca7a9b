#pragma once

#include "scene/load_draft.h"

#include <cstdint>
#include <vector>

namespace gnomon::scene {

/// Reads a Wavefront OBJ file and the MTL files and pictures that it names. docs/input.md says what
/// is read and which faults are tolerated. Throws Error{input} naming the fault.
Draft load_obj(std::vector<std::uint8_t> file, LoadContext& context);

}  // namespace gnomon::scene
