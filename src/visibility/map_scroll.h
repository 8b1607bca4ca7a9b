#pragma once

#include "visibility/light_fit.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace gnomon {

/// A rectangle of a map's texels; y points down the image.
struct TexelRect {
    int x = 0, y = 0;
    unsigned width = 0, height = 0;

    std::uint64_t area() const { return std::uint64_t{width} * height; }
    bool operator==(const TexelRect&) const = default;
};

/// All of a square map.
constexpr TexelRect whole_map(unsigned size_texels) {
    return {0, 0, size_texels, size_texels};
}

/// How a map becomes one a few whole texels away.
struct MapScroll {
    int x_texels = 0, y_texels = 0;  ///< by how much what is in the map moves
    TexelRect stays;                 ///< what of the new map is in the old one
    std::vector<TexelRect> comes;    ///< the rest of it: none, one strip or two, apart
    /// What the new map holds: the old fit, moved by whole texels. It differs from the one that was
    /// asked for by rounding, which so cannot add up from frame to frame.
    LightFit fit;
};

/// None where the maps have not the same texels and depths, or not one in common. Maps of a light
/// at infinity that fit_directional_stable() made scroll while the light, the lens and the
/// distances stay; of others, those that rest.
std::optional<MapScroll> scroll(const LightFit& before, const LightFit& after);

}  // namespace gnomon
