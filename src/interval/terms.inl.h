// What is linear in the direction of the sun, for a register of triangles and a tile of texels.
// Compiled once for each instruction set: see walk.cpp.
//
// A ray from o along d hits the triangle (c, c + a, c + b) where u, v and w are not negative,
//     u = d . ((c - o) x b),  v = d . (a x (c - o)),  det = -d . (a x b),  w = det - u - v,
// with all signs turned when det is negative; it is in front when (o - c) . (a x b) has the sign of
// det. (T. Möller, B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997, with the
// products in another order.) All are linear in d and in o.
//
// For a tile all of it is in the tile's own coordinates: s and t, in which it is [-1, 1] x [-1, 1],
// and the height over its plane. The sun's direction is made as high as 1 there; what is left of it
// is its slant, and a point p at height h casts its shadow at p - h * slant (J. Blinn, "Me and My
// (Fake) Shadow", IEEE Computer Graphics and Applications 8(1), 1988). With a' and b', the shadows
// of the edges, u at (s, t) is u - s * b'.t + t * b'.s, and v is v + s * a'.t - t * a'.s: twelve
// multiplications tell of all texels at a step whether none, some, or all can be hit, and whether
// the rectangle around the shadow meets the tile at all.
//
// The greatest error of the float arithmetic is known; within it, double decides. Hence no answer
// depends on the tile, on the instruction set or on the order of anything.

#if defined(GNOMON_INTERVAL_TERMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GNOMON_INTERVAL_TERMS_INL_H
#undef GNOMON_INTERVAL_TERMS_INL_H
#else
#define GNOMON_INTERVAL_TERMS_INL_H
#endif

#include "interval/ranges.inl.h"

HWY_BEFORE_NAMESPACE();
namespace gnomon::interval::HWY_NAMESPACE {

inline constexpr float kUnitRoundoff = static_cast<float>(trace::kUnitRoundoff);
/// Makes sure that a bound is not rounded down below what it bounds.
inline constexpr float kRoundUp = 1.0f + 1e-4f;
/// Roundings of a term of a single texel, relative to the sums of magnitudes of the two vectors
/// whose product it is: inputs 3, cross product 2, scalar product 6 without fused multiply-add; and
/// five to spare.
inline constexpr float kTermRoundings = 16.0f;
/// Of a term in a tile's coordinates, into which vectors are turned first: that is 9 for each of
/// two, inputs 2, cross product 4, the slant 12, scalar product 4, adding up what s and t
/// contribute 4; and some to spare. The slant's are relative to the direction before it is made as
/// high as 1, so that all of them are stretched with it.
inline constexpr float kTileRoundings = 48.0f;

template <bool kSingle>
inline constexpr float kRoundings = kSingle ? kTermRoundings : kTileRoundings;

/// Triangles of a leaf relative to the tile's centre.
struct Triangles {
    Vec3f corner, edge1, edge2;
};

HWY_INLINE Triangles triangles_of(const Tile& tile, const LeafVisit& visit) {
    return {load3(visit.leaf->corner, visit.first_lane) - splat3(tile.center_m),
            load3(visit.leaf->edge1, visit.first_lane), load3(visit.leaf->edge2, visit.first_lane)};
}

/// What u, v and w of triangles err, in the tree's frame.
template <bool kSingle>
HWY_INLINE Vf error_of(const Tile& tile, const Triangles& t, Vf& place_m) {
    const Vf size1 = sum_of_magnitudes(t.edge1), size2 = sum_of_magnitudes(t.edge2);
    const Vf around = hn::Add(sum_of_magnitudes(t.corner), splat(tile.size_m));
    // Corners of triangles are rounded once, relative to the scene's middle.
    place_m = hn::MulAdd(
        splat(kUnitRoundoff),
        hn::MulAdd(splat(kRoundings<kSingle>), around, sum_of_magnitudes(splat3(tile.center_m))),
        splat(tile.residual_m));
    const Vf error =
        hn::MulAdd(hn::Add(size1, size2), place_m,
                   hn::Mul(splat(kRoundings<kSingle> * kUnitRoundoff), hn::Mul(size1, size2)));
    place_m =
        hn::MulAdd(splat(kRoundings<kSingle> * kUnitRoundoff), hn::Add(size1, size2), place_m);
    return hn::Mul(splat(kRoundUp), error);
}

/// A vector in a tile's coordinates: along s and t, and its height over the tile's plane.
HWY_INLINE Vec3f in_tile(const Tile& tile, Vec3f v) {
    return {dot(splat3(tile.s_per_m), v), dot(splat3(tile.t_per_m), v),
            dot(splat3(tile.normal), v)};
}

/// Triangles in a tile's coordinates.
struct TileTriangles {
    Vec3f corner, edge1, edge2;
    Vf error, corner_error;  ///< of u, v and w, and of a shadow's corners

    TileTriangles() = default;
    HWY_INLINE TileTriangles(const Tile& tile, const Triangles& t)
        : corner(in_tile(tile, t.corner)),
          edge1(in_tile(tile, t.edge1)),
          edge2(in_tile(tile, t.edge2)) {
        Vf place_m;
        error = hn::Mul(error_of<false>(tile, t, place_m), splat(tile.per_m2));
        corner_error = hn::Mul(place_m, splat(tile.per_m));
    }
};

/// The terms as vectors to be multiplied with the sun's direction, and what they err.
template <bool kSingle>
struct Coefficients;

/// Of a single texel: nothing varies with s and t.
template <>
struct Coefficients<true> {
    Vec3f u, v, det;
    Vf error;

    /// `turned`: lanes whose determinant is negative where rays hit them.
    HWY_INLINE Coefficients(const Tile& tile, const Triangles& t, Vec3f normal, Lanes turned) {
        const Vf signs = hn::IfThenElseZero(turned, splat(-0.0f));
        u = negated_where(cross(t.corner, t.edge2), signs);
        v = negated_where(cross(t.edge1, t.corner), signs);
        det = negated_where(normal, hn::Xor(signs, splat(-0.0f)));
        Vf place_m;
        error = error_of<true>(tile, t, place_m);
    }
};

/// In a tile's coordinates.
template <>
struct Coefficients<false> {
    Vec3f u, v, det;
    Vec3f corner, edge1, edge2;
    Vf error, corner_error;

    HWY_INLINE Coefficients(const TileTriangles& t, Lanes turned)
        : corner(t.corner), error(t.error), corner_error(t.corner_error) {
        // With its edges swapped, a triangle's terms have the other sign.
        edge1 = chosen(turned, t.edge2, t.edge1);
        edge2 = chosen(turned, t.edge1, t.edge2);
        u = cross(corner, edge2);
        v = cross(edge1, corner);
        det = cross(edge2, edge1);
    }
};

/// Rectangles around shadows in a tile's plane, and what they err.
struct Rectangles {
    Vf low_s, low_t, high_s, high_t, error;

    /// Lanes whose rectangle meets that around groups of texels: Walk::bounds.
    HWY_INLINE Lanes meet(const float* bounds) const {
        const Vf gap_s =
            hn::Max(hn::Add(low_s, splat(bounds[2])), hn::Sub(splat(bounds[0]), high_s));
        const Vf gap_t =
            hn::Max(hn::Add(low_t, splat(bounds[3])), hn::Sub(splat(bounds[1]), high_t));
        return hn::Le(hn::Max(gap_s, gap_t), error);
    }
};

/// The terms at one step.
template <bool kSingle>
struct Terms;

template <>
struct Terms<true> {
    Vf u, v, det, error;

    HWY_INLINE Terms(const Walk& walk, const Coefficients<true>& c, int step) {
        const Vec3f sun{splat(walk.sun[0][step]), splat(walk.sun[1][step]),
                        splat(walk.sun[2][step])};
        u = dot(sun, c.u);
        v = dot(sun, c.v);
        det = dot(sun, c.det);
        error = c.error;
    }

    HWY_INLINE Vf w() const { return hn::Sub(hn::Sub(det, u), v); }
    HWY_INLINE Vf greatest() const { return hn::Min(hn::Min(u, v), w()); }
    HWY_INLINE Vf least() const { return greatest(); }
    /// Lanes that may be hit somewhere in the tile, whatever the sign of det.
    HWY_INLINE Lanes near(const Walk&, const Coefficients<true>&, int) const {
        return hn::Eq(error, error);
    }
    HWY_INLINE void negate_where(Vf signs) {
        for (Vf* term : {&u, &v, &det})
            *term = hn::Xor(*term, signs);
    }
    HWY_INLINE void store(float* to) const {
        const Vf terms[Term::side] = {u,           v,           det,         splat(0.0f),
                                      splat(0.0f), splat(0.0f), splat(0.0f), error};
        for (int i = 0; i < Term::side; ++i)
            hn::Store(terms[i], Floats(), to + i * kLanes);
    }
};

template <>
struct Terms<false> {
    Vf u, v, det, error;
    Vf edge1_s, edge1_t, edge2_s, edge2_t;

    HWY_INLINE Terms(const Walk& walk, const Coefficients<false>& c, int step) {
        const Vf slant_s = splat(walk.slant_s[step]), slant_t = splat(walk.slant_t[step]);
        const auto at = [&](const Vec3f& term) HWY_ATTR {
            return hn::MulAdd(slant_s, term.x, hn::MulAdd(slant_t, term.y, term.z));
        };
        u = at(c.u);
        v = at(c.v);
        det = at(c.det);
        error = hn::Mul(c.error, splat(walk.stretch[step]));
        edge1_s = hn::NegMulAdd(slant_s, c.edge1.z, c.edge1.x);
        edge1_t = hn::NegMulAdd(slant_t, c.edge1.z, c.edge1.y);
        edge2_s = hn::NegMulAdd(slant_s, c.edge2.z, c.edge2.x);
        edge2_t = hn::NegMulAdd(slant_t, c.edge2.z, c.edge2.y);
    }

    HWY_INLINE Vf w() const { return hn::Sub(hn::Sub(det, u), v); }
    /// How far u, v and w can be from the centre's over the tile.
    HWY_INLINE Vf reach_u() const { return hn::Add(hn::Abs(edge2_t), hn::Abs(edge2_s)); }
    HWY_INLINE Vf reach_v() const { return hn::Add(hn::Abs(edge1_t), hn::Abs(edge1_s)); }
    HWY_INLINE Vf reach_w() const {
        return hn::Add(hn::Abs(hn::Sub(edge1_t, edge2_t)), hn::Abs(hn::Sub(edge1_s, edge2_s)));
    }
    /// The greatest and the least of min(u, v, w) over the tile, or a bound.
    HWY_INLINE Vf greatest() const {
        return hn::Min(hn::Min(hn::Add(u, reach_u()), hn::Add(v, reach_v())),
                       hn::Add(w(), reach_w()));
    }
    HWY_INLINE Vf least() const {
        return hn::Min(hn::Min(hn::Sub(u, reach_u()), hn::Sub(v, reach_v())),
                       hn::Sub(w(), reach_w()));
    }
    HWY_INLINE Rectangles rectangles(const Walk& walk, const Coefficients<false>& c,
                                     int step) const {
        const Vf zero = splat(0.0f);
        const Vf s = hn::NegMulAdd(splat(walk.slant_s[step]), c.corner.z, c.corner.x);
        const Vf t = hn::NegMulAdd(splat(walk.slant_t[step]), c.corner.z, c.corner.y);
        return {hn::Add(s, hn::Min(zero, hn::Min(edge1_s, edge2_s))),
                hn::Add(t, hn::Min(zero, hn::Min(edge1_t, edge2_t))),
                hn::Add(s, hn::Max(zero, hn::Max(edge1_s, edge2_s))),
                hn::Add(t, hn::Max(zero, hn::Max(edge1_t, edge2_t))),
                hn::MulAdd(c.corner_error, splat(walk.stretch[step]), splat(kRoundUp - 1.0f))};
    }
    /// Lanes whose shadow's rectangle meets that around the lit texels.
    HWY_INLINE Lanes near(const Walk& walk, const Coefficients<false>& c, int step) const {
        return rectangles(walk, c, step).meet(walk.bounds[walk.lit_groups(step)]);
    }
    HWY_INLINE void negate_where(Vf signs) {
        for (Vf* term : {&u, &v, &det, &edge1_s, &edge1_t, &edge2_s, &edge2_t})
            *term = hn::Xor(*term, signs);
    }
    HWY_INLINE void store(float* to) const {
        const Vf terms[Term::side] = {u, v, det, edge1_s, edge1_t, edge2_s, edge2_t, error};
        for (int i = 0; i < Term::side; ++i)
            hn::Store(terms[i], Floats(), to + i * kLanes);
    }
};

/// (o - c) . (a x b) over the tile, in the tree's frame.
struct Sides {
    Vf center, along_s, along_t, error;
};

template <bool kSingle>
HWY_INLINE Sides sides_of(const Tile& tile, const Triangles& t, Vec3f normal) {
    const Vf size = hn::Mul(sum_of_magnitudes(t.corner),
                            hn::Mul(sum_of_magnitudes(t.edge1), sum_of_magnitudes(t.edge2)));
    const Vf place_m =
        hn::MulAdd(splat(kUnitRoundoff),
                   hn::Add(sum_of_magnitudes(splat3(tile.center_m)), sum_of_magnitudes(t.corner)),
                   splat(tile.touch_m));
    const Vf error = hn::MulAdd(sum_of_magnitudes(normal), place_m,
                                hn::Mul(splat(kTermRoundings * kUnitRoundoff), size));
    Sides sides{hn::Neg(dot(t.corner, normal)), splat(0.0f), splat(0.0f),
                hn::Mul(splat(kRoundUp), error)};
    if constexpr (!kSingle) {
        sides.along_s = dot(splat3(tile.u_axis_m), normal);
        sides.along_t = dot(splat3(tile.v_axis_m), normal);
    }
    return sides;
}

}  // namespace gnomon::interval::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
