// One walk through the tree for all texels of a tile and all steps of a day.
//
// A ray tracer asks for each texel and step whether a triangle is in the way. Here each box is
// asked which steps can see it from anywhere in the tile, and each triangle which steps it darkens
// for which texels: boxes and triangles are fetched once for 64 texels and 256 steps, and where all
// is dark already nothing is asked. Tracing many rays together as one volume goes back to J. Arvo,
// D. Kirk, "Fast Ray Tracing by Ray Classification", SIGGRAPH 1987; here the volume is swept by the
// sun, and its parts are steps of time.
//
// This file compiles itself for each instruction set (foreach_target.h), and the machine's best is
// chosen when first called.

#define HWY_TARGET_INCLUDE "interval/walk.cpp"
// Registers of unknown size cannot be members of structures; such machines have others as well.
#define HWY_DISABLED_TARGETS \
    (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>
//
#include "interval/leaf.inl.h"
#include "interval/pairs.inl.h"
#include "interval/walk.h"

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace gnomon::interval::HWY_NAMESPACE {

/// Boxes that reach above the tile's plane.
HWY_INLINE Lanes above_tile(const Tile& tile, const Boxes& box) {
    const auto highest = [&](Vf low, Vf high, int axis) HWY_ATTR {
        return hn::Mul(splat(tile.normal[axis]), tile.normal[axis] > 0.0f ? high : low);
    };
    const Vf x = highest(box.lower.x, box.upper.x, 0);
    const Vf y = highest(box.lower.y, box.upper.y, 1);
    const Vf z = highest(box.lower.z, box.upper.z, 2);
    const Vf error = hn::MulAdd(sum_of_magnitudes({x, y, z}), splat(kTermRoundings * kUnitRoundoff),
                                splat(tile.touch_m));
    return hn::Ge(hn::Add(x, hn::Add(y, z)), hn::Neg(error));
}

HWY_INLINE Vf distance2(const Boxes& box) {
    const Vf zero = splat(0.0f);
    const auto gap = [&](Vf low, Vf high)
                         HWY_ATTR { return hn::Max(hn::Max(low, hn::Neg(high)), zero); };
    const Vec3f gaps{gap(box.lower.x, box.upper.x), gap(box.lower.y, box.upper.y),
                     gap(box.lower.z, box.upper.z)};
    return dot(gaps, gaps);
}

template <typename T>
HWY_INLINE void prefetch(const T& object) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&object);
    for (std::size_t line = 0; line < sizeof(T); line += 64)
        hwy::Prefetch(bytes + line);
}

/// Children of a node and the steps that can see them.
struct Children {
    alignas(64) float first[kWidth], last[kWidth];
    /// Distances, as numbers of which no two are the same; -1 = not seen.
    alignas(64) std::int32_t order[kWidth];
    std::uint32_t seen;
};

/// Steps, from the first to the last, at which meeting each with boxes takes less time than finding
/// the azimuths of the boxes.
inline constexpr int kFewRays = 10;

/// How far lines along d pass the boxes with middle c and half sides h, negative where they meet
/// them, along one axis: the other two are y and z. (S. Gottschalk et al., "OBBTree", 1996.)
HWY_INLINE Vf gap(Vf dy, Vf dz, Vf cy, Vf cz, Vf hy, Vf hz) {
    const Vf reach = hn::MulAdd(hn::Abs(dy), hz, hn::Mul(hn::Abs(dz), hy));
    return hn::Sub(hn::Abs(product_difference(dy, cz, dz, cy)), reach);
}

/// The open steps of [first_step, last_step] whose rays meet boxes. Roundings are relative to the
/// magnitudes: inputs 3, products 4, sums 3; some to spare.
HWY_INLINE Steps steps_meeting(const Walk& walk, const Boxes& box, int first_step, int last_step) {
    const Vf half = splat(0.5f);
    const Vec3f sides = box.upper - box.lower;
    const Vec3f h{hn::Mul(half, sides.x), hn::Mul(half, sides.y), hn::Mul(half, sides.z)};
    const Vec3f c{hn::Add(box.lower.x, h.x), hn::Add(box.lower.y, h.y), hn::Add(box.lower.z, h.z)};
    const Vf error = hn::Mul(splat(kTermRoundings * kUnitRoundoff),
                             hn::Add(sum_of_magnitudes(c), sum_of_magnitudes(h)));
    const Vf none = splat(walk.ranges.last_step + 1.0f);
    Vf first = none, last = splat(-1.0f);
    for (int word = first_step / 64; word <= last_step / 64; ++word) {
        std::uint64_t rest = walk.open_steps(word, first_step, last_step);
        for (; rest != 0; rest &= rest - 1) {
            const int step = 64 * word + std::countr_zero(rest);
            const Vec3f d{splat(walk.sun[0][step]), splat(walk.sun[1][step]),
                          splat(walk.sun[2][step])};
            const Vf x = gap(d.y, d.z, c.y, c.z, h.y, h.z);
            const Vf y = gap(d.z, d.x, c.z, c.x, h.z, h.x);
            const Vf z = gap(d.x, d.y, c.x, c.y, h.x, h.y);
            const Vec3f length{hn::Abs(d.x), hn::Abs(d.y), hn::Abs(d.z)};
            const Vf behind = hn::Neg(hn::Add(dot(d, c), dot(length, h)));
            const Lanes met = hn::Le(hn::Max(hn::Max(x, y), hn::Max(z, behind)), error);
            const Vf at = splat(static_cast<float>(step));
            first = hn::Min(first, hn::IfThenElse(met, at, none));
            last = hn::IfThenElse(met, at, last);
        }
    }
    return {hn::Le(first, last), first, last};
}

template <bool kSingle>
HWY_INLINE void find_children(const Walk& walk, const Node& node, int first_step, int last_step,
                              Children& children) {
    const Tile& tile = walk.tile;
    children.seen = 0;
    for (int lane0 = 0; lane0 < kWidth; lane0 += kLanes) {
        const Vi child = hn::Load(Ints(), node.child + lane0);
        const Boxes box{load3(node.lower, lane0) - splat3(tile.upper_m),
                        load3(node.upper, lane0) - splat3(tile.lower_m)};
        const Steps steps = kSingle && last_step - first_step < kFewRays
                                ? steps_meeting(walk, box, first_step, last_step)
                                : cut(steps_towards(walk.ranges, box), first_step, last_step);
        const Lanes present =
            hn::RebindMask(Floats(), hn::Ne(child, hn::Set(Ints(), Node::kNoChild)));
        const Lanes seen = hn::And(hn::And(present, steps.any), above_tile(tile, box));
        // Floats that are not negative are in the order of their bits; the last ones tell lanes.
        const Vi distances =
            hn::AndNot(hn::Set(Ints(), kWidth - 1), hn::BitCast(Ints(), distance2(box)));
        const Vi order = hn::Or(distances, hn::Iota(Ints(), lane0));
        const Vi none = hn::Set(Ints(), -1);
        hn::Store(hn::IfThenElse(hn::RebindMask(Ints(), seen), order, none), Ints(),
                  children.order + lane0);
        hn::Store(steps.first, Floats(), children.first + lane0);
        hn::Store(steps.last, Floats(), children.last + lane0);
        children.seen |= bits_of(seen) << lane0;
    }
}

/// Puts the children on the stack, the nearest on top. Counting those that are farther than each
/// takes no branch that depends on them.
HWY_INLINE void push_children(Walk& walk, const Node& node, const Children& children,
                              Walk::Entry* top) {
    const std::vector<Leaf>& leaves = walk.tree->leaves();
    for (std::uint32_t rest = children.seen; rest != 0; rest &= rest - 1) {
        const int lane = std::countr_zero(rest);
        const Vi order = hn::Set(Ints(), children.order[lane]);
        std::size_t farther = 0;
        for (int lane0 = 0; lane0 < kWidth; lane0 += kLanes) {
            farther +=
                hn::CountTrue(Ints(), hn::Gt(hn::Load(Ints(), children.order + lane0), order));
        }
        const std::int32_t child = node.child[lane];
        top[farther] = {child, static_cast<std::int32_t>(children.first[lane]),
                        static_cast<std::int32_t>(children.last[lane])};
        if (child < 0) prefetch(leaves[static_cast<std::size_t>(~child)]);
    }
}

HWY_INLINE void visit_leaf(Walk& walk, const Leaf& leaf, std::int32_t id, int first_step,
                           int last_step) {
    for (int lane0 = 0; lane0 < kWidth && !std::isnan(leaf.corner[0][lane0]); lane0 += kLanes)
        walk.leaves[walk.leaf_count++] = {&leaf, id, lane0, first_step, last_step};
}

template <bool kSingle>
HWY_INLINE bool walk_nodes(Walk& walk) {
    const std::vector<Node>& nodes = walk.tree->nodes();
    const std::vector<Leaf>& leaves = walk.tree->leaves();
    visit_leaf(walk, walk.hint_leaf, kHintLeaf, 0, walk.steps - 1);
    cast_leaves<kSingle>(walk);
    test_pairs<false>(walk);
    test_pairs<true>(walk);
    int entries = 0;
    walk.stack[entries++] = {0, 0, walk.steps - 1};
    while (entries > 0) {
        Walk::Entry entry = walk.stack[--entries];
        // What is dark to all texels of a tile is too little to make up for looking closely.
        const bool is_open = kSingle ? walk.narrow(entry.first_step, entry.last_step)
                                     : walk.any_open(entry.first_step, entry.last_step);
        if (!is_open) continue;
        if (entry.child < 0) {
            const auto id = ~entry.child;
            visit_leaf(walk, leaves[static_cast<std::size_t>(id)], id, entry.first_step,
                       entry.last_step);
            if (walk.leaf_count <= (Walk::kLeafBatch - 1) * kVisits) continue;
            cast_leaves<kSingle>(walk);
            // Nodes alone take little time.
            if (walk.has_deadline && is_late(walk)) return false;
            continue;
        }
        const Node& node = nodes[static_cast<std::size_t>(entry.child)];
        Children children;
        find_children<kSingle>(walk, node, entry.first_step, entry.last_step, children);
        push_children(walk, node, children, walk.stack + entries);
        entries += std::popcount(children.seen);
    }
    cast_leaves<kSingle>(walk);
    test_pairs<false>(walk);
    test_pairs<true>(walk);
    return true;
}

/// The slants of the sun over the tile. Where it is so low that float hardly tells its height, this
/// is set to a little, and its direction errs by that as well.
HWY_INLINE void set_slants(Walk& walk) {
    constexpr float kLeastHeight = 1e-6f, kMoreError = 4.0f;
    const Vec3f along_s = splat3(walk.tile.s_per_m), along_t = splat3(walk.tile.t_per_m);
    const Vec3f normal = splat3(walk.tile.normal);
    for (int first = 0; first < walk.steps; first += kLanes) {
        const Vec3f sun{hn::LoadU(Floats(), walk.sun[0] + first),
                        hn::LoadU(Floats(), walk.sun[1] + first),
                        hn::LoadU(Floats(), walk.sun[2] + first)};
        const Vf height = dot(normal, sun), least = splat(kLeastHeight);
        const Vf stretch = hn::Div(splat(1.0f), hn::Max(height, least));
        hn::Store(hn::Mul(dot(along_s, sun), stretch), Floats(), walk.slant_s + first);
        hn::Store(hn::Mul(dot(along_t, sun), stretch), Floats(), walk.slant_t + first);
        const Vf error = hn::IfThenElse(hn::Gt(height, least), splat(1.0f), splat(kMoreError));
        hn::Store(hn::Mul(stretch, error), Floats(), walk.stretch + first);
    }
}

bool walk_tree(Walk& walk) {
    walk.leaf_count = 0;
    for (Pairs* pairs : {&walk.pairs, &walk.mixed_pairs})
        pairs->records = 0;
    if (walk.tile.texels == 1) return walk_nodes<true>(walk);
    set_slants(walk);
    return walk_nodes<false>(walk);
}

}  // namespace gnomon::interval::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace gnomon::interval {

HWY_EXPORT(walk_tree);

bool walk_tree(Walk& walk) {
    return HWY_DYNAMIC_DISPATCH(walk_tree)(walk);
}

std::int64_t walk_targets() {
    return HWY_TARGETS;
}

}  // namespace gnomon::interval
#endif
