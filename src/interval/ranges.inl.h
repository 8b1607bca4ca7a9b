// Which steps of the day can see boxes. Compiled once for each instruction set: see walk.cpp.

#if defined(GNOMON_INTERVAL_RANGES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GNOMON_INTERVAL_RANGES_INL_H
#undef GNOMON_INTERVAL_RANGES_INL_H
#else
#define GNOMON_INTERVAL_RANGES_INL_H
#endif

#include "interval/walk.h"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace gnomon::interval::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kWidth>;
using Ints = hn::RebindToSigned<Floats>;
using Vf = hn::Vec<Floats>;
using Vi = hn::Vec<Ints>;
using Lanes = hn::Mask<Floats>;

/// Lanes of a register: a divisor of kWidth.
inline constexpr int kLanes = static_cast<int>(hn::MaxLanes(Floats()));

HWY_INLINE Vf splat(float value) {
    return hn::Set(Floats(), value);
}
HWY_INLINE Vf load(const float* from) {
    return hn::Load(Floats(), from);
}

/// Bit i is lane i.
HWY_INLINE std::uint32_t bits_of(Lanes lanes) {
    if constexpr (kLanes > 8) {
        std::uint16_t bits = 0;
        hn::StoreMaskBits(Floats(), lanes, reinterpret_cast<std::uint8_t*>(&bits));
        return bits;
    } else {
        std::uint8_t bits = 0;
        hn::StoreMaskBits(Floats(), lanes, &bits);
        return bits;
    }
}

struct Vec3f {
    Vf x, y, z;
};

HWY_INLINE Vec3f splat3(const float* v) {
    return {splat(v[0]), splat(v[1]), splat(v[2])};
}
template <int kCount>
HWY_INLINE Vec3f load3(const float (&lanes)[3][kCount], int first) {
    return {load(lanes[0] + first), load(lanes[1] + first), load(lanes[2] + first)};
}
HWY_INLINE Vec3f negated_where(Vec3f v, Vf signs) {
    return {hn::Xor(v.x, signs), hn::Xor(v.y, signs), hn::Xor(v.z, signs)};
}
HWY_INLINE Vec3f chosen(Lanes lanes, Vec3f yes, Vec3f no) {
    return {hn::IfThenElse(lanes, yes.x, no.x), hn::IfThenElse(lanes, yes.y, no.y),
            hn::IfThenElse(lanes, yes.z, no.z)};
}
HWY_INLINE Vec3f operator-(Vec3f a, Vec3f b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vf dot(Vec3f a, Vec3f b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE Vf product_difference(Vf a, Vf b, Vf c, Vf d) {
    return hn::MulSub(a, b, hn::Mul(c, d));
}
HWY_INLINE Vec3f cross(Vec3f a, Vec3f b) {
    return {product_difference(a.y, b.z, a.z, b.y), product_difference(a.z, b.x, a.x, b.z),
            product_difference(a.x, b.y, a.y, b.x)};
}
HWY_INLINE Vf sum_of_magnitudes(Vec3f v) {
    return hn::Add(hn::Abs(v.x), hn::Add(hn::Abs(v.y), hn::Abs(v.z)));
}

/// Boxes relative to a point, or to a tile: all that corners of the one minus points of the other
/// can be.
struct Boxes {
    Vec3f lower, upper;
};

/// Steps [first, last], as floats; none where `any` is false.
struct Steps {
    Lanes any;
    Vf first, last;
};

/// An odd polynomial of degree 11 that errs by less than kAtanError_rad on [0, 1], and the symmetry
/// of the rest.
HWY_INLINE Vf atan2(Vf y, Vf x) {
    const Vf ax = hn::Abs(x), ay = hn::Abs(y);
    const Vf longer = hn::Max(hn::Max(ax, ay), splat(1e-30f));  // no division by 0
    const Vf a = hn::Div(hn::Min(ax, ay), longer);
    const Vf a2 = hn::Mul(a, a);
    Vf p = hn::MulAdd(splat(-0.01172120f), a2, splat(0.05265332f));
    p = hn::MulAdd(p, a2, splat(-0.11643287f));
    p = hn::MulAdd(p, a2, splat(0.19354346f));
    p = hn::MulAdd(p, a2, splat(-0.33262347f));
    p = hn::Mul(hn::MulAdd(p, a2, splat(0.99997726f)), a);
    p = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(splat(1.57079633f), p), p);
    p = hn::IfThenElse(hn::Lt(x, splat(0.0f)), hn::Sub(splat(3.14159265f), p), p);
    return hn::CopySign(p, y);
}

/// Whether a direction of the path's slopes can meet each box.
HWY_INLINE Lanes slopes_meet(const RangeTerms& terms, const Boxes& box) {
    const Vf zero = splat(0.0f);
    const Vf dx = hn::Max(hn::Max(box.lower.x, hn::Neg(box.upper.x)), zero);
    const Vf dy = hn::Max(hn::Max(box.lower.y, hn::Neg(box.upper.y)), zero);
    const Vf mx = hn::Max(hn::Neg(box.lower.x), box.upper.x);
    const Vf my = hn::Max(hn::Neg(box.lower.y), box.upper.y);
    // Squared distances from the axis, of the box's nearest and farthest point.
    const Vf near2 = hn::MulAdd(dx, dx, hn::Mul(dy, dy));
    const Vf far2 = hn::MulAdd(mx, mx, hn::Mul(my, my));
    const Vf top2 = hn::Mul(box.upper.z, hn::Abs(box.upper.z));
    const Vf bottom2 = hn::Mul(box.lower.z, hn::Abs(box.lower.z));
    const Vf at_low = terms.low_slope2 < 0.0f ? far2 : near2;
    const Vf at_high = terms.high_slope2 < 0.0f ? near2 : far2;
    return hn::And(hn::Ge(top2, hn::Mul(at_low, splat(terms.low_slope2))),
                   hn::Le(bottom2, hn::Mul(at_high, splat(terms.high_slope2))));
}

/// The steps that can see boxes relative to the tile: they are in the azimuths that the box's
/// rectangle in the xy plane spans as seen from the origin, once or, across the ends of the day,
/// twice.
HWY_INLINE Steps steps_towards(const RangeTerms& terms, const Boxes& box) {
    const Vf zero = splat(0.0f);
    const Lanes above = hn::Gt(box.lower.y, zero), below = hn::Lt(box.upper.y, zero);
    const Lanes right = hn::Gt(box.lower.x, zero), left = hn::Lt(box.upper.x, zero);
    const Lanes around = hn::Not(hn::Or(hn::Or(above, below), hn::Or(right, left)));
    // The corners of the least and of the greatest azimuth.
    const Vf low_x =
        hn::IfThenElse(hn::Or(above, hn::AndNot(below, left)), box.upper.x, box.lower.x);
    const Vf low_y =
        hn::IfThenElse(hn::Or(left, hn::AndNot(right, below)), box.upper.y, box.lower.y);
    const Vf high_x =
        hn::IfThenElse(hn::Or(below, hn::AndNot(above, left)), box.upper.x, box.lower.x);
    const Vf high_y =
        hn::IfThenElse(hn::Or(right, hn::AndNot(left, below)), box.upper.y, box.lower.y);
    Vf low = atan2(low_y, low_x);
    Vf high = atan2(high_y, high_x);
    high = hn::IfThenElse(hn::Gt(low, high), hn::Add(high, splat(6.28318531f)), high);
    if (terms.steps_per_rad < 0.0f) {
        const Vf swapped = low;
        low = high;
        high = swapped;
    }
    Vf first = hn::MulAdd(low, splat(terms.steps_per_rad), splat(terms.first_at_zero));
    Vf last = hn::MulAdd(high, splat(terms.steps_per_rad), splat(terms.last_at_zero));
    // By whole turns to where it ends at or after step 0; one turn later it may begin before the
    // last step.
    const Vf period = splat(terms.period_steps);
    const Vf end = splat(terms.last_step);
    const Vf shift =
        hn::Mul(hn::Ceil(hn::Mul(hn::Neg(last), splat(terms.periods_per_step))), period);
    first = hn::Add(first, shift);
    last = hn::Add(last, shift);
    const Vf first_again = hn::Add(first, period);
    const Lanes once = hn::And(hn::Le(first, end), hn::Ge(last, zero));
    const Lanes again = hn::Le(first_again, end);
    first = hn::Max(hn::Ceil(hn::IfThenElse(once, first, first_again)), zero);
    last = hn::Min(hn::Floor(hn::IfThenElse(again, end, last)), end);
    first = hn::IfThenZeroElse(around, first);
    last = hn::IfThenElse(around, end, last);
    return {hn::And(slopes_meet(terms, box), hn::Le(first, last)), first, last};
}

/// The same, cut to [first, last].
HWY_INLINE Steps cut(const Steps& steps, int first, int last) {
    const Vf from = hn::Max(steps.first, splat(static_cast<float>(first)));
    const Vf to = hn::Min(steps.last, splat(static_cast<float>(last)));
    return {hn::And(steps.any, hn::Le(from, to)), from, to};
}

}  // namespace gnomon::interval::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
