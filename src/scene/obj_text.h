#pragma once

#include <glm/ext/vector_double3.hpp>
#include <glm/ext/vector_float2.hpp>
#include <glm/ext/vector_float3.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace gnomon::scene {

/// Where a corner of a face has its values; kNoIndex where it has none.
struct ObjCorner {
    static constexpr std::uint32_t kNoIndex = 0xFFFFFFFF;
    std::uint32_t position = kNoIndex;
    std::uint32_t texcoord = kNoIndex;
    std::uint32_t normal = kNoIndex;
    bool operator==(const ObjCorner&) const = default;
};

/// A polygon of corners [first_corner, first_corner + corner_count).
struct ObjFace {
    std::size_t first_corner = 0;
    std::uint32_t corner_count = 0;
    std::uint32_t object = 0;    // into ObjText::objects
    std::uint32_t material = 0;  // into ObjText::materials
};

/// An OBJ file as it is written: indices resolved, but not checked against the lists' lengths.
struct ObjText {
    std::vector<glm::dvec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<glm::vec2> texcoords;  // (0, 0) = bottom left, as in the file
    std::vector<ObjCorner> corners;
    std::vector<ObjFace> faces;
    std::vector<std::string> objects;    // names of groups and objects
    std::vector<std::string> materials;  // names that usemtl lines give; [0] = "" = none yet
    std::vector<std::string> libraries;  // what mtllib lines say
};

/// Parses the text. Throws Error{input} when it is UTF-16 or holds no vertex.
ObjText parse_obj(std::vector<std::uint8_t> file);

/// Without white space at both ends.
std::string trimmed(std::string_view text);

}  // namespace gnomon::scene
