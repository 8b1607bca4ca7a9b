// Which texels of a tile triangles darken at a step, one by one. Compiled once for each instruction
// set: see walk.cpp.
//
// Most triangles that may darken some texels are smaller than the tile, and pass between its texels
// or over those that are dark already: nine in ten beneath a tree. So the rectangle around each
// triangle's shadow in the tile comes first, for a register of triangles at a time, and the texels
// only of those that have lit ones in it.

#if defined(GNOMON_INTERVAL_PAIRS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GNOMON_INTERVAL_PAIRS_INL_H
#undef GNOMON_INTERVAL_PAIRS_INL_H
#else
#define GNOMON_INTERVAL_PAIRS_INL_H
#endif

#include "interval/leaf.inl.h"

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace gnomon::interval::HWY_NAMESPACE {

/// Relative to all that is added up: what computing a shadow's corners errs, with room for that of
/// its determinant.
inline constexpr float kCornerError = 1e-4f;
/// A determinant that is smaller, relative to its products, tells too little: its roundings are
/// more than a third of kCornerError.
inline constexpr float kLeastDeterminant = 1.0f / 256.0f;
/// Float holds no small relative errors below.
inline constexpr float kLeastNormal = 1e-30f;

/// Of a coordinate in [-1, 1]; others are put into the nearest.
HWY_INLINE Vf strips_of(Vf coordinate) {
    constexpr float kHalf = 0.5f * Strips::kCount;
    const Vf strip = hn::MulAdd(coordinate, splat(kHalf), splat(kHalf));
    return hn::Min(hn::Max(strip, splat(0.0f)), splat(float{Strips::kCount - 1}));
}

HWY_INLINE void set_strips(Strips& strips, const float* coordinates, int texels) {
    std::uint64_t in[Strips::kCount] = {};
    alignas(64) std::int32_t strip[kLanes];
    for (int first = 0; first < texels; first += kLanes) {
        hn::Store(hn::ConvertTo(Ints(), strips_of(load(coordinates + first))), Ints(), strip);
        for (int lane = 0; lane < kLanes && first + lane < texels; ++lane)
            in[strip[lane]] |= std::uint64_t{1} << (first + lane);
    }
    std::uint64_t before = 0, after = 0;
    for (int i = 0; i < Strips::kCount; ++i) {
        strips.to[i] = before |= in[i];
        strips.from[Strips::kCount - 1 - i] = after |= in[Strips::kCount - 1 - i];
    }
}

HWY_INLINE void set_strips(Tile& tile) {
    set_strips(tile.strips_s, tile.s, tile.texels);
    set_strips(tile.strips_t, tile.t, tile.texels);
}

/// Strips that triangles' shadows reach, first to last.
struct Reach {
    alignas(64) std::int32_t first_s[kLanes], last_s[kLanes], first_t[kLanes], last_t[kLanes];
};

/// The corners of the triangle u >= 0, v >= 0, u + v <= det in s and t, by Cramer's rule; moved out
/// by what the terms err, and by what this errs.
HWY_INLINE void find_reach(const Pairs& pairs, int first, Reach& reach) {
    const auto term = [&](int index)
                          HWY_ATTR { return hn::LoadU(Floats(), pairs.terms[index] + first); };
    const Vf u_s = term(Term::u_along_s), u_t = term(Term::u_along_t);
    const Vf v_s = term(Term::v_along_s), v_t = term(Term::v_along_t);
    const Vf margin = hn::Add(term(Term::error), term(Term::error));
    const Vf u = hn::Add(term(Term::u), margin), v = hn::Add(term(Term::v), margin);
    const Vf det = hn::MulAdd(splat(3.0f), margin, term(Term::det));
    const Vf determinant = product_difference(u_s, v_t, v_s, u_t);
    const Vf products = hn::Add(hn::Abs(hn::Mul(u_s, v_t)), hn::Abs(hn::Mul(v_s, u_t)));
    const Vf size = hn::Abs(determinant);
    const Vf inverse = hn::Div(splat(1.0f), determinant);
    const Vf edge = hn::Mul(det, inverse);
    const Lanes is_sure = hn::And(hn::Gt(size, hn::Mul(products, splat(kLeastDeterminant))),
                                  hn::Gt(size, splat(kLeastNormal)));
    const auto find = [&](Vf u_other, Vf v_other, std::int32_t* first_strip,
                          std::int32_t* last_strip) HWY_ATTR {
        const Vf a = hn::Mul(hn::Mul(v, u_other), inverse);
        const Vf b = hn::Mul(hn::Mul(u, v_other), inverse);
        const Vf to_1 = hn::Mul(edge, v_other), to_2 = hn::Mul(edge, u_other);
        const Vf corner = hn::Sub(a, b);
        const Vf corner1 = hn::Add(corner, to_1), corner2 = hn::Sub(corner, to_2);
        const Vf magnitude =
            hn::Add(hn::Add(hn::Abs(a), hn::Abs(b)), hn::Add(hn::Abs(to_1), hn::Abs(to_2)));
        const Vf error = hn::Mul(splat(kCornerError), magnitude);
        const Vf low = hn::Sub(hn::Min(corner, hn::Min(corner1, corner2)), error);
        const Vf high = hn::Add(hn::Max(corner, hn::Max(corner1, corner2)), error);
        // Also where something is infinite or no number.
        const Lanes known = hn::And(is_sure, hn::Lt(error, splat(1.0f)));
        const Vf from = hn::IfThenElse(known, low, splat(-1.0f));
        const Vf to = hn::IfThenElse(known, high, splat(1.0f));
        hn::Store(hn::ConvertTo(Ints(), strips_of(from)), Ints(), first_strip);
        hn::Store(hn::ConvertTo(Ints(), strips_of(to)), Ints(), last_strip);
    };
    find(u_t, v_t, reach.first_s, reach.last_s);
    find(hn::Neg(u_s), hn::Neg(v_s), reach.first_t, reach.last_t);
}

/// The pairs that have lit texels in reach.
struct ReachingPairs {
    int count = 0;
    std::int32_t pairs[Pairs::kCapacity + kWidth];
};

HWY_INLINE void find_reaching(const Walk& walk, const Pairs& pairs, ReachingPairs& reaching) {
    const Tile& tile = walk.tile;
    Reach reach;
    for (int first = 0; first < pairs.count; first += kLanes) {
        find_reach(pairs, first, reach);
        const int lanes = std::min(kLanes, pairs.count - first);
        for (int lane = 0; lane < lanes; ++lane) {
            const std::uint64_t in_s =
                tile.strips_s.from[reach.first_s[lane]] & tile.strips_s.to[reach.last_s[lane]];
            const std::uint64_t in_t =
                tile.strips_t.from[reach.first_t[lane]] & tile.strips_t.to[reach.last_t[lane]];
            const bool any = (in_s & in_t & walk.lit[pairs.step[first + lane]]) != 0;
            reaching.pairs[reaching.count] = first + lane;
            reaching.count += any ? 1 : 0;
        }
    }
}

/// Tests a waiting triangle at its step.
template <bool kMixed>
HWY_INLINE void test_pair(Walk& walk, const Pairs& pairs, int e) {
    const Tile& tile = walk.tile;
    const int step = pairs.step[e];
    const std::uint64_t lit = walk.lit[step];
    if (lit == 0) return;
    const auto term = [&](int index) HWY_ATTR { return splat(pairs.terms[index][e]); };
    const Vf center_u = term(Term::u), u_s = term(Term::u_along_s), u_t = term(Term::u_along_t);
    const Vf center_v = term(Term::v), v_s = term(Term::v_along_s), v_t = term(Term::v_along_t);
    const Vf det = term(Term::det), error = term(Term::error), minus_error = hn::Neg(error);
    std::uint64_t sure = 0, possible = 0;
    for (int first = 0; first < tile.texels; first += kLanes) {
        const Vf s = load(tile.s + first), t = load(tile.t + first);
        const Vf u = hn::MulAdd(s, u_s, hn::MulAdd(t, u_t, center_u));
        const Vf v = hn::MulAdd(s, v_s, hn::MulAdd(t, v_t, center_v));
        const Vf least = hn::Min(hn::Min(u, v), hn::Sub(hn::Sub(det, u), v));
        Lanes hit = hn::Gt(least, error), may_hit = hn::Ge(least, minus_error);
        if constexpr (kMixed) {
            const Vf side = hn::MulAdd(s, term(Term::side_along_s),
                                       hn::MulAdd(t, term(Term::side_along_t), term(Term::side)));
            hit = hn::And(hit, hn::Gt(side, term(Term::side_error)));
            may_hit = hn::And(may_hit, hn::Ge(side, hn::Neg(term(Term::side_error))));
        }
        sure |= std::uint64_t{bits_of(hit)} << first;
        possible |= std::uint64_t{bits_of(may_hit)} << first;
    }
    if ((walk.masked(pairs.leaf[e]) >> pairs.lane[e] & 1) != 0) sure = 0;
    const std::uint64_t unsure = possible & ~sure & lit;
    if (unsure != 0) {
        sure |= blocked_texels(walk, unsure, step, pairs.leaf[e], pairs.lane[e]);
    }
    walk.darken(step, sure);
}

/// Tests the waiting triangles at their steps, texel by texel.
template <bool kMixed>
void test_pairs(Walk& walk) {
    Pairs& pairs = kMixed ? walk.mixed_pairs : walk.pairs;
    if (walk.tile.texels <= kLanes) {
        for (int e = 0; e < pairs.count; ++e)
            test_pair<kMixed>(walk, pairs, e);
    } else {
        ReachingPairs reaching;
        find_reaching(walk, pairs, reaching);
        for (int i = 0; i < reaching.count; ++i)
            test_pair<kMixed>(walk, pairs, reaching.pairs[i]);
    }
    pairs.count = 0;
}

}  // namespace gnomon::interval::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
