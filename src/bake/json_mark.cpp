#include "bake/json_mark.h"

#include <gnomon/error.h>

#include "base/file.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <vector>

namespace gnomon::bake {

bool is_json_with(const std::filesystem::path& path, std::string_view key) {
    constexpr std::uint64_t kMostBytes = std::uint64_t{64} << 20;
    try {
        const std::vector<std::uint8_t> bytes = read_file(path, kMostBytes);
        const nlohmann::json json = nlohmann::json::parse(bytes, nullptr, false);
        return json.is_object() && json.contains(key);
    } catch (const Error&) {
        return false;  // missing, a folder, unreadable: not ours
    }
}

}  // namespace gnomon::bake
