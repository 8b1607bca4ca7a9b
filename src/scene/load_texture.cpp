#include "scene/load_texture.h"

#include <gnomon/error.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gnomon::scene {

namespace {

constexpr std::uint8_t kOpaque = 255;
constexpr std::size_t kChannels = 4;
constexpr std::size_t kAlpha = 3;

bool has_alpha(const image::Rgba8& picture) {
    for (std::size_t i = kAlpha; i < picture.rgba.size(); i += kChannels) {
        if (picture.rgba[i] != kOpaque) return true;
    }
    return false;
}

// The two texels that a sample of the scaled picture lies between, and how far from the first.
struct Tap {
    unsigned first, second;
    float weight;
};

Tap tap(unsigned target, unsigned target_count, unsigned source_count) {
    const float center = (static_cast<float>(target) + 0.5f) * static_cast<float>(source_count) /
                             static_cast<float>(target_count) -
                         0.5f;
    const float clamped = std::clamp(center, 0.0f, static_cast<float>(source_count - 1));
    const auto first = static_cast<unsigned>(clamped);
    return {first, std::min(first + 1, source_count - 1), clamped - static_cast<float>(first)};
}

// Bilinear.
image::Rgba8 scaled(const image::Rgba8& source, Extent size) {
    if (source.size == size) return source;
    image::Rgba8 result{
        size, std::vector<std::uint8_t>(std::size_t{size.width} * size.height * kChannels)};
    const auto at = [&](unsigned x, unsigned y, std::size_t channel) {
        return static_cast<float>(
            source.rgba[(std::size_t{y} * source.size.width + x) * kChannels + channel]);
    };
    std::size_t out = 0;
    for (unsigned y = 0; y < size.height; ++y) {
        const Tap v = tap(y, size.height, source.size.height);
        for (unsigned x = 0; x < size.width; ++x) {
            const Tap u = tap(x, size.width, source.size.width);
            for (std::size_t c = 0; c < kChannels; ++c) {
                const float top =
                    std::lerp(at(u.first, v.first, c), at(u.second, v.first, c), u.weight);
                const float bottom =
                    std::lerp(at(u.first, v.second, c), at(u.second, v.second, c), u.weight);
                result.rgba[out++] =
                    static_cast<std::uint8_t>(std::lround(std::lerp(top, bottom, v.weight)));
            }
        }
    }
    return result;
}

float least_alpha(const Material& material, const std::vector<Texture>& textures) {
    if (material.base_color_texture < 0) return material.base_color.a;
    const Texture& texture = textures[static_cast<std::size_t>(material.base_color_texture)];
    std::uint8_t least = kOpaque;
    for (std::size_t i = kAlpha; i < texture.rgba.size(); i += kChannels) {
        least = std::min(least, texture.rgba[i]);
    }
    return material.base_color.a * static_cast<float>(least) / static_cast<float>(kOpaque);
}

}  // namespace

int TextureShelf::get(const std::string& key, const std::function<Texture()>& make) {
    const auto [entry, is_new] = indices_.try_emplace(key, -1);
    if (!is_new) return entry->second;
    try {
        textures_.push_back(make());
        entry->second = static_cast<int>(textures_.size()) - 1;
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::input) throw;
        warnings_.add("a texture cannot be read and is left out", error.what());
    }
    return entry->second;
}

image::Rgba8 with_mask(const image::Rgba8& color, const image::Rgba8& mask) {
    const Extent size{std::max(color.size.width, mask.size.width),
                      std::max(color.size.height, mask.size.height)};
    image::Rgba8 result = scaled(color, size);
    const image::Rgba8 alpha = scaled(mask, size);
    const bool alpha_counts = has_alpha(mask);
    for (std::size_t i = 0; i < result.rgba.size(); i += kChannels) {
        const unsigned grey =
            (unsigned{alpha.rgba[i]} + alpha.rgba[i + 1] + alpha.rgba[i + 2] + 1) / 3;
        result.rgba[i + kAlpha] =
            alpha_counts ? alpha.rgba[i + kAlpha] : static_cast<std::uint8_t>(grey);
    }
    return result;
}

void solidify_idle_masks(std::vector<Material>& materials, const std::vector<Texture>& textures,
                         const std::vector<Mesh>& meshes) {
    std::vector<float> least(materials.size(), 1.0f);  // vertex alpha
    for (const Mesh& mesh : meshes) {
        for (const Vec4& color : mesh.colors) {
            least[mesh.material] = std::min(least[mesh.material], color.a);
        }
    }
    for (std::size_t i = 0; i < materials.size(); ++i) {
        if (!materials[i].masked()) continue;
        if (least[i] * least_alpha(materials[i], textures) >= materials[i].alpha_cutoff) {
            materials[i].alpha_cutoff = 0.0f;
        }
    }
}

}  // namespace gnomon::scene
