#pragma once

#include <gnomon/math.h>

#include <cstdint>
#include <vector>

namespace gnomon::lightmap {

struct Placement {
    std::uint32_t page = 0;
    unsigned x = 0, y = 0;
};

struct Packing {
    std::vector<Placement> placements;  ///< one per rectangle
    std::vector<unsigned> page_sides;   ///< multiples of kPageStep
};

/// Pages are whole 4x4 blocks, as compressed textures have them.
inline constexpr unsigned kPageStep = 4;

/// Places rectangles on square pages as small as the packer manages: on one, or as many as they
/// need of the largest size; but on up to four of the longest rectangle's size where that leaves a
/// fifth fewer texels, as two squares would leave half of one page empty. `padding` texels between
/// them stay clear, across a page's opposite borders too, so that maps may repeat. No rectangle
/// plus its padding is larger than `max_side`.
Packing pack(const std::vector<Extent>& rectangles, unsigned padding, unsigned max_side);

}  // namespace gnomon::lightmap
