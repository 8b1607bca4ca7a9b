#pragma once

#include <glm/ext/matrix_float4x4.hpp>
#include <glm/ext/quaternion_float.hpp>
#include <glm/ext/vector_double3.hpp>
#include <glm/ext/vector_float2.hpp>
#include <glm/ext/vector_float3.hpp>
#include <glm/ext/vector_float4.hpp>
#include <glm/ext/vector_uint3.hpp>
#include <glm/geometric.hpp>

#include <limits>

namespace gnomon {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using DVec3 = glm::dvec3;
using UVec3 = glm::uvec3;
using Mat4 = glm::mat4;  // column-major; `target_from_source` maps column vectors

inline constexpr float kPi = 3.14159265358979f;

constexpr float radians(float degrees) {
    return degrees * (kPi / 180.0f);
}
constexpr float degrees(float radians) {
    return radians * (180.0f / kPi);
}
inline Vec3 normalize(Vec3 v) {
    return glm::normalize(v);
}

/// Width and height in pixels or texels.
struct Extent {
    unsigned width = 0;
    unsigned height = 0;
    bool operator==(const Extent&) const = default;
};

/// An axis-aligned box. The default box is empty (min > max) and grows with `include`.
struct Box3 {
    Vec3 min{std::numeric_limits<float>::infinity()};
    Vec3 max{-std::numeric_limits<float>::infinity()};

    bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
    Vec3 center() const { return 0.5f * (min + max); }
    Vec3 size() const { return max - min; }
    float diagonal() const { return empty() ? 0.0f : glm::length(max - min); }
    void include(Vec3 p) {
        min = glm::min(min, p);
        max = glm::max(max, p);
    }
};

}  // namespace gnomon
