// Which texels of a tile triangles darken at a step, one by one. Compiled once for each instruction
// set: see walk.cpp.

#if defined(GNOMON_INTERVAL_PAIRS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GNOMON_INTERVAL_PAIRS_INL_H
#undef GNOMON_INTERVAL_PAIRS_INL_H
#else
#define GNOMON_INTERVAL_PAIRS_INL_H
#endif

#include "interval/leaf.inl.h"

#include <algorithm>
#include <bit>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace gnomon::interval::HWY_NAMESPACE {

/// u, v and det, and how u and v vary over the tile.
struct Plane {
    Vf u, v, det, edge1_s, edge1_t, edge2_s, edge2_t;

    /// `term` tells each: of one triangle in all lanes, or of one in each.
    template <typename Get>
    HWY_INLINE explicit Plane(const Get& term) {
        u = term(Term::u);
        v = term(Term::v);
        det = term(Term::det);
        edge1_s = term(Term::edge1_s);
        edge1_t = term(Term::edge1_t);
        edge2_s = term(Term::edge2_s);
        edge2_t = term(Term::edge2_t);
    }

    /// min(u, v, w) at texels.
    HWY_INLINE Vf least(Vf s, Vf t) const {
        const Vf u_at = hn::MulAdd(t, edge2_s, hn::NegMulAdd(s, edge2_t, u));
        const Vf v_at = hn::MulAdd(s, edge1_t, hn::NegMulAdd(t, edge1_s, v));
        return hn::Min(hn::Min(u_at, v_at), hn::Sub(hn::Sub(det, u_at), v_at));
    }
};

template <bool kMixed, int kRegisters>
HWY_INLINE Hits hits_of(const Tile& tile, const float* terms, int first_texel) {
    const auto term = [&](int index) HWY_ATTR { return splat(terms[index * kLanes]); };
    const Plane plane(term);
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
HWY_INLINE void test_singly(Walk& walk, const Pairs& pairs, int record, std::uint32_t lanes,
                            int first_texel) {
    const int step = pairs.step[record];
    for (std::uint32_t rest = lanes; rest != 0; rest &= rest - 1) {
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
        const auto term = [&](int index) HWY_ATTR { return splat(at[index * kLanes]); };
        const Plane plane(term);
        error = hn::Max(error, term(Term::error));
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

/// Those of `texels` that triangles of a record hit: a triangle in each lane. Double decides where
/// float cannot.
HWY_INLINE std::uint64_t hits_at(const Walk& walk, const Pairs& pairs, int record,
                                 std::uint32_t lanes, std::uint64_t texels) {
    const float* const terms = pairs.terms[record];
    const auto term = [&](int index) HWY_ATTR { return load(terms + index * kLanes); };
    const Plane planes(term);
    const Vf error = term(Term::error);
    std::uint64_t hits = 0;
    for (; texels != 0; texels &= texels - 1) {
        const int texel = std::countr_zero(texels);
        const std::uint64_t bit = std::uint64_t{1} << texel;
        const Vf least = planes.least(splat(walk.tile.s[texel]), splat(walk.tile.t[texel]));
        bool is_hit = (bits_of(hn::Gt(least, error)) & lanes) != 0;
        std::uint32_t possible = bits_of(hn::Ge(least, hn::Neg(error))) & lanes;
        for (; !is_hit && possible != 0; possible &= possible - 1) {
            const int lane = pairs.first_lane[record] + std::countr_zero(possible);
            is_hit =
                blocked_texels(walk, bit, pairs.step[record], pairs.leaf[record], lane, true) != 0;
        }
        hits |= is_hit ? bit : 0;
    }
    return hits;
}

/// Tests triangles of a record: texels that are surely hit by any of them need no closer look, and
/// few others do.
template <bool kMixed, int kRegisters>
HWY_INLINE void test_record(Walk& walk, const Pairs& pairs, int record, std::uint32_t lanes,
                            int first_texel) {
    const int step = pairs.step[record];
    const std::uint64_t lit = walk.lit[step];
    if (lit == 0) return;
    if (kMixed || pairs.masked[record] != 0) {
        test_singly<kMixed, kRegisters>(walk, pairs, record, lanes, first_texel);
        return;
    }
    Hits hits = hits_together<kRegisters>(walk.tile, pairs.terms[record], lanes, first_texel);
    const std::uint64_t unsure = hits.possible & ~hits.sure & lit;
    if (unsure != 0) hits.sure |= hits_at(walk, pairs, record, lanes, unsure);
    walk.darken(step, hits.sure);
}

/// Tests all records on some registers of texels.
template <bool kMixed, int kRegisters>
HWY_INLINE void test_on(Walk& walk, const Pairs& pairs, int first_texel) {
    for (int record = 0; record < pairs.records; ++record)
        test_record<kMixed, kRegisters>(walk, pairs, record, pairs.lanes[record], first_texel);
}

/// Registers that are tested together: more terms than these do not fit beside theirs.
inline constexpr int kMostRegisters = 4;

/// Tests some records on one half of the texels.
HWY_INLINE void test_half(Walk& walk, const Pairs& pairs, const std::int32_t* records, int count,
                          int half) {
    constexpr int kTogether = std::min(kMostRegisters, Pairs::kHalf / kLanes);
    for (int first = 0; first < Pairs::kHalf; first += kTogether * kLanes) {
        for (int i = 0; i < count; ++i) {
            const int record = records[i];
            test_record<false, kTogether>(walk, pairs, record, pairs.half_lanes[record][half],
                                          half * Pairs::kHalf + first);
        }
    }
}

/// Tests records whose triangles may differ from one half of the texels to the other: where most do
/// not, on all texels together, if these fit. Which record goes where takes no branch.
HWY_INLINE void test_split(Walk& walk, const Pairs& pairs) {
    constexpr bool kFits = kMaxTexels / kLanes <= kMostRegisters;
    std::int32_t whole[Pairs::kRecords], halves[2][Pairs::kRecords];
    int wholes = 0, counts[2] = {};
    for (int record = 0; record < pairs.records; ++record) {
        const std::uint32_t* const lanes = pairs.half_lanes[record];
        const int each = std::popcount(lanes[0]) + std::popcount(lanes[1]);
        const bool is_whole = kFits && 2 * each > 3 * std::popcount(lanes[0] | lanes[1]);
        whole[wholes] = record;
        wholes += is_whole ? 1 : 0;
        for (int half = 0; half < 2; ++half) {
            halves[half][counts[half]] = record;
            counts[half] += !is_whole && lanes[half] != 0 ? 1 : 0;
        }
    }
    for (int i = 0; i < wholes; ++i) {
        const std::uint32_t* const lanes = pairs.half_lanes[whole[i]];
        test_record<false, kMostRegisters>(walk, pairs, whole[i], lanes[0] | lanes[1], 0);
    }
    for (int half = 0; half < 2; ++half)
        test_half(walk, pairs, halves[half], counts[half], half);
}

/// Tests the waiting triangles at their steps, texel by texel.
template <bool kMixed>
HWY_NOINLINE void test_pairs(Walk& walk) {
    Pairs& pairs = kMixed ? walk.mixed_pairs : walk.pairs;
    const int texels = walk.tile.texels;
    if (!kMixed && pairs.are_split) {
        test_split(walk, pairs);
    } else if (texels <= kLanes) {
        test_on<kMixed, 1>(walk, pairs, 0);
    } else if (texels <= 2 * kLanes) {
        test_on<kMixed, 2>(walk, pairs, 0);
    } else {
        for (int first = 0; first < texels; first += kMostRegisters * kLanes)
            test_on<kMixed, kMostRegisters>(walk, pairs, first);
    }
    pairs.records = 0;
    pairs.are_split = false;
}

}  // namespace gnomon::interval::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
