#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::scene {

/// The files that a scene's file may name: its folder and what is below, and nothing else.
class SceneFiles {
public:
    virtual ~SceneFiles() = default;

    /// The whole file `name`, a relative path with forward slashes.
    /// Throws Error{input} when there is no such file or when it lies outside.
    virtual std::vector<std::uint8_t> read(std::string_view name) const = 0;

    virtual bool exists(std::string_view name) const = 0;
};

/// The folder that `scene_file` lies in. Refuses absolute paths, drive letters and URI schemes,
/// `..` that leads out, and symbolic links that lead out.
class SceneFolder : public SceneFiles {
public:
    explicit SceneFolder(const std::filesystem::path& scene_file);
    std::vector<std::uint8_t> read(std::string_view name) const override;
    bool exists(std::string_view name) const override;

private:
    std::filesystem::path resolve(std::string_view name) const;

    std::filesystem::path root_;  // canonical
};

/// RFC 3986 percent-decoding; a % that begins no code stays as it is.
std::string percent_decoded(std::string_view uri);

/// The bytes of a `data:` URI in base64. Throws Error{input} when it is none or damaged.
std::vector<std::uint8_t> decode_data_uri(std::string_view uri);

bool is_data_uri(std::string_view uri);

}  // namespace gnomon::scene
