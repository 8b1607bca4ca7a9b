#pragma once

#include "gpu/device_test.h"
#include "raster/receivers.h"

#include <glm/ext/vector_uint2.hpp>
#include <glm/packing.hpp>

#include <cmath>

namespace gnomon::raster {

/// The vector that octahedral.glsl packed.
inline Vec3 unpack_unit_vector(std::uint32_t bits) {
    const Vec2 p = glm::unpackSnorm2x16(bits);
    Vec3 v(p, 1.0f - std::abs(p.x) - std::abs(p.y));
    if (v.z < 0.0f) {
        v.x = std::copysign(1.0f - std::abs(p.y), p.x);
        v.y = std::copysign(1.0f - std::abs(p.x), p.y);
    }
    return normalize(v);
}

/// Receivers on the host, row by row.
struct Drawn {
    Extent size;
    Mat4 world_from_clip{1.0f};
    std::vector<glm::uvec2> ids;
    std::vector<float> depths;
    std::vector<std::uint32_t> packed_normals;

    std::size_t index(unsigned x, unsigned y) const { return std::size_t{y} * size.width + x; }
    std::uint32_t instance(unsigned x, unsigned y) const { return ids[index(x, y)].x; }
    float depth(unsigned x, unsigned y) const { return depths[index(x, y)]; }
    Vec3 normal_ws(unsigned x, unsigned y) const {
        return unpack_unit_vector(packed_normals[index(x, y)]);
    }
    /// As visibility/receiver.glsl computes it.
    Vec3 position_ws(unsigned x, unsigned y) const {
        const Vec2 center = Vec2(x, y) + 0.5f;
        const Vec2 ndc = 2.0f * center / Vec2(size.width, size.height) - 1.0f;
        const Vec4 p = world_from_clip * Vec4(ndc, depth(x, y), 1.0f);
        return Vec3(p) / p.w;
    }
};

inline Drawn read_back(const gpu::Device& device, Receivers& receivers) {
    return {.size = receivers.size,
            .world_from_clip = receivers.world_from_clip(),
            .ids = gpu::read_back<glm::uvec2>(device, receivers.ids),
            .depths = gpu::read_back<float>(device, receivers.depth),
            .packed_normals = gpu::read_back<std::uint32_t>(device, receivers.normals)};
}

}  // namespace gnomon::raster
