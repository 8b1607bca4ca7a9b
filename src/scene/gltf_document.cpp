#include "scene/gltf_document.h"

#include "base/check.h"
#include "scene/gltf_schema.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <utility>

namespace gnomon::scene {

namespace {

using nlohmann::json;

// A scene may need this much memory, and this much more for every byte of its files. The real
// scene that asks for most, a million triangles from one sphere's vertices, asks for 150 times.
constexpr std::uint64_t kFreeBytes = std::uint64_t{256} << 20;
constexpr std::uint64_t kBytesPerFileByte = 256;

constexpr std::uint32_t kGlbMagic = 0x46546C67;  // "glTF"
constexpr std::uint32_t kGlbVersion = 2;
constexpr std::size_t kGlbHeaderBytes = 12;
constexpr std::size_t kGlbChunkHeaderBytes = 8;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN\0"

// Those that are understood, and those that change what surfaces look like but not their shadows.
// All of KHR_materials_ counts among the latter.
constexpr std::array<std::string_view, 7> kSupportedExtensions = {
    "KHR_lights_punctual",
    "EXT_mesh_gpu_instancing",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "EXT_lights_image_based",
};

std::uint32_t read_u32(std::span<const std::uint8_t> bytes, std::size_t offset) {
    // Little-endian whatever the machine is.
    return std::uint32_t{bytes[offset]} | std::uint32_t{bytes[offset + 1]} << 8 |
           std::uint32_t{bytes[offset + 2]} << 16 | std::uint32_t{bytes[offset + 3]} << 24;
}

bool is_glb(std::span<const std::uint8_t> file) {
    return file.size() >= sizeof(kGlbMagic) && read_u32(file, 0) == kGlbMagic;
}

struct GlbChunks {
    std::string_view json;
    std::span<const std::uint8_t> bin;
};

std::span<const std::uint8_t> checked_glb(std::span<const std::uint8_t> file, Warnings& warnings) {
    if (file.size() < kGlbHeaderBytes) fail_input("is cut short within the GLB header");
    const std::uint32_t version = read_u32(file, 4);
    if (version != kGlbVersion) {
        fail_input("is binary glTF of version {}; convert it to version 2", version);
    }
    const std::uint32_t length = read_u32(file, 8);
    if (length > file.size() || length < kGlbHeaderBytes) {
        fail_input("has {} bytes, but its GLB header says {}", file.size(), length);
    }
    if (length < file.size()) warnings.add("bytes after the end of the GLB are ignored");
    return file.first(length);
}

GlbChunks split_glb(std::span<const std::uint8_t> file, Warnings& warnings) {
    file = checked_glb(file, warnings);
    GlbChunks chunks;
    std::size_t offset = kGlbHeaderBytes;
    for (int chunk = 0; offset < file.size(); ++chunk) {
        if (file.size() - offset < kGlbChunkHeaderBytes) {
            fail_input("is cut short within the header of GLB chunk {}", chunk);
        }
        const std::uint32_t length = read_u32(file, offset);
        const std::uint32_t type = read_u32(file, offset + 4);
        offset += kGlbChunkHeaderBytes;
        if (length > file.size() - offset) {
            fail_input("GLB chunk {} has {} bytes, but only {} are left in the file", chunk, length,
                       file.size() - offset);
        }
        const std::span<const std::uint8_t> bytes = file.subspan(offset, length);
        if ((chunk == 0) != (type == kJsonChunk)) {
            fail_input("{}", chunk == 0 ? "its first GLB chunk is not JSON"
                                        : "has a second GLB chunk of JSON");
        }
        if (type == kJsonChunk) {
            chunks.json = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
        } else if (type == kBinChunk && chunk == 1) {
            chunks.bin = bytes;
        } else {
            warnings.add("a GLB chunk of unknown use is ignored");
        }
        offset += length;
    }
    if (chunks.json.data() == nullptr) fail_input("has no GLB chunk of JSON");
    return chunks;
}

void check_version(const json& asset) {
    const auto version = asset.at("version").get<std::string>();
    if (!version.starts_with("2.")) {
        fail_input("is glTF of version \"{}\"; convert it to 2.0", quotable(version));
    }
    if (asset.contains("minVersion")) {
        const auto needed = asset.at("minVersion").get<std::string>();
        if (needed != "2.0") fail_input("needs glTF {}; 2.0 is read", quotable(needed));
    }
}

void check_required_extensions(const json& document) {
    if (!document.contains("extensionsRequired")) return;
    for (const json& element : document.at("extensionsRequired")) {
        const auto name = element.get<std::string>();
        if (name.starts_with("KHR_materials_")) continue;
        if (std::find(kSupportedExtensions.begin(), kSupportedExtensions.end(), name) !=
            kSupportedExtensions.end()) {
            continue;
        }
        fail_input("requires the extension {}, which is not supported; export it without",
                   quotable(name));
    }
}

// Removes and returns the array `name`.
std::unique_ptr<json> taken(json& document, const char* name) {
    auto array = std::make_unique<json>(json::array());
    const auto member = document.find(name);
    if (member == document.end()) return array;
    *array = std::move(*member);
    document.erase(member);
    if (!array->is_array()) fail_input("{}: must be an array", name);
    for (const json& element : *array) {
        if (!element.is_object()) fail_input("{}: must be an array of objects", name);
    }
    return array;
}

tinygltf::Model parse_structure(const json& document) {
    const std::string text = document.dump();
    if (text.size() > std::numeric_limits<unsigned>::max()) fail_input("has too much JSON text");
    tinygltf::TinyGLTF parser;
    tinygltf::Model model;
    std::string errors;
    std::string warnings;
    if (!parser.LoadASCIIFromString(&model, &errors, &warnings, text.data(),
                                    static_cast<unsigned>(text.size()), "", tinygltf::NO_REQUIRE)) {
        fail_input("is not valid glTF: {}", quotable(errors));
    }
    return model;
}

}  // namespace

GltfDocument::~GltfDocument() = default;

GltfDocument::GltfDocument(std::vector<std::uint8_t> file, LoadContext& context)
    : context_(context), file_(std::move(file)) {
    std::string_view text{reinterpret_cast<const char*>(file_.data()), file_.size()};
    if (is_glb(file_)) {
        const GlbChunks chunks = split_glb(file_, context.warnings);
        text = chunks.json;
        bin_chunk_ = chunks.bin;
    }
    json document = parse_gltf_json(text);
    check_gltf_json(document);
    check_version(document.at("asset"));
    check_required_extensions(document);
    buffers_ = taken(document, "buffers");
    images_ = taken(document, "images");
    model_ = parse_structure(document);
    budget_bytes_ = kFreeBytes + kBytesPerFileByte * file_.size();
}

void GltfDocument::spend(std::uint64_t bytes) {
    if (bytes > budget_bytes_) {
        fail_input("asks for more memory than its {} bytes can have use for", file_.size());
    }
    budget_bytes_ -= bytes;
}

std::vector<std::uint8_t> GltfDocument::read_uri(const std::string& uri) {
    return is_data_uri(uri) ? decode_data_uri(uri) : context_.files.read(percent_decoded(uri));
}

std::span<const std::uint8_t> GltfDocument::buffer(int index) {
    const json& buffer = (*buffers_)[static_cast<std::size_t>(index)];
    const auto length = buffer.at("byteLength").get<std::uint64_t>();
    std::span<const std::uint8_t> bytes;
    if (buffer.contains("uri")) {
        const auto [entry, is_new] = loaded_buffers_.try_emplace(index);
        if (is_new) {
            entry->second = read_uri(buffer.at("uri").get<std::string>());
            budget_bytes_ += kBytesPerFileByte * entry->second.size();
        }
        bytes = entry->second;
    } else if (index == 0 && bin_chunk_.data() != nullptr) {
        bytes = bin_chunk_;
    } else {
        fail_input("buffers[{}]: has neither a uri nor a GLB chunk", index);
    }
    if (bytes.size() < length) {
        fail_input("buffers[{}]: has {} bytes of its {}", index, bytes.size(), length);
    }
    return bytes.first(length);
}

std::span<const std::uint8_t> GltfDocument::buffer_view(int index) {
    const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(index)];
    const std::span<const std::uint8_t> bytes = buffer(view.buffer);
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset) {
        fail_input("bufferViews[{}]: reaches beyond the {} bytes of buffers[{}]", index,
                   bytes.size(), view.buffer);
    }
    return bytes.subspan(view.byteOffset, view.byteLength);
}

std::vector<std::uint8_t> GltfDocument::image_bytes(int index) {
    const json& image = (*images_)[static_cast<std::size_t>(index)];
    if (image.contains("uri")) return read_uri(image.at("uri").get<std::string>());
    if (!image.contains("bufferView"))
        fail_input("images[{}]: has neither uri nor bufferView", index);
    const std::span<const std::uint8_t> bytes = buffer_view(image.at("bufferView").get<int>());
    return {bytes.begin(), bytes.end()};
}

std::string GltfDocument::image_name(int index) const {
    const json& image = (*images_)[static_cast<std::size_t>(index)];
    const auto uri = image.find("uri");
    if (uri != image.end() && !is_data_uri(uri->get_ref<const std::string&>())) {
        return quotable(percent_decoded(uri->get_ref<const std::string&>()));
    }
    return fmt::format("images[{}]", index);
}

double number_in(const tinygltf::Value& object, const std::string& member, double otherwise) {
    if (!object.IsObject() || !object.Has(member)) return otherwise;
    const tinygltf::Value& value = object.Get(member);
    return value.IsNumber() ? value.GetNumberAsDouble() : otherwise;
}

const tinygltf::Value* find_extension(const tinygltf::ExtensionMap& extensions,
                                      const std::string& name) {
    const auto entry = extensions.find(name);
    return entry == extensions.end() || !entry->second.IsObject() ? nullptr : &entry->second;
}

}  // namespace gnomon::scene
