// Leaves that a single texel sees at few steps: each triangle is tested at each of them, with what
// bounds the errors of all of a leaf's triangles, because finding what bounds each one's takes
// longer than the test. See terms.inl.h. Compiled once for each instruction set: see walk.cpp.

#if defined(GNOMON_INTERVAL_SINGLE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GNOMON_INTERVAL_SINGLE_INL_H
#undef GNOMON_INTERVAL_SINGLE_INL_H
#else
#define GNOMON_INTERVAL_SINGLE_INL_H
#endif

#include "interval/leaf.inl.h"

#include <bit>

HWY_BEFORE_NAMESPACE();
namespace gnomon::interval::HWY_NAMESPACE {

/// What u, v and w err, and det: see error_of(). No edge is longer than the box's sides together.
HWY_INLINE float error_of(const Tile& tile, const BoxBounds& box) {
    constexpr float kRounding = kTermRoundings * kUnitRoundoff;
    const float center_m =
        std::abs(tile.center_m[0]) + std::abs(tile.center_m[1]) + std::abs(tile.center_m[2]);
    const float place_m = kRounding * box.reach_m + kUnitRoundoff * center_m + tile.residual_m;
    const float of_terms = box.sides_m * (2.0f * place_m + kRounding * box.sides_m);
    return kRoundUp * (of_terms + kRounding * box.sides_m * box.sides_m);
}

/// u, v and det of a register of triangles that are above the texel's plane. The line of a ray hits
/// them where the ray itself does, so that the sign of det tells on which side the texel is. Near 0
/// it may be wrong; then no term is greater than what det errs.
struct FewTerms {
    Vec3f u, v, det;

    HWY_INLINE FewTerms(const Tile& tile, const LeafVisit& visit) {
        const Triangles t = triangles_of(tile, visit);
        u = cross(t.corner, t.edge2);
        v = cross(t.edge1, t.corner);
        det = cross(t.edge2, t.edge1);
    }

    /// min(u, v, w) at a step.
    HWY_INLINE Vf least(Vec3f sun) const {
        const Vf at = dot(sun, det), sign = hn::And(at, splat(-0.0f));
        const Vf at_u = hn::Xor(dot(sun, u), sign), at_v = hn::Xor(dot(sun, v), sign);
        return hn::Min(hn::Min(at_u, at_v), hn::Sub(hn::Sub(hn::Abs(at), at_u), at_v));
    }
};

/// Whether one of the triangles `possible` is in the way at a step, in double.
HWY_INLINE bool is_blocked(const Walk& walk, const LeafVisit& visit, int step,
                           std::uint32_t possible) {
    const std::uint32_t masked = walk.masked(visit.id) >> visit.first_lane;
    for (; possible != 0; possible &= possible - 1) {
        const int lane = std::countr_zero(possible);
        const bool is_solid = (masked >> lane & 1) == 0;
        if (blocked_texels(walk, 1, step, visit.id, visit.first_lane + lane, is_solid) != 0)
            return true;
    }
    return false;
}

/// Which steps of `open`, bit 0 being the visit's first one, a register of a leaf's triangles
/// darkens. Without a branch that depends on whether they do.
HWY_INLINE std::uint64_t darkened_steps(Walk& walk, const LeafVisit& visit, float term_error,
                                        std::uint64_t open, std::uint32_t masked) {
    const FewTerms terms(walk.tile, visit);
    const Vf error = splat(term_error), possible_from = splat(-term_error);
    const float* const x = walk.sun[0] + visit.first_step;
    const float* const y = walk.sun[1] + visit.first_step;
    const float* const z = walk.sun[2] + visit.first_step;
    const auto least_at = [&](int i) HWY_ATTR {
        return terms.least({splat(x[i]), splat(y[i]), splat(z[i])});
    };
    std::uint64_t dark = 0, possible = 0;
    for (std::uint64_t rest = open; rest != 0; rest &= rest - 1) {
        const int bit = std::countr_zero(rest);
        const Vf least = least_at(bit);
        const bool is_dark = (bits_of(hn::Gt(least, error)) & ~masked) != 0;
        const bool is_possible = bits_of(hn::Ge(least, possible_from)) != 0;
        dark |= std::uint64_t{is_dark} << bit;
        possible |= std::uint64_t{is_possible} << bit;
    }
    for (std::uint64_t unsure = possible & ~dark; unsure != 0; unsure &= unsure - 1) {
        const int bit = std::countr_zero(unsure);
        const std::uint32_t lanes = bits_of(hn::Ge(least_at(bit), possible_from));
        dark |= std::uint64_t{is_blocked(walk, visit, visit.first_step + bit, lanes)} << bit;
    }
    if (std::popcount(dark) >= kLeastSingleGain) {
        const std::uint32_t lanes =
            bits_of(hn::Gt(least_at(std::countr_zero(dark)), error)) & ~masked;
        if (lanes != 0)
            walk.credit(visit.id, visit.first_lane + std::countr_zero(lanes), std::popcount(dark));
    }
    return dark;
}

/// The triangles of a leaf above the texel's plane at all open steps, at most 64.
HWY_INLINE void cast_few(Walk& walk, const Leaf& leaf, const Walk::Entry& entry) {
    const std::int32_t id = ~entry.child;
    const float error = error_of(walk.tile, entry.bounds);
    const std::uint64_t open = walk.open_window(entry.first_step, entry.last_step);
    const std::uint32_t masked = walk.masked(id);
    std::uint64_t dark = 0;
    for (int lane0 = 0; lane0 < kWidth && !std::isnan(leaf.corner[0][lane0]); lane0 += kLanes) {
        const LeafVisit visit{&leaf, id, lane0, entry.first_step, entry.last_step};
        dark |= darkened_steps(walk, visit, error, open, masked >> lane0);
    }
    walk.darken_window(entry.first_step, dark);
}

}  // namespace gnomon::interval::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
