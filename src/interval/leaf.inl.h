// Which steps the triangles of leaves darken for a tile of texels: see terms.inl.h. Compiled once
// for each instruction set: see walk.cpp.

#if defined(GNOMON_INTERVAL_LEAF_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GNOMON_INTERVAL_LEAF_INL_H
#undef GNOMON_INTERVAL_LEAF_INL_H
#else
#define GNOMON_INTERVAL_LEAF_INL_H
#endif

#include "interval/steps.inl.h"

#include <bit>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace gnomon::interval::HWY_NAMESPACE {

/// What is surely hit, and what may be: a bit for each texel, or for each step.
struct Hits {
    std::uint64_t sure = 0, possible = 0;
};

HWY_INLINE Lanes lanes_of(std::uint32_t bits) {
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits),
                                   static_cast<std::uint8_t>(bits >> 8)};
    return hn::LoadMaskBits(Floats(), bytes);
}

/// Puts the terms of a step in line, `some` of which are to be tested; `masked` ones have holes.
template <bool kSingle>
HWY_INLINE float* append(Pairs& pairs, const LeafVisit& visit, int step,
                         const Terms<kSingle>& terms, std::uint32_t some, std::uint32_t masked) {
    const int record = pairs.records;
    float* const to = pairs.terms[record];
    terms.store(to);
    pairs.lanes[record] = pairs.half_lanes[record][0] = pairs.half_lanes[record][1] = some;
    pairs.masked[record] = some & masked;
    pairs.step[record] = step;
    pairs.leaf[record] = visit.id;
    pairs.first_lane[record] = visit.first_lane;
    pairs.records = record + (some != 0 ? 1 : 0);
    return to;
}

/// Where `varying`, double decides, whatever float says.
HWY_INLINE void store_sides(float* record, const Sides& sides, Vf signs, Lanes varying) {
    const auto store = [&](int term, Vf value)
                           HWY_ATTR { hn::Store(value, Floats(), record + term * kLanes); };
    store(Term::side, hn::Xor(sides.center, signs));
    store(Term::side_along_s, hn::Xor(sides.along_s, signs));
    store(Term::side_along_t, hn::Xor(sides.along_t, signs));
    const Vf infinite = splat(std::numeric_limits<float>::infinity());
    store(Term::side_error, hn::IfThenElse(varying, infinite, sides.error));
}

template <bool kMixed>
HWY_NOINLINE void test_pairs(Walk& walk);

/// No edge of the triangles is longer than half of the tile's side, along s and t, if the sun is
/// high: then most shadows reach one half of the texels only, and it is worth asking which.
HWY_INLINE bool are_small(const Tile& tile, Lanes lanes, const Coefficients<false>& coefficients) {
    const auto extent = [](const Vec3f& edge)
                            HWY_ATTR { return hn::Max(hn::Abs(edge.x), hn::Abs(edge.y)); };
    const Vf longest = hn::Max(extent(coefficients.edge1), extent(coefficients.edge2));
    return tile.texels > Pairs::kHalf && bits_of(hn::And(lanes, hn::Gt(longest, splat(1.0f)))) == 0;
}

/// Leaves out the triangles of a record whose shadows reach no lit texels of a half.
HWY_INLINE void split(Pairs& pairs, int record, const Rectangles& rectangles, const Walk& walk,
                      unsigned lit_groups) {
    constexpr unsigned kFirst = (1u << Pairs::kHalf / 8) - 1;
    pairs.half_lanes[record][0] &= bits_of(rectangles.meet(walk.bounds[lit_groups & kFirst]));
    pairs.half_lanes[record][1] &= bits_of(rectangles.meet(walk.bounds[lit_groups & ~kFirst]));
    pairs.are_split = true;
}

/// Triangles that have the whole tile on one side, or, if `kAbove`, that are above its plane: the
/// lines of rays hit them where the rays do, so that det tells on which side each texel is. Near 0
/// its sign may be wrong; then no term is greater than what det errs, and the errors of det, u and
/// v together are what `error` bounds, so that such a hit is still possible.
template <bool kAbove>
HWY_INLINE void cast_whole(Walk& walk, const LeafVisit& visit, const SeenTriangles<false>& seen,
                           Lanes lanes, const Coefficients<false>& coefficients) {
    const std::uint32_t masked = walk.masked(visit.id) >> visit.first_lane;
    const Lanes solid = hn::And(lanes, lanes_of(~masked));
    const bool is_split = are_small(walk.tile, lanes, coefficients);
    OpenSteps<false> steps(walk, seen);
    for (int step = steps.next(); step >= 0; step = steps.next()) {
        Terms<false> terms(walk, coefficients, step);
        // At most steps there are none, and the compiler leaves the terms for afterwards.
        const Rectangles rectangles = terms.rectangles(walk, coefficients, step);
        const unsigned lit_groups = walk.lit_groups(step);
        const Lanes near = hn::And(lanes, rectangles.meet(walk.bounds[lit_groups]));
        if (bits_of(near) == 0) continue;
        if constexpr (kAbove) terms.negate_where(hn::And(terms.det, splat(-0.0f)));
        const std::uint32_t all = bits_of(hn::And(solid, hn::Gt(terms.least(), terms.error)));
        if (all != 0) {
            walk.credit(visit.id, visit.first_lane + std::countr_zero(all), walk.tile.texels);
            walk.darken(step, ~std::uint64_t{0});
            continue;
        }
        const Lanes some = hn::And(near, hn::Ge(terms.greatest(), hn::Neg(terms.error)));
        const int record = walk.pairs.records;
        append(walk.pairs, visit, step, terms, bits_of(some), masked);
        if (is_split) split(walk.pairs, record, rectangles, walk, lit_groups);
        if (walk.pairs.records == Pairs::kRecords) test_pairs<false>(walk);
    }
}

HWY_INLINE void cast_unmixed(Walk& walk, const LeafVisit& visit, const SeenTriangles<false>& seen,
                             Lanes lanes, const Coefficients<false>& coefficients) {
    cast_whole<false>(walk, visit, seen, lanes, coefficients);
}

/// Steps that make a triangle worth trying first for a single texel.
inline constexpr int kLeastSingleGain = 4;

/// What single texels need of one triangle, in all lanes.
class TriangleTerms {
public:
    static constexpr int kTerms = 10;

    /// Those of a register of triangles, to choose from.
    struct Stored {
        alignas(64) float terms[kTerms][kLanes];

        HWY_INLINE explicit Stored(const Coefficients<true>& c) {
            const Vf all[kTerms] = {c.u.x, c.u.y,   c.u.z,   c.v.x,   c.v.y,
                                    c.v.z, c.det.x, c.det.y, c.det.z, c.error};
            for (int i = 0; i < kTerms; ++i)
                hn::Store(all[i], Floats(), terms[i]);
        }
        HWY_INLINE Vec3f vector(int first, int lane) const {
            return {splat(terms[first][lane]), splat(terms[first + 1][lane]),
                    splat(terms[first + 2][lane])};
        }
    };

    HWY_INLINE TriangleTerms(const Stored& stored, int lane)
        : u_(stored.vector(0, lane)),
          v_(stored.vector(3, lane)),
          det_(stored.vector(6, lane)),
          error_(splat(stored.terms[kTerms - 1][lane])) {}

    /// The steps of a register from `step` that are surely dark, and those that may be: bit 0 is
    /// `step`.
    HWY_INLINE Hits hits(const Walk& walk, int step) const {
        const Vec3f sun{hn::LoadU(Floats(), walk.sun[0] + step),
                        hn::LoadU(Floats(), walk.sun[1] + step),
                        hn::LoadU(Floats(), walk.sun[2] + step)};
        const Vf u = dot(sun, u_), v = dot(sun, v_);
        const Vf w = hn::Sub(hn::Sub(dot(sun, det_), u), v);
        const Vf least = hn::Min(hn::Min(u, v), w);
        return {bits_of(hn::Gt(least, error_)), bits_of(hn::Ge(least, hn::Neg(error_)))};
    }

private:
    Vec3f u_, v_, det_;
    Vf error_;
};

/// The steps of a word at which one triangle is in the way of the single texel; `open` are asked.
HWY_INLINE std::uint64_t dark_steps(const Walk& walk, const LeafVisit& visit, int lane,
                                    const TriangleTerms& terms, bool has_holes, int word,
                                    std::uint64_t open) {
    constexpr std::uint64_t kRegister = (std::uint64_t{1} << kLanes) - 1;
    std::uint64_t dark = 0;
    for (std::uint64_t rest = open; rest != 0;) {
        const int bit = std::countr_zero(rest);
        const Hits hits = terms.hits(walk, 64 * word + bit);
        const std::uint64_t possible = hits.possible << bit & rest;
        if (!has_holes) dark |= hits.sure << bit & rest;
        rest &= ~(kRegister << bit);
        for (std::uint64_t unsure = possible & ~dark; unsure != 0; unsure &= unsure - 1) {
            const int at = std::countr_zero(unsure);
            dark |= blocked_texels(walk, 1, 64 * word + at, visit.id, visit.first_lane + lane,
                                   !has_holes)
                    << at;
        }
    }
    return dark;
}

/// Triangles that have the single texel on one side, one by one, with a step in each lane: each at
/// its own steps alone.
HWY_INLINE void cast_each(Walk& walk, const LeafVisit& visit, const SeenTriangles<true>& seen,
                          std::uint32_t lanes, const Coefficients<true>& coefficients) {
    const std::uint32_t masked = walk.masked(visit.id) >> visit.first_lane;
    const TriangleTerms::Stored stored(coefficients);
    for (; lanes != 0; lanes &= lanes - 1) {
        const int lane = std::countr_zero(lanes);
        const TriangleTerms terms(stored, lane);
        const bool has_holes = (masked >> lane & 1) != 0;
        const int first = static_cast<int>(seen.first_of_each[lane]);
        const int last = static_cast<int>(seen.last_of_each[lane]);
        int gain = 0;
        for (int word = first / 64; word <= last / 64; ++word) {
            const std::uint64_t open = walk.open_steps(word, first, last);
            const std::uint64_t dark = dark_steps(walk, visit, lane, terms, has_holes, word, open);
            walk.open[word] &= ~dark;
            gain += std::popcount(dark);
        }
        // The hint leaf has no triangles with holes.
        if (!has_holes && gain >= kLeastSingleGain)
            walk.credit(visit.id, visit.first_lane + lane, gain);
    }
}

/// Where a single texel has fewer open steps than this, testing all triangles of a register at each
/// takes less time than testing one by one at a register of steps.
inline constexpr int kManySteps = 24;

HWY_INLINE bool has_many_open_steps(const Walk& walk, const SeenTriangles<true>& seen) {
    int count = 0;
    for (int word = seen.first_step / 64; word <= seen.last_step / 64; ++word)
        count += std::popcount(walk.open_steps(word, seen.first_step, seen.last_step));
    return count >= kManySteps;
}

/// The same for a single texel, which most steps leave no doubt about: without a branch that
/// depends on whether they are dark. At many steps, each triangle for itself.
HWY_INLINE void cast_unmixed(Walk& walk, const LeafVisit& visit, const SeenTriangles<true>& seen,
                             Lanes lanes, const Coefficients<true>& coefficients) {
    if (seen.has_steps_of_each && has_many_open_steps(walk, seen)) {
        cast_each(walk, visit, seen, bits_of(lanes), coefficients);
        return;
    }
    const std::uint32_t masked = walk.masked(visit.id) >> visit.first_lane;
    const Lanes solid = hn::And(lanes, lanes_of(~masked));
    alignas(64) std::int32_t gains[kLanes] = {};
    std::uint64_t any = 0;
    for (int word = seen.first_step / 64; word <= seen.last_step / 64; ++word) {
        std::uint64_t rest = walk.open_steps(word, seen.first_step, seen.last_step), dark = 0;
        for (; rest != 0; rest &= rest - 1) {
            const int bit = std::countr_zero(rest), step = 64 * word + bit;
            const Terms<true> terms(walk, coefficients, step);
            const Vf least = terms.least();
            const std::uint32_t all = bits_of(hn::And(solid, hn::Gt(least, terms.error)));
            const std::uint32_t some = bits_of(hn::And(lanes, hn::Ge(least, hn::Neg(terms.error))));
            const bool is_dark = all != 0;
            dark |= std::uint64_t{is_dark} << bit;
            gains[std::countr_zero(all | 1u << (kLanes - 1))] += is_dark ? 1 : 0;
            if (!is_dark && some != 0) {
                append(walk.pairs, visit, step, terms, some, masked);
                if (walk.pairs.records == Pairs::kRecords) test_pairs<false>(walk);
            }
        }
        walk.open[word] &= ~dark;
        any |= dark;
    }
    if (any == 0) return;
    for (int lane = 0; lane < kLanes; ++lane) {
        if (gains[lane] >= kLeastSingleGain)
            walk.credit(visit.id, visit.first_lane + lane, gains[lane]);
    }
}

/// Leaves out the triangles of `lanes` that are in nobody's way, and adds to `varying` those that
/// are in the way of some.
HWY_INLINE std::uint32_t judge_heights(const Walk& walk, const LeafVisit& visit,
                                       std::uint32_t lanes, std::uint32_t& varying) {
    std::uint32_t below = 0;
    for (std::uint32_t rest = lanes; rest != 0; rest &= rest - 1) {
        const int lane = std::countr_zero(rest);
        const Height height = height_over_tile(walk, visit.id, visit.first_lane + lane);
        if (height == Height::below) below |= 1u << lane;
        if (height == Height::varies) varying |= 1u << lane;
    }
    return below;
}

/// Triangles whose plane cuts the tile, or nearly, and those that are nearly in the tile's plane:
/// which side counts is decided at each step by the determinant, and for each texel.
template <bool kSingle>
HWY_INLINE void cast_mixed(Walk& walk, const LeafVisit& visit, const SeenTriangles<kSingle>& seen,
                           std::uint32_t lanes, const Coefficients<kSingle>& coefficients,
                           const Sides& sides) {
    // Triangles whose height is still to be judged, and those it is left to each texel for.
    std::uint32_t unjudged = seen.low, varying = 0;
    const std::uint32_t masked = walk.masked(visit.id) >> visit.first_lane;
    OpenSteps<kSingle> steps(walk, seen);
    for (int step = steps.next(); step >= 0; step = steps.next()) {
        Terms<kSingle> terms(walk, coefficients, step);
        const Lanes near = terms.near(walk, coefficients, step);
        const Vf signs = hn::And(terms.det, splat(-0.0f));
        terms.negate_where(signs);
        std::uint32_t some =
            bits_of(hn::And(near, hn::Ge(terms.greatest(), hn::Neg(terms.error)))) & lanes;
        if ((some & unjudged) != 0) {
            lanes &= ~judge_heights(walk, visit, some & unjudged, varying);
            unjudged &= ~some;
            some &= lanes;
        }
        if (some == 0) continue;
        Pairs& pairs = walk.mixed_pairs;
        float* const record = append(pairs, visit, step, terms, some, masked);
        store_sides(record, sides, signs, lanes_of(varying));
        if (pairs.records == Pairs::kRecords) test_pairs<true>(walk);
    }
}

HWY_INLINE Coefficients<true> coefficients_of(const Tile& tile, const SeenTriangles<true>&,
                                              const Triangles& t, Vec3f normal, Lanes turned) {
    return {tile, t, normal, turned};
}
HWY_INLINE Coefficients<false> coefficients_of(const Tile&, const SeenTriangles<false>& seen,
                                               const Triangles&, Vec3f, Lanes turned) {
    return {seen.triangles, turned};
}

/// Triangles any of which may reach down to the tile's plane.
template <bool kSingle>
HWY_INLINE void cast_by_sides(Walk& walk, const LeafVisit& visit,
                              const SeenTriangles<kSingle>& seen) {
    const Triangles t = triangles_of(walk.tile, visit);
    const Vec3f normal = cross(t.edge1, t.edge2);
    const Sides sides = sides_of<kSingle>(walk.tile, t, normal);
    const Vf reach = hn::MulAdd(
        splat(kRoundUp), hn::Add(hn::Abs(sides.along_s), hn::Abs(sides.along_t)), sides.error);
    const Lanes present = lanes_of(seen.any);
    const Lanes mixed =
        hn::And(present, hn::Or(hn::Le(hn::Abs(sides.center), reach), lanes_of(seen.low)));
    const Lanes turned = hn::AndNot(mixed, hn::Lt(sides.center, splat(0.0f)));
    const auto coefficients = coefficients_of(walk.tile, seen, t, normal, turned);
    const std::uint32_t mixed_bits = bits_of(mixed);
    if (mixed_bits != seen.any) {
        cast_unmixed(walk, visit, seen, hn::AndNot(mixed, present), coefficients);
    }
    if (mixed_bits != 0) cast_mixed<kSingle>(walk, visit, seen, mixed_bits, coefficients, sides);
}

HWY_INLINE void cast(Walk& walk, const LeafVisit& visit, const SeenTriangles<true>& seen) {
    cast_by_sides(walk, visit, seen);
}
HWY_INLINE void cast(Walk& walk, const LeafVisit& visit, const SeenTriangles<false>& seen) {
    if (!seen.are_above) {
        cast_by_sides(walk, visit, seen);
        return;
    }
    const Coefficients<false> coefficients(seen.triangles, lanes_of(0));
    cast_whole<true>(walk, visit, seen, lanes_of(seen.any), coefficients);
}

/// The waiting leaves: the steps of all first, because those take hardly a branch to compute.
template <bool kSingle>
HWY_INLINE void cast_leaves(Walk& walk) {
    SeenTriangles<kSingle> seen[Walk::kLeafBatch * kVisits];
    const int count = walk.leaf_count;
    walk.leaf_count = 0;
    for (int i = 0; i < count; ++i)
        find_steps(walk, walk.leaves[i], seen[i]);
    for (int i = 0; i < count; ++i) {
        if (seen[i].any == 0 || !seen[i].any_open(walk)) continue;
        cast(walk, walk.leaves[i], seen[i]);
    }
    if (walk.pairs.records >= Pairs::kBatch) test_pairs<false>(walk);
    if (walk.mixed_pairs.records >= Pairs::kBatch) test_pairs<true>(walk);
}

}  // namespace gnomon::interval::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
