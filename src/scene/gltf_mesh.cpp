#include "scene/gltf_mesh.h"

#include "base/check.h"
#include "scene/gltf_accessor.h"

#include <numeric>
#include <utility>

namespace gnomon::scene {

namespace {

constexpr int kNone = -1;

int find_attribute(const std::map<std::string, int>& attributes, const std::string& name) {
    const auto entry = attributes.find(name);
    return entry == attributes.end() ? kNone : entry->second;
}

template <typename Vector>
std::vector<Vector> as_vectors(const std::vector<float>& numbers) {
    constexpr auto kWidth = static_cast<std::size_t>(Vector::length());
    std::vector<Vector> vectors(numbers.size() / kWidth);
    for (std::size_t i = 0; i < vectors.size(); ++i) {
        for (std::size_t c = 0; c < kWidth; ++c)
            vectors[i][static_cast<int>(c)] = numbers[i * kWidth + c];
    }
    return vectors;
}

// A stream besides the positions: empty when it is not there or is of another length.
template <typename Vector>
std::vector<Vector> read_stream(GltfDocument& document,
                                const std::map<std::string, int>& attributes,
                                const std::string& attribute, const Mesh& mesh,
                                Warnings& warnings) {
    const int accessor = find_attribute(attributes, attribute);
    if (accessor == kNone) return {};
    if (accessor_count(document, accessor) != mesh.positions.size()) {
        warnings.add("a vertex attribute of another length than POSITION is left out",
                     fmt::format("{} of \"{}\"", attribute, mesh.name));
        return {};
    }
    return as_vectors<Vector>(read_floats(document, accessor, Vector::length()));
}

std::vector<Vec4> read_colors(GltfDocument& document, const tinygltf::Primitive& primitive,
                              const Mesh& mesh, Warnings& warnings) {
    const std::string kColor = "COLOR_0";
    const int accessor = find_attribute(primitive.attributes, kColor);
    if (accessor == kNone) return {};
    if (accessor_components(document, accessor) != Vec3::length()) {
        return read_stream<Vec4>(document, primitive.attributes, kColor, mesh, warnings);
    }
    const std::vector<Vec3> rgb =
        read_stream<Vec3>(document, primitive.attributes, kColor, mesh, warnings);
    std::vector<Vec4> colors;
    colors.reserve(rgb.size());
    for (const Vec3& color : rgb)
        colors.emplace_back(color, 1.0f);
    return colors;
}

void add_scaled(std::vector<Vec3>& values, const std::vector<Vec3>& deltas, double weight) {
    if (deltas.size() != values.size()) return;
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] += static_cast<float>(weight) * deltas[i];
}

void morph(GltfDocument& document, const tinygltf::Primitive& primitive,
           std::span<const double> weights, Mesh& mesh, Warnings& warnings) {
    if (!primitive.targets.empty() && weights.size() != primitive.targets.size() &&
        !weights.empty()) {
        warnings.add("a mesh has another number of morph weights than of targets", mesh.name);
    }
    const std::size_t count = std::min(weights.size(), primitive.targets.size());
    for (std::size_t i = 0; i < count; ++i) {
        if (weights[i] == 0.0) continue;
        const auto& target = primitive.targets[i];
        add_scaled(mesh.positions, read_stream<Vec3>(document, target, "POSITION", mesh, warnings),
                   weights[i]);
        add_scaled(mesh.normals, read_stream<Vec3>(document, target, "NORMAL", mesh, warnings),
                   weights[i]);
    }
}

std::vector<std::uint32_t> read_corners(GltfDocument& document,
                                        const tinygltf::Primitive& primitive, const Mesh& mesh) {
    if (primitive.indices != kNone) return read_integers(document, primitive.indices);
    std::vector<std::uint32_t> corners(mesh.positions.size());
    std::iota(corners.begin(), corners.end(), 0u);
    return corners;
}

bool has_triangles(int mode) {
    return mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
           mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

}  // namespace

std::vector<UVec3> triangles_from(int mode, const std::vector<std::uint32_t>& corners) {
    std::vector<UVec3> triangles;
    if (corners.size() < 3) return triangles;
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        triangles.reserve(corners.size() / 3);
        for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
            triangles.emplace_back(corners[i], corners[i + 1], corners[i + 2]);
        return triangles;
    }
    triangles.reserve(corners.size() - 2);
    for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
        // glTF 2.0, 3.7.2.1: every second triangle of a strip is turned back.
        const std::size_t odd = i % 2;
        triangles.push_back(mode == TINYGLTF_MODE_TRIANGLE_STRIP
                                ? UVec3(corners[i], corners[i + 1 + odd], corners[i + 2 - odd])
                                : UVec3(corners[i + 1], corners[i + 2], corners[0]));
    }
    return triangles;
}

Mesh read_primitive(GltfDocument& document, const tinygltf::Primitive& primitive,
                    const std::string& name, std::span<const double> morph_weights,
                    int texcoord_set, Warnings& warnings) {
    Mesh mesh;
    mesh.name = name;
    if (!has_triangles(primitive.mode)) {
        warnings.add("points and lines are left out", name);
        return mesh;
    }
    const int positions = find_attribute(primitive.attributes, "POSITION");
    if (positions == kNone) {
        warnings.add("a mesh without positions is left out", name);
        return mesh;
    }
    mesh.positions = as_vectors<Vec3>(read_floats(document, positions, Vec3::length()));
    const std::vector<std::uint32_t> corners = read_corners(document, primitive, mesh);
    if (primitive.mode == TINYGLTF_MODE_TRIANGLES && corners.size() % 3 != 0) {
        warnings.add("corners that make no whole triangle are left out", name);
    }
    document.spend(corners.size() * sizeof(UVec3));
    mesh.triangles = triangles_from(primitive.mode, corners);
    const auto& attributes = primitive.attributes;
    mesh.normals = read_stream<Vec3>(document, attributes, "NORMAL", mesh, warnings);
    mesh.colors = read_colors(document, primitive, mesh, warnings);
    mesh.lightmap_texcoords = read_stream<Vec2>(document, attributes, "TEXCOORD_1", mesh, warnings);
    if (texcoord_set >= 0) {
        const std::string attribute = fmt::format("TEXCOORD_{}", texcoord_set);
        mesh.texcoords = read_stream<Vec2>(document, attributes, attribute, mesh, warnings);
        if (mesh.texcoords.empty()) {
            warnings.add("texture coordinates that a texture needs are not there and become 0",
                         fmt::format("{} of \"{}\"", attribute, name));
            mesh.texcoords.assign(mesh.positions.size(), Vec2(0.0f));
        }
    }
    morph(document, primitive, morph_weights, mesh, warnings);
    return mesh;
}

}  // namespace gnomon::scene
