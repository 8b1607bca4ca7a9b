#include "scene/load_files.h"

#include "base/check.h"
#include "base/file.h"
#include "scene/load_context.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <system_error>

namespace gnomon::scene {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{4} << 30;

// "file:", "http:", and also "C:".
bool has_scheme(std::string_view name) {
    const std::size_t colon = name.find(':');
    if (colon == std::string_view::npos || colon == 0) return false;
    return std::all_of(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(colon), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '+' || c == '-' || c == '.';
    });
}

bool is_inside(const fs::path& path, const fs::path& root) {
    const auto mismatch = std::mismatch(root.begin(), root.end(), path.begin(), path.end());
    return mismatch.first == root.end();
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

constexpr std::uint8_t kNotBase64 = 0xFF;

constexpr std::array<std::uint8_t, 256> make_base64_values() {
    constexpr std::string_view kAlphabet =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<std::uint8_t, 256> values{};
    values.fill(kNotBase64);
    for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
        values[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::uint8_t>(i);
    }
    return values;
}

constexpr std::array<std::uint8_t, 256> kBase64Values = make_base64_values();

std::vector<std::uint8_t> decode_base64(std::string_view text) {
    while (!text.empty() && text.back() == '=')
        text.remove_suffix(1);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    int bit_count = 0;
    for (const char c : text) {
        const std::uint8_t value = kBase64Values[static_cast<unsigned char>(c)];
        if (value == kNotBase64) fail_input("data: URI is not base64");
        bits = (bits << 6) | value;
        bit_count += 6;
        if (bit_count >= 8) {
            bit_count -= 8;
            bytes.push_back(static_cast<std::uint8_t>(bits >> bit_count));
        }
    }
    return bytes;
}

}  // namespace

SceneFolder::SceneFolder(const fs::path& scene_file) {
    std::error_code error;
    const fs::path parent = scene_file.parent_path();
    root_ = fs::canonical(parent.empty() ? fs::path(".") : parent, error);
    if (error) fail_input("{}: {}", scene_file.string(), error.message());
}

fs::path SceneFolder::resolve(std::string_view name) const {
    const std::string shown = quotable(name);
    if (name.empty() || name.find('\0') != std::string_view::npos) {
        fail_input("\"{}\": is not a file name", shown);
    }
    if (has_scheme(name)) fail_input("\"{}\": only files and data: URIs are read", shown);
    const fs::path relative = fs::path(name).lexically_normal();
    if (relative.is_absolute() || *relative.begin() == "..") {
        fail_input("\"{}\": lies outside the scene's folder, which is all that is read", shown);
    }
    std::error_code error;
    fs::path path = fs::weakly_canonical(root_ / relative, error);
    if (error) fail_input("\"{}\": {}", shown, error.message());
    if (!is_inside(path, root_)) {
        fail_input("\"{}\": is a link that leads out of the scene's folder", shown);
    }
    return path;
}

std::vector<std::uint8_t> SceneFolder::read(std::string_view name) const {
    const fs::path path = resolve(name);
    std::error_code error;
    if (!fs::is_regular_file(path, error)) fail_input("\"{}\": no such file", quotable(name));
    return read_file(path, kMaxFileBytes);
}

bool SceneFolder::exists(std::string_view name) const {
    try {
        std::error_code error;
        return fs::is_regular_file(resolve(name), error);
    } catch (const Error&) {
        return false;
    }
}

std::string percent_decoded(std::string_view uri) {
    std::string decoded;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const int high = uri[i] == '%' && i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
        const int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
        if (low >= 0) {
            decoded += static_cast<char>(high * 16 + low);
            i += 2;
        } else {
            decoded += uri[i];
        }
    }
    return decoded;
}

bool is_data_uri(std::string_view uri) {
    return uri.starts_with("data:");
}

std::vector<std::uint8_t> decode_data_uri(std::string_view uri) {
    constexpr std::string_view kMarker = ";base64,";
    const std::size_t comma = uri.find(',');
    if (!is_data_uri(uri) || comma == std::string_view::npos ||
        !uri.substr(0, comma + 1).ends_with(kMarker)) {
        fail_input("\"{}\": is not a data: URI in base64", quotable(uri, 40));
    }
    return decode_base64(uri.substr(comma + 1));
}

}  // namespace gnomon::scene
