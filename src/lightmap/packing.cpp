// Skyline packing by Sean Barrett's stb_rect_pack.h, after J. Jylanki, "A Thousand Ways to Pack the
// Bin", 2010. Ours is the choice of the pages' sizes.

#include "lightmap/packing.h"

#define STB_RECT_PACK_IMPLEMENTATION
#define STBRP_STATIC
#include <stb_rect_pack.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace gnomon::lightmap {

namespace {

/// A page that proved too small grows by this: a try costs more than the texels it could save.
constexpr double kGrowth = 1.02;

/// More pages must leave this part of the texels or less: a mesh is cut where its pages part.
constexpr double kWorthMorePages = 0.8;
/// And there must be no more than these, no smaller than this part of the largest size: small maps
/// are best on one page, whatever it leaves empty.
constexpr std::size_t kMostSmallPages = 4;
constexpr unsigned kLeastSmallPage = 8;

unsigned whole_blocks(double side) {
    return kPageStep * static_cast<unsigned>(std::ceil(side / kPageStep));
}

/// True when all of them found room.
bool try_pack(std::vector<stbrp_rect>& rectangles, unsigned side) {
    std::vector<stbrp_node> nodes(side);
    stbrp_context context;
    const int length = static_cast<int>(side);
    stbrp_init_target(&context, length, length, nodes.data(), length);
    return stbrp_pack_rects(&context, rectangles.data(), static_cast<int>(rectangles.size())) != 0;
}

/// Packs all of them on the smallest page, or as many as the largest one holds. Returns its side.
unsigned fill_page(std::vector<stbrp_rect>& rectangles, unsigned max_side) {
    double area = 0.0;
    int longest = 0;
    for (const stbrp_rect& r : rectangles) {
        area += static_cast<double>(r.w) * r.h;
        longest = std::max({longest, static_cast<int>(r.w), static_cast<int>(r.h)});
    }
    const unsigned largest = max_side / kPageStep * kPageStep;
    unsigned side = whole_blocks(std::max(std::sqrt(area), static_cast<double>(longest)));
    while (side < largest && !try_pack(rectangles, side))
        side = std::max(side + kPageStep, whole_blocks(kGrowth * side));
    if (side < largest) return side;
    try_pack(rectangles, largest);
    return largest;
}

/// On pages of up to `max_side`.
Packing pack_below(const std::vector<stbrp_rect>& rectangles, unsigned max_side) {
    Packing result;
    result.placements.resize(rectangles.size());
    std::vector<stbrp_rect> rest = rectangles;
    while (!rest.empty()) {
        const auto page = static_cast<std::uint32_t>(result.page_sides.size());
        result.page_sides.push_back(fill_page(rest, max_side));
        [[maybe_unused]] const std::size_t before = rest.size();
        std::erase_if(rest, [&](const stbrp_rect& r) {
            if (r.was_packed == 0) return false;
            result.placements[static_cast<std::size_t>(r.id)] = {page, static_cast<unsigned>(r.x),
                                                                 static_cast<unsigned>(r.y)};
            return true;
        });
        assert(rest.size() < before);
    }
    return result;
}

double texels(const Packing& packing) {
    return std::accumulate(packing.page_sides.begin(), packing.page_sides.end(), 0.0,
                           [](double sum, double side) { return sum + side * side; });
}

}  // namespace

Packing pack(const std::vector<Extent>& rectangles, unsigned padding, unsigned max_side) {
    std::vector<stbrp_rect> padded(rectangles.size());
    unsigned longest = 0;
    double area = 0.0;
    for (std::size_t i = 0; i < padded.size(); ++i) {
        const unsigned width = rectangles[i].width + padding;
        const unsigned height = rectangles[i].height + padding;
        padded[i].id = static_cast<int>(i);
        padded[i].w = static_cast<stbrp_coord>(width);
        padded[i].h = static_cast<stbrp_coord>(height);
        longest = std::max({longest, width, height});
        area += static_cast<double>(width) * height;
    }
    Packing large = pack_below(padded, max_side);
    const unsigned small_side = whole_blocks(longest);
    const double enough = kWorthMorePages * texels(large);
    if (small_side > max_side || kLeastSmallPage * small_side < max_side || area > enough) {
        return large;
    }
    Packing small = pack_below(padded, small_side);
    return small.page_sides.size() <= kMostSmallPages && texels(small) <= enough ? small : large;
}

}  // namespace gnomon::lightmap
