#pragma once

#include "scene/gltf_document.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace gnomon::scene {

/// The number of an accessor's elements.
std::size_t accessor_count(const GltfDocument& document, int accessor);

/// Numbers in an element: 1 for SCALAR to 16 for MAT4.
int accessor_components(const GltfDocument& document, int accessor);

/// All elements, accessor_components() values each, in order: sparse ones put in, normalised
/// integers divided. Throws Error{input} naming the accessor when its bytes are not there, its type
/// is not one, or it does not have `components` (0 = any).
std::vector<float> read_floats(GltfDocument& document, int accessor, int components = 0);

/// All elements of a SCALAR accessor of unsigned integers, or of one with `components` of them.
std::vector<std::uint32_t> read_integers(GltfDocument& document, int accessor, int components = 1);

}  // namespace gnomon::scene
