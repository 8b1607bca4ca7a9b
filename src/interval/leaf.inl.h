// Which steps the triangles of leaves darken for a tile of texels. Compiled once for each
// instruction set: see walk.cpp.
//
// A ray from o along d hits the triangle (c, c + a, c + b) where u, v and w are not negative,
//     u = d . ((c - o) x b),  v = d . (a x (c - o)),  det = -d . (a x b),  w = det - u - v,
// with all signs turned when det is negative; it is in front when (o - c) . (a x b) has the sign of
// det. (T. Möller, B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997, with the
// products in another order.) All are linear in d, and, at o = center + s U + t V, in s and t: so
// seven terms that are linear in d tell of all texels at a step whether none, some, or all can be
// hit. The greatest error of the float arithmetic is known; within it, double decides. Hence no
// answer depends on the tile, on the instruction set or on the order of anything.

#if defined(GNOMON_INTERVAL_LEAF_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GNOMON_INTERVAL_LEAF_INL_H
#undef GNOMON_INTERVAL_LEAF_INL_H
#else
#define GNOMON_INTERVAL_LEAF_INL_H
#endif

#include "interval/ranges.inl.h"

#include <bit>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace gnomon::interval::HWY_NAMESPACE {

/// Roundings of one of the seven terms, relative to the sums of magnitudes of the two vectors whose
/// product it is: inputs 3, cross product 2, scalar product 6 without fused multiply-add, adding up
/// what s and t contribute 3; and two to spare.
inline constexpr float kTermRoundings = 16.0f;
inline constexpr float kUnitRoundoff = static_cast<float>(trace::kUnitRoundoff);
/// Makes sure that a bound is not rounded down below what it bounds.
inline constexpr float kRoundUp = 1.0f + 1e-4f;

/// Visits of one leaf, a register each.
inline constexpr int kVisits = kWidth / kLanes;

/// Triangles of a leaf relative to the tile's centre.
struct Triangles {
    Vec3f corner, edge1, edge2;
};

HWY_INLINE Triangles triangles_of(const Tile& tile, const LeafVisit& visit) {
    return {load3(visit.leaf->corner, visit.first_lane) - splat3(tile.center_m),
            load3(visit.leaf->edge1, visit.first_lane), load3(visit.leaf->edge2, visit.first_lane)};
}

/// The triangles of a visit that some step can see, with the steps.
struct SeenTriangles {
    alignas(64) float first[kLanes], last[kLanes];
    std::uint32_t any;
    std::uint32_t low;  ///< those that may be on or below the tile's plane
    int first_step, last_step;
};

HWY_INLINE Boxes boxes_of(const Tile& tile, const Triangles& t) {
    const Vf zero = splat(0.0f);
    const auto low = [&](Vf corner, Vf a, Vf b, int axis) HWY_ATTR {
        return hn::Add(corner, hn::Sub(hn::Min(zero, hn::Min(a, b)),
                                       splat(tile.upper_m[axis] - tile.center_m[axis])));
    };
    const auto high = [&](Vf corner, Vf a, Vf b, int axis) HWY_ATTR {
        return hn::Add(corner, hn::Sub(hn::Max(zero, hn::Max(a, b)),
                                       splat(tile.lower_m[axis] - tile.center_m[axis])));
    };
    return {{low(t.corner.x, t.edge1.x, t.edge2.x, 0), low(t.corner.y, t.edge1.y, t.edge2.y, 1),
             low(t.corner.z, t.edge1.z, t.edge2.z, 2)},
            {high(t.corner.x, t.edge1.x, t.edge2.x, 0), high(t.corner.y, t.edge1.y, t.edge2.y, 1),
             high(t.corner.z, t.edge1.z, t.edge2.z, 2)}};
}

/// Heights of the triangles' highest corners over the tile's plane, and what they err.
struct Heights {
    Vf top, error;
};

HWY_INLINE Heights heights_of(const Tile& tile, const Triangles& t) {
    const Vec3f normal = splat3(tile.normal);
    const Vf height1 = dot(normal, t.edge1), height2 = dot(normal, t.edge2);
    const Vf top = hn::Add(dot(normal, t.corner), hn::Max(splat(0.0f), hn::Max(height1, height2)));
    const Vf size = hn::Add(sum_of_magnitudes(t.corner),
                            hn::Add(sum_of_magnitudes(t.edge1), sum_of_magnitudes(t.edge2)));
    return {top, hn::MulAdd(size, splat(kTermRoundings * kUnitRoundoff), splat(tile.touch_m))};
}

/// Where a leaf is seen at so few steps, testing all of its triangles at each takes less time than
/// finding the steps of each; a step takes longer for more than one texel.
template <bool kSingle>
inline constexpr int kFewSteps = kSingle ? 8 : 2;

template <bool kSingle>
HWY_INLINE void find_steps(const Walk& walk, const LeafVisit& visit, SeenTriangles& seen) {
    const Triangles t = triangles_of(walk.tile, visit);
    const Heights heights = heights_of(walk.tile, t);
    const Lanes above = hn::Gt(heights.top, hn::Neg(heights.error));
    seen.low = bits_of(hn::Le(heights.top, heights.error));
    if (visit.last_step - visit.first_step < kFewSteps<kSingle>) {
        seen.any = bits_of(above);
        hn::Store(splat(static_cast<float>(visit.first_step)), Floats(), seen.first);
        hn::Store(splat(static_cast<float>(visit.last_step)), Floats(), seen.last);
        seen.first_step = visit.first_step;
        seen.last_step = visit.last_step;
        return;
    }
    const Steps steps =
        cut(steps_towards(walk.ranges, boxes_of(walk.tile, t)), visit.first_step, visit.last_step);
    seen.any = bits_of(hn::And(steps.any, above));
    hn::Store(steps.first, Floats(), seen.first);
    hn::Store(steps.last, Floats(), seen.last);
    const Vf none_first = splat(walk.ranges.last_step), none_last = splat(0.0f);
    const Vf first = hn::IfThenElse(steps.any, steps.first, none_first);
    const Vf last = hn::IfThenElse(steps.any, steps.last, none_last);
    seen.first_step = static_cast<int>(hn::GetLane(hn::MinOfLanes(Floats(), first)));
    seen.last_step = static_cast<int>(hn::GetLane(hn::MaxOfLanes(Floats(), last)));
}

/// The seven terms as vectors to be multiplied with the sun's direction, and what they err.
struct Coefficients {
    Vec3f u, v, det, u_s, u_t, v_s, v_t;
    Vf error;
};

HWY_INLINE Vec3f negated_where(Vec3f v, Vf signs) {
    return {hn::Xor(v.x, signs), hn::Xor(v.y, signs), hn::Xor(v.z, signs)};
}

/// `signs`: -0 in lanes where all are to be negated, else 0.
HWY_INLINE Coefficients coefficients_of(const Tile& tile, const Triangles& t, Vec3f normal,
                                        Vf signs) {
    const Vec3f along_s = splat3(tile.u_axis_m), along_t = splat3(tile.v_axis_m);
    const Vf size1 = sum_of_magnitudes(t.edge1), size2 = sum_of_magnitudes(t.edge2);
    const Vf around = hn::Add(sum_of_magnitudes(t.corner),
                              hn::Add(sum_of_magnitudes(along_s), sum_of_magnitudes(along_t)));
    // Corners of triangles are rounded once, relative to the scene's middle.
    const Vf place_m = hn::MulAdd(
        splat(kUnitRoundoff),
        hn::MulAdd(splat(kTermRoundings), around, sum_of_magnitudes(splat3(tile.center_m))),
        splat(tile.residual_m));
    const Vf error =
        hn::MulAdd(hn::Add(size1, size2), place_m,
                   hn::Mul(splat(kTermRoundings * kUnitRoundoff), hn::Mul(size1, size2)));
    return {negated_where(cross(t.corner, t.edge2), signs),
            negated_where(cross(t.edge1, t.corner), signs),
            negated_where(normal, hn::Xor(signs, splat(-0.0f))),
            negated_where(cross(t.edge2, along_s), signs),
            negated_where(cross(t.edge2, along_t), signs),
            negated_where(cross(along_s, t.edge1), signs),
            negated_where(cross(along_t, t.edge1), signs),
            hn::Mul(splat(kRoundUp), error)};
}

/// (o - c) . (a x b) over the tile.
struct Sides {
    Vf center, along_s, along_t, error;
};

HWY_INLINE Sides sides_of(const Tile& tile, const Triangles& t, Vec3f normal) {
    const Vf size = hn::Mul(sum_of_magnitudes(t.corner),
                            hn::Mul(sum_of_magnitudes(t.edge1), sum_of_magnitudes(t.edge2)));
    const Vf place_m =
        hn::MulAdd(splat(kUnitRoundoff),
                   hn::Add(sum_of_magnitudes(splat3(tile.center_m)), sum_of_magnitudes(t.corner)),
                   splat(tile.touch_m));
    const Vf error = hn::MulAdd(sum_of_magnitudes(normal), place_m,
                                hn::Mul(splat(kTermRoundings * kUnitRoundoff), size));
    return {hn::Neg(dot(t.corner, normal)), dot(splat3(tile.u_axis_m), normal),
            dot(splat3(tile.v_axis_m), normal), hn::Mul(splat(kRoundUp), error)};
}

/// The terms at one step, and how far u, v and w can be from the centre's over the tile: not at all
/// in a tile of one texel, which is `kSingle`.
template <bool kSingle>
struct Terms {
    Vf u, v, det, u_s, u_t, v_s, v_t;

    HWY_INLINE Terms(const Coefficients& c, Vec3f sun)
        : u(dot(sun, c.u)), v(dot(sun, c.v)), det(dot(sun, c.det)) {
        if constexpr (kSingle) {
            u_s = u_t = v_s = v_t = splat(0.0f);
        } else {
            u_s = dot(sun, c.u_s);
            u_t = dot(sun, c.u_t);
            v_s = dot(sun, c.v_s);
            v_t = dot(sun, c.v_t);
        }
    }

    HWY_INLINE Vf w() const { return hn::Sub(hn::Sub(det, u), v); }
    HWY_INLINE Vf reach_u() const { return hn::Add(hn::Abs(u_s), hn::Abs(u_t)); }
    HWY_INLINE Vf reach_v() const { return hn::Add(hn::Abs(v_s), hn::Abs(v_t)); }
    HWY_INLINE Vf reach_w() const {
        return hn::Add(hn::Abs(hn::Add(u_s, v_s)), hn::Abs(hn::Add(u_t, v_t)));
    }
    /// The greatest and the least of min(u, v, w) over the tile, or a bound.
    HWY_INLINE Vf greatest() const {
        if constexpr (kSingle) return hn::Min(hn::Min(u, v), w());
        return hn::Min(hn::Min(hn::Add(u, reach_u()), hn::Add(v, reach_v())),
                       hn::Add(w(), reach_w()));
    }
    HWY_INLINE Vf least() const {
        if constexpr (kSingle) return hn::Min(hn::Min(u, v), w());
        return hn::Min(hn::Min(hn::Sub(u, reach_u()), hn::Sub(v, reach_v())),
                       hn::Sub(w(), reach_w()));
    }
    HWY_INLINE void negate_where(Vf signs) {
        for (Vf* term : {&u, &v, &det, &u_s, &u_t, &v_s, &v_t})
            *term = hn::Xor(*term, signs);
    }
};

HWY_INLINE Vec3f sun_at(const Walk& walk, int step) {
    return {splat(walk.sun[0][step]), splat(walk.sun[1][step]), splat(walk.sun[2][step])};
}

/// The open steps of [first, last], one after the other.
class OpenSteps {
public:
    HWY_INLINE OpenSteps(const Walk& walk, const SeenTriangles& seen)
        : walk_(walk),
          first_(seen.first_step),
          last_(seen.last_step),
          word_(first_ / 64),
          bits_(walk.open_steps(word_, first_, last_)) {}

    /// Less than 0 after the last.
    HWY_INLINE int next() {
        while (bits_ == 0) {
            if (++word_ > last_ / 64) return -1;
            bits_ = walk_.open_steps(word_, first_, last_);
        }
        const int step = 64 * word_ + std::countr_zero(bits_);
        bits_ &= bits_ - 1;
        return step;
    }

private:
    const Walk& walk_;
    int first_, last_, word_;
    std::uint64_t bits_;
};

/// The triangles that a step can see.
HWY_INLINE Lanes seen_at(Vf first, Vf last, int step) {
    const Vf at = splat(static_cast<float>(step));
    return hn::And(hn::Le(first, at), hn::Ge(last, at));
}

/// For each set of lanes: those, then any others.
template <int kCount>
struct Orders {
    std::int32_t lanes[1 << kCount][kCount] = {};

    constexpr Orders() {
        for (int bits = 0; bits < 1 << kCount; ++bits) {
            int place = 0;
            for (int lane = 0; lane < kCount; ++lane) {
                if ((bits >> lane & 1) != 0) lanes[bits][place++] = lane;
            }
        }
    }
};

/// Writes the values of some lanes side by side, and others behind them: there must be room for a
/// register. By our own table where no instruction does it, because GCC copies the whole of
/// Highway 1.0's for each call.
class SomeLanes {
public:
    HWY_INLINE explicit SomeLanes(Lanes lanes) : lanes_(lanes) {}

    HWY_INLINE int count() const { return static_cast<int>(hn::CountTrue(Floats(), lanes_)); }

    template <typename D, typename V, typename T>
    HWY_INLINE void store(D d, V values, T* to) const {
        if constexpr (kLanes == kWidth) {
            hn::CompressStore(values, hn::RebindMask(d, lanes_), d, to);
        } else {
            static constexpr Orders<static_cast<int>(hn::MaxLanes(D()))> kOrders;
            const auto order = hn::SetTableIndices(d, kOrders.lanes[bits_of(lanes_)]);
            hn::StoreU(hn::TableLookupLanes(values, order), d, to);
        }
    }

private:
    Lanes lanes_;
};

HWY_INLINE void append_indices(Pairs& pairs, const SomeLanes& lanes, int step,
                               const LeafVisit& visit) {
    const Ints ints;
    hn::StoreU(hn::Set(ints, step), ints, pairs.step + pairs.count);
    hn::StoreU(hn::Set(ints, visit.id), ints, pairs.leaf + pairs.count);
    lanes.store(ints, hn::Iota(ints, visit.first_lane), pairs.lane + pairs.count);
}

template <bool kSingle>
HWY_INLINE void append_edges(Pairs& pairs, const SomeLanes& lanes, const Terms<kSingle>& terms,
                             Vf error) {
    const auto append = [&](int term, Vf value) HWY_ATTR {
        lanes.store(Floats(), value, pairs.terms[term] + pairs.count);
    };
    append(Term::u, terms.u);
    append(Term::v, terms.v);
    append(Term::det, terms.det);
    append(Term::u_along_s, terms.u_s);
    append(Term::u_along_t, terms.u_t);
    append(Term::v_along_s, terms.v_s);
    append(Term::v_along_t, terms.v_t);
    append(Term::error, error);
}

/// Where `varying`, double decides, whatever float says.
HWY_INLINE void append_sides(Pairs& pairs, const SomeLanes& lanes, const Sides& sides, Vf signs,
                             Lanes varying) {
    const auto append = [&](int term, Vf value) HWY_ATTR {
        lanes.store(Floats(), value, pairs.terms[term] + pairs.count);
    };
    append(Term::side, hn::Xor(sides.center, signs));
    append(Term::side_along_s, hn::Xor(sides.along_s, signs));
    append(Term::side_along_t, hn::Xor(sides.along_t, signs));
    const Vf infinite = splat(std::numeric_limits<float>::infinity());
    append(Term::side_error, hn::IfThenElse(varying, infinite, sides.error));
}

HWY_INLINE Lanes lanes_of(std::uint32_t bits) {
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits),
                                   static_cast<std::uint8_t>(bits >> 8)};
    return hn::LoadMaskBits(Floats(), bytes);
}

template <bool kMixed>
HWY_INLINE void test_pairs(Walk& walk);

/// Triangles that have the whole tile on one side.
template <bool kSingle>
HWY_INLINE void cast_unmixed(Walk& walk, const LeafVisit& visit, const SeenTriangles& seen,
                             Lanes lanes, const Coefficients& coefficients) {
    const std::uint32_t masked = walk.masked(visit.id) >> visit.first_lane;
    const Lanes solid = hn::And(lanes, lanes_of(~masked));
    const Vf error = coefficients.error, minus_error = hn::Neg(error);
    const Vf first = load(seen.first), last = load(seen.last);
    OpenSteps steps(walk, seen);
    for (int step = steps.next(); step >= 0; step = steps.next()) {
        const Lanes active = seen_at(first, last, step);
        const Terms<kSingle> terms(coefficients, sun_at(walk, step));
        const std::uint32_t all =
            bits_of(hn::And(hn::And(active, solid), hn::Gt(terms.least(), error)));
        if (all != 0) {
            walk.credit(visit.id, visit.first_lane + std::countr_zero(all), walk.tile.texels);
            walk.darken(step, ~std::uint64_t{0});
            continue;
        }
        const Lanes some = hn::And(hn::And(active, lanes), hn::Ge(terms.greatest(), minus_error));
        // In a whole leaf this is seldom otherwise, and a branch would cost more than it saves.
        if ((kSingle || kLanes < kWidth) && hn::AllFalse(Floats(), some)) continue;
        const SomeLanes appended(some);
        append_indices(walk.pairs, appended, step, visit);
        append_edges(walk.pairs, appended, terms, error);
        walk.pairs.count += appended.count();
        if (walk.pairs.count > Pairs::kCapacity - kWidth) test_pairs<false>(walk);
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
HWY_INLINE void cast_mixed(Walk& walk, const LeafVisit& visit, const SeenTriangles& seen,
                           std::uint32_t lanes, const Coefficients& coefficients,
                           const Sides& sides) {
    // Triangles whose height is still to be judged, and those it is left to each texel for.
    std::uint32_t unjudged = seen.low, varying = 0;
    const Vf minus_error = hn::Neg(coefficients.error);
    const Vf first = load(seen.first), last = load(seen.last);
    OpenSteps steps(walk, seen);
    for (int step = steps.next(); step >= 0; step = steps.next()) {
        Terms<kSingle> terms(coefficients, sun_at(walk, step));
        const Vf signs = hn::And(terms.det, splat(-0.0f));
        terms.negate_where(signs);
        const Lanes active = seen_at(first, last, step);
        std::uint32_t some =
            bits_of(hn::And(active, hn::Ge(terms.greatest(), minus_error))) & lanes;
        if ((some & unjudged) != 0) {
            lanes &= ~judge_heights(walk, visit, some & unjudged, varying);
            unjudged &= ~some;
            some &= lanes;
        }
        if (some == 0) continue;
        Pairs& pairs = walk.mixed_pairs;
        const SomeLanes appended(lanes_of(some));
        append_indices(pairs, appended, step, visit);
        append_edges(pairs, appended, terms, coefficients.error);
        append_sides(pairs, appended, sides, signs, lanes_of(varying));
        pairs.count += std::popcount(some);
        if (pairs.count > Pairs::kCapacity - kWidth) test_pairs<true>(walk);
    }
}

template <bool kSingle>
HWY_INLINE void cast(Walk& walk, const LeafVisit& visit, const SeenTriangles& seen) {
    const Triangles t = triangles_of(walk.tile, visit);
    const Vec3f normal = cross(t.edge1, t.edge2);
    const Sides sides = sides_of(walk.tile, t, normal);
    const Vf reach = hn::MulAdd(
        splat(kRoundUp), hn::Add(hn::Abs(sides.along_s), hn::Abs(sides.along_t)), sides.error);
    const Lanes present = lanes_of(seen.any);
    const Lanes mixed =
        hn::And(present, hn::Or(hn::Le(hn::Abs(sides.center), reach), lanes_of(seen.low)));
    const Vf signs = hn::IfThenZeroElse(mixed, hn::And(sides.center, splat(-0.0f)));
    const Coefficients coefficients = coefficients_of(walk.tile, t, normal, signs);
    const std::uint32_t mixed_bits = bits_of(mixed);
    if (mixed_bits != seen.any) {
        cast_unmixed<kSingle>(walk, visit, seen, hn::AndNot(mixed, present), coefficients);
    }
    if (mixed_bits != 0) cast_mixed<kSingle>(walk, visit, seen, mixed_bits, coefficients, sides);
}

/// The waiting leaves: the steps of all first, because those are computed without a branch.
template <bool kSingle>
HWY_INLINE void cast_leaves(Walk& walk) {
    SeenTriangles seen[Walk::kLeafBatch * kVisits];
    const int count = walk.leaf_count;
    walk.leaf_count = 0;
    for (int i = 0; i < count; ++i)
        find_steps<kSingle>(walk, walk.leaves[i], seen[i]);
    for (int i = 0; i < count; ++i) {
        if (seen[i].any == 0 || !walk.any_open(seen[i].first_step, seen[i].last_step)) continue;
        cast<kSingle>(walk, walk.leaves[i], seen[i]);
    }
    if (walk.pairs.count >= Pairs::kBatch) test_pairs<false>(walk);
    if (walk.mixed_pairs.count >= Pairs::kBatch) test_pairs<true>(walk);
}

}  // namespace gnomon::interval::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
