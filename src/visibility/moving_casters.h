#pragma once

#include "visibility/light_fit.h"
#include "visibility/map_scroll.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gnomon {

/// The texels of a map that a box can cover once it is placed, and a few around them for rounding;
/// of no area when there are none.
TexelRect covered_texels(const LightFit& fit, const Mat4& world_from_local, const Box3& local);

/// The smallest rectangle that holds all of these, of which there is one at least.
TexelRect around(std::span<const TexelRect> rects);

/// Rectangles that hold these and do not overlap; few.
std::vector<TexelRect> apart(std::span<const TexelRect> rects);

/// Where a caster is, and what it is.
struct CasterPlace {
    Mat4 world_from_local{1.0f};
    Box3 local;               ///< around its triangles
    std::uint32_t shape = 0;  ///< another number for other triangles

    bool same_as(const CasterPlace& other) const {
        return world_from_local == other.world_from_local && shape == other.shape;
    }
};

/// Which instances of a scene move, in all the scenes that a map has shown: those that have once
/// moved, or changed their shape, are taken to go on, so that what is left never changes.
class MovingCasters {
public:
    void clear();
    /// Takes in the next scene: another placement of the last one, or one whose casters are alike
    /// but for some, as another pose of the same file. False where other casters are left than
    /// before; of a scene that has nothing in common with the last one all are that it does not
    /// name itself.
    bool follow(const Scene& scene);

    bool empty() const { return moving_.empty(); }
    /// By instance: 1 for those that stay, else 0; empty when all stay.
    std::span<const std::uint8_t> still() const { return still_; }

    /// Those that move in the scene that was taken in last, in the order in which changed() wants
    /// them.
    std::vector<CasterPlace> places() const;
    /// Texels apart from each other that hold all that those cover now, or covered `before`, which
    /// were elsewhere then or of another shape.
    std::vector<TexelRect> changed(const LightFit& fit, std::span<const CasterPlace> before) const;
    /// By instance: 1 for those that move and can cover some of the texels, else 0.
    std::vector<std::uint8_t> reaching(const LightFit& fit,
                                       std::span<const TexelRect> texels) const;

private:
    std::vector<std::uint32_t> changes(const Scene& scene);

    std::optional<Scene> scene_;         // the last
    std::vector<std::uint32_t> moving_;  // rising
    std::vector<std::uint8_t> still_;
    std::vector<std::uint32_t> shapes_;  // by instance
};

}  // namespace gnomon
