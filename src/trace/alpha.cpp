#include "trace/alpha.h"

#include <algorithm>
#include <cmath>

namespace gnomon::trace {

namespace {

constexpr float kAlphaOfByte = 1.0f / 255.0f;

/// `coordinate` brought near [0, 1) by whole periods of the wrap mode, so that it fits an int once
/// it is in texels.
float reduce(float coordinate, TextureWrap wrap) {
    if (!std::isfinite(coordinate)) return 0.0f;
    switch (wrap) {
        case TextureWrap::repeat:
            return coordinate - std::floor(coordinate);
        case TextureWrap::mirror:
            return coordinate - 2.0f * std::floor(0.5f * coordinate);
        case TextureWrap::clamp:
            return std::clamp(coordinate, 0.0f, 1.0f);
    }
    return 0.0f;
}

/// The texel that `index` means, in [0, size).
int wrapped(int index, int size, TextureWrap wrap) {
    const auto modulo = [](int a, int b) { return ((a % b) + b) % b; };
    if (wrap == TextureWrap::repeat) return modulo(index, size);
    if (wrap == TextureWrap::clamp) return std::clamp(index, 0, size - 1);
    const int in_period = modulo(index, 2 * size);
    return std::min(in_period, 2 * size - 1 - in_period);
}

/// The two texels around a coordinate, and how far it is from the first to the second.
struct Footprint {
    int first, second;
    float fraction;
};

Footprint footprint(float coordinate, int size, TextureWrap wrap) {
    const float texels = reduce(coordinate, wrap) * static_cast<float>(size) - 0.5f;
    const float below = std::floor(texels);
    const int index = static_cast<int>(below);
    return {wrapped(index, size, wrap), wrapped(index + 1, size, wrap), texels - below};
}

}  // namespace

float texture_alpha(const Texture& texture, Vec2 uv) {
    const int width = static_cast<int>(texture.size.width);
    const int height = static_cast<int>(texture.size.height);
    if (width == 0 || height == 0) return 1.0f;
    const Footprint x = footprint(uv.x, width, texture.wrap_u);
    const Footprint y = footprint(uv.y, height, texture.wrap_v);
    const auto texel = [&](int column, int row) {
        const std::size_t index =
            static_cast<std::size_t>(row) * texture.size.width + static_cast<std::size_t>(column);
        return kAlphaOfByte * static_cast<float>(texture.rgba[4 * index + 3]);
    };
    return std::lerp(std::lerp(texel(x.first, y.first), texel(x.second, y.first), x.fraction),
                     std::lerp(texel(x.first, y.second), texel(x.second, y.second), x.fraction),
                     y.fraction);
}

float surface_alpha(const Scene& scene, const Mesh& mesh, std::uint32_t primitive, float u,
                    float v) {
    const Material& material = scene.materials()[mesh.material];
    const UVec3 corners = mesh.triangles[primitive];
    const auto interpolate = [&](const auto& stream) {
        return (1.0f - u - v) * stream[corners.x] + u * stream[corners.y] + v * stream[corners.z];
    };
    float alpha = material.base_color.a;
    if (!mesh.colors.empty()) alpha *= interpolate(mesh.colors).a;
    if (material.base_color_texture >= 0) {
        const Vec2 texcoord = mesh.texcoords.empty() ? Vec2(0.0f) : interpolate(mesh.texcoords);
        const Vec2 uv = material.uv_scale_rotation * texcoord + material.uv_offset;
        alpha *= texture_alpha(scene.textures()[material.base_color_texture], uv);
    }
    return alpha;
}

bool is_hole(const Scene& scene, const Mesh& mesh, std::uint32_t primitive, float u, float v) {
    const float cutoff = scene.materials()[mesh.material].alpha_cutoff;
    return cutoff > 0.0f && surface_alpha(scene, mesh, primitive, u, v) < cutoff;
}

}  // namespace gnomon::trace
