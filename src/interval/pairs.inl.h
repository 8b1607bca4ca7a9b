// Which texels of a tile triangles darken at a step, one by one. Compiled once for each instruction
// set: see walk.cpp.

#if defined(GNOMON_INTERVAL_PAIRS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GNOMON_INTERVAL_PAIRS_INL_H
#undef GNOMON_INTERVAL_PAIRS_INL_H
#else
#define GNOMON_INTERVAL_PAIRS_INL_H
#endif

#include "interval/leaf.inl.h"

#include <limits>

HWY_BEFORE_NAMESPACE();
namespace gnomon::interval::HWY_NAMESPACE {

/// u, v and det of a triangle, and how u and v vary over the tile.
struct Plane {
    Vf u, v, det, edge1_s, edge1_t, edge2_s, edge2_t;

    HWY_INLINE Plane(const float* terms) {
        const auto term = [&](int index) HWY_ATTR { return splat(terms[index * kLanes]); };
        u = term(Term::u);
        v = term(Term::v);
        det = term(Term::det);
        edge1_s = term(Term::edge1_s);
        edge1_t = term(Term::edge1_t);
        edge2_s = term(Term::edge2_s);
        edge2_t = term(Term::edge2_t);
    }

    /// min(u, v, w) of texels.
    HWY_INLINE Vf least(Vf s, Vf t) const {
        const Vf u_at = hn::MulAdd(t, edge2_s, hn::NegMulAdd(s, edge2_t, u));
        const Vf v_at = hn::MulAdd(s, edge1_t, hn::NegMulAdd(t, edge1_s, v));
        return hn::Min(hn::Min(u_at, v_at), hn::Sub(hn::Sub(det, u_at), v_at));
    }
};

template <bool kMixed, int kRegisters>
HWY_INLINE Hits hits_of(const Tile& tile, const float* terms, int first_texel) {
    const Plane plane(terms);
    const auto term = [&](int index) HWY_ATTR { return splat(terms[index * kLanes]); };
    const Vf error = term(Term::error);
    Hits hits;
    for (int i = 0; i < kRegisters; ++i) {
        const int first = first_texel + i * kLanes;
        const Vf s = load(tile.s + first), t = load(tile.t + first);
        const Vf least = plane.least(s, t);
        Lanes hit = hn::Gt(least, error), may_hit = hn::Ge(least, hn::Neg(error));
        if constexpr (kMixed) {
            const Vf side = hn::MulAdd(s, term(Term::side_along_s),
                                       hn::MulAdd(t, term(Term::side_along_t), term(Term::side)));
            hit = hn::And(hit, hn::Gt(side, term(Term::side_error)));
            may_hit = hn::And(may_hit, hn::Ge(side, hn::Neg(term(Term::side_error))));
        }
        hits.sure |= std::uint64_t{bits_of(hit)} << first;
        hits.possible |= std::uint64_t{bits_of(may_hit)} << first;
    }
    return hits;
}

/// Tests the triangles of a record one by one: double decides where float cannot.
template <bool kMixed, int kRegisters>
HWY_INLINE void test_singly(Walk& walk, const Pairs& pairs, int record, int first_texel) {
    const int step = pairs.step[record];
    for (std::uint32_t rest = pairs.lanes[record]; rest != 0; rest &= rest - 1) {
        const std::uint64_t lit = walk.lit[step];
        if (lit == 0) return;
        const int lane = std::countr_zero(rest), leaf_lane = pairs.first_lane[record] + lane;
        Hits hits = hits_of<kMixed, kRegisters>(walk.tile, pairs.terms[record] + lane, first_texel);
        const bool has_holes = (pairs.masked[record] >> lane & 1) != 0;
        if (has_holes) hits.sure = 0;
        const std::uint64_t unsure = hits.possible & ~hits.sure & lit;
        if (unsure != 0) {
            hits.sure |= blocked_texels(walk, unsure, step, pairs.leaf[record], leaf_lane,
                                        !kMixed && !has_holes);
        }
        walk.darken(step, hits.sure);
    }
}

/// Which texels the triangles of a record hit, together. All have the whole tile on one side.
template <int kRegisters>
HWY_INLINE Hits hits_together(const Tile& tile, const float* terms, std::uint32_t lanes,
                              int first_texel) {
    Vf greatest[kRegisters], error = splat(0.0f);
    for (Vf& most : greatest)
        most = splat(std::numeric_limits<float>::lowest());
    for (; lanes != 0; lanes &= lanes - 1) {
        const float* const at = terms + std::countr_zero(lanes);
        const Plane plane(at);
        error = hn::Max(error, splat(at[Term::error * kLanes]));
        for (int i = 0; i < kRegisters; ++i) {
            const int first = first_texel + i * kLanes;
            greatest[i] =
                hn::Max(greatest[i], plane.least(load(tile.s + first), load(tile.t + first)));
        }
    }
    Hits hits;
    for (int i = 0; i < kRegisters; ++i) {
        const int first = first_texel + i * kLanes;
        hits.sure |= std::uint64_t{bits_of(hn::Gt(greatest[i], error))} << first;
        hits.possible |= std::uint64_t{bits_of(hn::Ge(greatest[i], hn::Neg(error)))} << first;
    }
    return hits;
}

/// Tests the triangles of a record: texels that are surely hit by any of them need no closer look,
/// and few others do.
template <bool kMixed, int kRegisters>
HWY_INLINE void test_record(Walk& walk, const Pairs& pairs, int record, int first_texel) {
    const int step = pairs.step[record];
    const std::uint64_t lit = walk.lit[step];
    if (lit == 0) return;
    if (kMixed || pairs.masked[record] != 0) {
        test_singly<kMixed, kRegisters>(walk, pairs, record, first_texel);
        return;
    }
    const Hits hits =
        hits_together<kRegisters>(walk.tile, pairs.terms[record], pairs.lanes[record], first_texel);
    walk.darken(step, hits.sure);
    if ((hits.possible & ~hits.sure & lit) != 0)
        test_singly<false, kRegisters>(walk, pairs, record, first_texel);
}

/// Tests the waiting triangles on some registers of texels.
template <bool kMixed, int kRegisters>
HWY_INLINE void test_on(Walk& walk, const Pairs& pairs, int first_texel) {
    for (int record = 0; record < pairs.records; ++record)
        test_record<kMixed, kRegisters>(walk, pairs, record, first_texel);
}

/// Tests the waiting triangles at their steps, texel by texel.
template <bool kMixed>
HWY_NOINLINE void test_pairs(Walk& walk) {
    Pairs& pairs = kMixed ? walk.mixed_pairs : walk.pairs;
    const int texels = walk.tile.texels;
    if (texels <= kLanes) {
        test_on<kMixed, 1>(walk, pairs, 0);
    } else if (texels <= 2 * kLanes) {
        test_on<kMixed, 2>(walk, pairs, 0);
    } else {
        for (int first = 0; first < texels; first += 4 * kLanes)
            test_on<kMixed, 4>(walk, pairs, first);
    }
    pairs.records = 0;
}

}  // namespace gnomon::interval::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
