#pragma once

#include "scene/load_context.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// The parser gets text only: neither files nor pictures.
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

namespace gnomon::scene {

/// A glTF file whose structure is checked: types are right and indices refer to something. What its
/// accessors say about their bytes is not checked here but where they are read (gltf_accessor.h).
///
/// tinygltf parses the structure. What names files, "buffers" and "images", never reaches it: it is
/// read here, when it is needed, and through SceneFiles only.
class GltfDocument {
public:
    /// `file` is text or a binary container, told apart by its first bytes.
    /// Throws Error{input}: damaged, another version, or requires an extension that we lack.
    GltfDocument(std::vector<std::uint8_t> file, LoadContext& context);
    ~GltfDocument();
    GltfDocument(const GltfDocument&) = delete;
    GltfDocument& operator=(const GltfDocument&) = delete;

    const tinygltf::Model& model() const { return model_; }

    /// The bytes of a buffer view. Throws Error{input} when the view is larger than its buffer or
    /// the buffer cannot be read.
    std::span<const std::uint8_t> buffer_view(int index);

    /// The encoded picture `index` of "images", and a name for messages.
    std::vector<std::uint8_t> image_bytes(int index);
    std::string image_name(int index) const;

    /// To be called before `bytes` are allocated for what the document asks for. Throws
    /// Error{input} when its demands are out of proportion to its size, as only those of a
    /// malicious or damaged file are.
    void spend(std::uint64_t bytes);

private:
    std::span<const std::uint8_t> buffer(int index);
    std::vector<std::uint8_t> read_uri(const std::string& uri);

    LoadContext& context_;
    std::vector<std::uint8_t> file_;
    std::span<const std::uint8_t> bin_chunk_;
    std::unique_ptr<nlohmann::json> buffers_, images_;
    std::map<int, std::vector<std::uint8_t>> loaded_buffers_;
    tinygltf::Model model_;
    std::uint64_t budget_bytes_ = 0;
};

/// A member of an extension's object; `otherwise` when it is not there or no number.
double number_in(const tinygltf::Value& object, const std::string& member, double otherwise);

/// The extension `name` among `extensions`, or nullptr.
const tinygltf::Value* find_extension(const tinygltf::ExtensionMap& extensions,
                                      const std::string& name);

}  // namespace gnomon::scene
