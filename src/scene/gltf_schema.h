#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string_view>

namespace gnomon::scene {

/// The text as JSON. Throws Error{input}: not JSON, not an object, nested too deeply.
nlohmann::json parse_gltf_json(std::string_view text);

/// Checks that what the loader reads of a glTF document has the type that the specification asks
/// for and that indices refer to something, so that the parser behind, which passes over faults in
/// silence, finds none. Whole numbers written with a fraction (3.0) are made integers.
/// Throws Error{input} naming the place ("nodes[3].mesh") and the fault.
void check_gltf_json(nlohmann::json& document);

}  // namespace gnomon::scene
