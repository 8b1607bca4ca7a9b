#pragma once

#include "visibility/light_fit.h"
#include "visibility/map_scroll.h"

#include <cstdint>
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

/// Which instances of a scene move, in all the placements of it that a map has shown: those that
/// have once moved are taken to go on, so that what is left never changes.
class MovingCasters {
public:
    void clear();
    /// Takes in a placement of the same scene; true when more move than before.
    bool add(const Scene& scene);

    bool empty() const { return moving_.empty(); }
    /// By instance: 1 for those that stay, else 0.
    std::span<const std::uint8_t> still() const { return still_; }

    /// Where those are that move, in the order in which changed() wants them.
    std::vector<Mat4> places(const Scene& scene) const;
    /// Texels apart from each other that hold all that those cover now, or covered at `before`,
    /// which are elsewhere now.
    std::vector<TexelRect> changed(const LightFit& fit, const Scene& scene,
                                   std::span<const Mat4> before) const;
    /// By instance: 1 for those that move and can cover some of the texels, else 0.
    std::vector<std::uint8_t> reaching(const LightFit& fit, const Scene& scene,
                                       std::span<const TexelRect> texels) const;

private:
    std::vector<std::uint32_t> moving_;  // rising
    std::vector<std::uint8_t> still_;
};

}  // namespace gnomon
