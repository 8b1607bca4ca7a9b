// Which triangles of a leaf can be in the way of a tile of texels, and at which steps. Compiled
// once for each instruction set: see walk.cpp.

#if defined(GNOMON_INTERVAL_STEPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GNOMON_INTERVAL_STEPS_INL_H
#undef GNOMON_INTERVAL_STEPS_INL_H
#else
#define GNOMON_INTERVAL_STEPS_INL_H
#endif

#include "interval/terms.inl.h"

#include <bit>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace gnomon::interval::HWY_NAMESPACE {

/// Visits of one leaf, a register each.
inline constexpr int kVisits = kWidth / kLanes;

/// The triangles of a visit that some step can see, and the steps.
template <bool kSingle>
struct SeenTriangles;

/// Of a single texel: the first and the last step of all, and those of each unless the leaf is seen
/// at few steps.
template <>
struct SeenTriangles<true> {
    std::uint32_t any;
    std::uint32_t low;  ///< those that may be on or below the tile's plane
    int first_step, last_step;
    bool has_steps_of_each;
    alignas(64) float first_of_each[kLanes], last_of_each[kLanes];

    int first_word() const { return first_step / 64; }
    int last_word() const { return last_step / 64; }
    std::uint64_t open_steps(const Walk& walk, int word) const {
        return walk.open_steps(word, first_step, last_step);
    }
    bool any_open(const Walk& walk) const { return walk.any_open(first_step, last_step); }
};

/// Of a tile: the steps at which a shadow can fall on it, in the words from the first to the last.
template <>
struct SeenTriangles<false> {
    std::uint32_t any, low;
    bool are_above;  ///< all corners of all that are seen, by more than touches
    TileTriangles triangles;
    int first, last;
    std::uint64_t steps[Walk::kMaxWords];

    int first_word() const { return first; }
    int last_word() const { return last; }
    std::uint64_t open_steps(const Walk& walk, int word) const {
        return walk.open[word] & steps[word];
    }
    bool any_open(const Walk& walk) const {
        std::uint64_t open = 0;
        for (int word = first; word <= last; ++word)
            open |= open_steps(walk, word);
        return open != 0;
    }
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

/// What heights of triangles' corners over the tile's plane err.
HWY_INLINE Vf height_error(const Tile& tile, const Triangles& t) {
    const Vf size = hn::Add(sum_of_magnitudes(t.corner),
                            hn::Add(sum_of_magnitudes(t.edge1), sum_of_magnitudes(t.edge2)));
    return hn::MulAdd(size, splat(kTermRoundings * kUnitRoundoff), splat(tile.touch_m));
}

/// Of the triangles' highest corners.
struct Heights {
    Vf top, error;
};

HWY_INLINE Heights heights_of(const Tile& tile, const Triangles& t) {
    const Vec3f normal = splat3(tile.normal);
    const Vf height1 = dot(normal, t.edge1), height2 = dot(normal, t.edge2);
    const Vf top = hn::Add(dot(normal, t.corner), hn::Max(splat(0.0f), hn::Max(height1, height2)));
    return {top, height_error(tile, t)};
}

/// Where a leaf is seen at fewer steps, testing all of its triangles at each takes less time than
/// finding out more.
inline constexpr int kFewSteps = 8;

/// Of a single texel: by the azimuths of the triangles.
HWY_INLINE void find_steps(const Walk& walk, const LeafVisit& visit, SeenTriangles<true>& seen) {
    const Triangles t = triangles_of(walk.tile, visit);
    const Heights heights = heights_of(walk.tile, t);
    const Lanes above = hn::Gt(heights.top, hn::Neg(heights.error));
    seen.low = bits_of(hn::Le(heights.top, heights.error));
    seen.has_steps_of_each = visit.last_step - visit.first_step >= kFewSteps;
    if (!seen.has_steps_of_each) {
        seen.any = bits_of(above);
        seen.first_step = visit.first_step;
        seen.last_step = visit.last_step;
        return;
    }
    const Steps steps =
        cut(steps_towards(walk.ranges, boxes_of(walk.tile, t)), visit.first_step, visit.last_step);
    seen.any = bits_of(hn::And(steps.any, above));
    hn::Store(steps.first, Floats(), seen.first_of_each);
    hn::Store(steps.last, Floats(), seen.last_of_each);
    const Vf none_first = splat(walk.ranges.last_step), none_last = splat(0.0f);
    const Vf first = hn::IfThenElse(steps.any, steps.first, none_first);
    const Vf last = hn::IfThenElse(steps.any, steps.last, none_last);
    seen.first_step = static_cast<int>(hn::GetLane(hn::MinOfLanes(Floats(), first)));
    seen.last_step = static_cast<int>(hn::GetLane(hn::MaxOfLanes(Floats(), last)));
}

/// What holds the triangles of a visit, in the tile's coordinates. Its shadow is found at a
/// register of steps in less time than those of its triangles at one.
class ShadowBox {
public:
    HWY_INLINE ShadowBox(const TileTriangles& t, Lanes some)
        : s_(extent(t.corner.x, t.edge1.x, t.edge2.x, some)),
          t_(extent(t.corner.y, t.edge1.y, t.edge2.y, some)),
          height_(extent(t.corner.z, t.edge1.z, t.edge2.z, some)),
          corner_error_(hn::MaxOfLanes(Floats(), hn::IfThenElseZero(some, t.corner_error))) {}

    /// The steps of a register from `step` at which the shadow meets the tile: bit 0 is `step`.
    HWY_INLINE std::uint64_t steps_on_tile(const Walk& walk, int step) const {
        const Extent s = shadow(s_, hn::LoadU(Floats(), walk.slant_s + step));
        const Extent t = shadow(t_, hn::LoadU(Floats(), walk.slant_t + step));
        const Vf beyond = hn::Max(hn::Max(s.low, t.low), hn::Neg(hn::Min(s.high, t.high)));
        const Vf stretch = hn::LoadU(Floats(), walk.stretch + step);
        return bits_of(hn::Le(beyond, hn::MulAdd(corner_error_, stretch, splat(kRoundUp))));
    }

private:
    struct Extent {
        Vf low, high;
    };

    HWY_INLINE static Extent extent(Vf corner, Vf edge1, Vf edge2, Lanes some) {
        const Vf zero = splat(0.0f), far = splat(std::numeric_limits<float>::max());
        const Vf low = hn::Add(corner, hn::Min(zero, hn::Min(edge1, edge2)));
        const Vf high = hn::Add(corner, hn::Max(zero, hn::Max(edge1, edge2)));
        return {hn::MinOfLanes(Floats(), hn::IfThenElse(some, low, far)),
                hn::MaxOfLanes(Floats(), hn::IfThenElse(some, high, hn::Neg(far)))};
    }
    HWY_INLINE Extent shadow(const Extent& along, Vf slant) const {
        const Vf low = hn::Mul(slant, height_.low), high = hn::Mul(slant, height_.high);
        return {hn::Sub(along.low, hn::Max(low, high)), hn::Sub(along.high, hn::Min(low, high))};
    }

    Extent s_, t_, height_;
    Vf corner_error_;
};

/// Of a tile: by the shadow of what holds all triangles.
HWY_INLINE void find_steps(const Walk& walk, const LeafVisit& visit, SeenTriangles<false>& seen) {
    constexpr std::uint64_t kRegister = (std::uint64_t{1} << kLanes) - 1;
    const Triangles t = triangles_of(walk.tile, visit);
    seen.triangles = TileTriangles(walk.tile, t);
    const Vf zero = splat(0.0f), error = height_error(walk.tile, t);
    const Vf height = seen.triangles.corner.z;
    const Vf height1 = seen.triangles.edge1.z, height2 = seen.triangles.edge2.z;
    const Vf top = hn::Add(height, hn::Max(zero, hn::Max(height1, height2)));
    const Vf bottom = hn::Add(height, hn::Min(zero, hn::Min(height1, height2)));
    const Lanes above = hn::Gt(top, hn::Neg(error));
    seen.any = bits_of(above);
    seen.low = bits_of(hn::Le(top, error));
    seen.are_above = bits_of(hn::AndNot(hn::Gt(bottom, error), above)) == 0;
    seen.first = visit.first_step / 64;
    seen.last = visit.last_step / 64;
    for (int word = seen.first; word <= seen.last; ++word)
        seen.steps[word] = walk.open_steps(word, visit.first_step, visit.last_step);
    if (visit.last_step - visit.first_step < kFewSteps) return;
    const ShadowBox box(seen.triangles, above);
    for (int word = seen.first; word <= seen.last; ++word) {
        std::uint64_t met = 0;
        for (std::uint64_t rest = seen.steps[word]; rest != 0;) {
            const int bit = std::countr_zero(rest);
            met |= box.steps_on_tile(walk, 64 * word + bit) << bit & rest;
            rest &= ~(kRegister << bit);
        }
        seen.steps[word] = met;
    }
}

/// The open ones of the steps at which triangles are seen, one after the other.
template <bool kSingle>
class OpenSteps {
public:
    HWY_INLINE OpenSteps(const Walk& walk, const SeenTriangles<kSingle>& seen)
        : walk_(walk), seen_(seen), word_(seen.first_word()), bits_(seen.open_steps(walk, word_)) {}

    /// Less than 0 after the last.
    HWY_INLINE int next() {
        while (bits_ == 0) {
            if (++word_ > seen_.last_word()) return -1;
            bits_ = seen_.open_steps(walk_, word_);
        }
        const int step = 64 * word_ + std::countr_zero(bits_);
        bits_ &= bits_ - 1;
        return step;
    }

private:
    const Walk& walk_;
    const SeenTriangles<kSingle>& seen_;
    int word_;
    std::uint64_t bits_;
};

}  // namespace gnomon::interval::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
