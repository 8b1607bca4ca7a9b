// H. S. Warren, "Hacker's Delight", 2nd edition (2013), section 7-3, for 64 bits and the lowest
// first: swaps the off-diagonal quarters of ever smaller squares. After each round the words are
// riffled like the two halves of a pack of cards, so that those to be compared are always half a
// pack apart, and registers hold neighbours; six riffles restore the order.

#include "interval/mask.h"

#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "interval/transpose.cpp"
// Those of walk.cpp.
#define HWY_DISABLED_TARGETS \
    (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace gnomon::interval::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void transpose_words(std::uint64_t* bits) {
    constexpr std::size_t kHalf = 32;
    const hn::CappedTag<std::uint64_t, 8> words;
    alignas(64) std::uint64_t riffled[2 * kHalf];
    std::uint64_t *from = bits, *to = riffled;
    std::uint64_t low_half = 0x00000000ffffffff;
    for (int half = kHalf; half != 0; half /= 2, low_half ^= low_half << half) {
        const auto low = hn::Set(words, low_half);
        for (std::size_t i = 0; i < kHalf; i += hn::Lanes(words)) {
            const auto a = hn::LoadU(words, from + i), b = hn::LoadU(words, from + kHalf + i);
            const auto swapped = hn::And(hn::Xor(hn::ShiftRightSame(a, half), b), low);
            hn::StoreInterleaved2(hn::Xor(a, hn::ShiftLeftSame(swapped, half)), hn::Xor(b, swapped),
                                  words, to + 2 * i);
        }
        std::swap(from, to);
    }
}

}  // namespace gnomon::interval::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace gnomon::interval {

HWY_EXPORT(transpose_words);

void transpose(std::span<std::uint64_t, 64> bits) {
    HWY_DYNAMIC_DISPATCH(transpose_words)(bits.data());
}

}  // namespace gnomon::interval
#endif
