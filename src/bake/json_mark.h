#pragma once

#include <filesystem>
#include <string_view>

namespace gnomon::bake {

/// Whether `path` is a JSON object that has `key`, by which our folders are known.
bool is_json_with(const std::filesystem::path& path, std::string_view key);

}  // namespace gnomon::bake
