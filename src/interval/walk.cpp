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
#include "interval/single.inl.h"
#include "interval/walk.h"

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

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
    alignas(64) std::int32_t first[kWidth], last[kWidth];
    /// Distances, as numbers of which no two are the same; -1 = not seen.
    alignas(64) std::int32_t order[kWidth];
    std::uint32_t seen;
    /// BoxBounds of single texels, and a bit for those that are above.
    alignas(64) float sides_m[kWidth], reach_m[kWidth];
    std::uint32_t above;
};

/// Steps, from the first to the last, at which meeting each with boxes takes less time than finding
/// the azimuths of the boxes.
inline constexpr int kFewRays = 24;
static_assert(kFewRays <= 32, "a bit for each in a lane");

/// Roundings of the distance to a plane along a ray: inputs 2, inverse 1, product 1; of two of
/// them.
inline constexpr float kRayRoundings = 16.0f;

/// From a table a bit comes into all lanes by one instruction.
inline constexpr auto kBits = [] {
    std::array<std::uint32_t, 32> bits{};
    for (unsigned i = 0; i < bits.size(); ++i)
        bits[i] = 1u << i;
    return bits;
}();

/// The open steps of [first_step, last_step] whose rays meet boxes: bit 0 is the first one. The
/// sun's coordinates have the same signs at all of them, and tell whether rays enter boxes by their
/// lower or by their upper sides. (T. Kay, J. Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986.)
HWY_INLINE Vi steps_meeting(const Walk& walk, const Boxes& box, int first_step,
                            std::uint64_t open) {
    const float* const x = walk.per_sun[0] + first_step;
    const float* const y = walk.per_sun[1] + first_step;
    const float* const z = walk.per_sun[2] + first_step;
    const bool down_x = *x < 0.0f, down_y = *y < 0.0f, down_z = *z < 0.0f;
    const Vec3f in{down_x ? box.upper.x : box.lower.x, down_y ? box.upper.y : box.lower.y,
                   down_z ? box.upper.z : box.lower.z};
    const Vec3f out{down_x ? box.lower.x : box.upper.x, down_y ? box.lower.y : box.upper.y,
                    down_z ? box.lower.z : box.upper.z};
    const Vf more = splat(1.0f + kRayRoundings * kUnitRoundoff), zero = splat(0.0f);
    Vf met = zero;
    for (std::uint64_t rest = open; rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        const Vec3f per_sun{splat(x[i]), splat(y[i]), splat(z[i])};
        const Vf enters = hn::Max(hn::Max(hn::Mul(in.x, per_sun.x), hn::Mul(in.y, per_sun.y)),
                                  hn::Max(hn::Mul(in.z, per_sun.z), zero));
        const Vf leaves = hn::Min(hn::Min(hn::Mul(out.x, per_sun.x), hn::Mul(out.y, per_sun.y)),
                                  hn::Mul(out.z, per_sun.z));
        const Vf bit = splat(std::bit_cast<float>(kBits[static_cast<unsigned>(i)]));
        met = hn::Or(met, hn::IfThenElseZero(hn::Le(enters, hn::Mul(leaves, more)), bit));
    }
    return hn::BitCast(Ints(), met);
}

/// BoxBounds of children.
HWY_INLINE void find_bounds(const Tile& tile, const Boxes& box, int lane0, Children& children) {
    const auto farthest = [](Vf low, Vf high) HWY_ATTR { return hn::Max(hn::Neg(low), high); };
    const Vf reach =
        hn::Add(farthest(box.lower.x, box.upper.x),
                hn::Add(farthest(box.lower.y, box.upper.y), farthest(box.lower.z, box.upper.z)));
    const Vec3f lengths = box.upper - box.lower;
    const Vf sides = hn::Add(lengths.x, hn::Add(lengths.y, lengths.z));
    const auto lowest = [&](Vf low, Vf high, int axis) HWY_ATTR {
        return hn::Mul(splat(tile.normal[axis]), tile.normal[axis] > 0.0f ? low : high);
    };
    const Vf height =
        hn::Add(lowest(box.lower.x, box.upper.x, 0),
                hn::Add(lowest(box.lower.y, box.upper.y, 1), lowest(box.lower.z, box.upper.z, 2)));
    const Vf error = hn::MulAdd(reach, splat(kTermRoundings * kUnitRoundoff), splat(tile.touch_m));
    hn::Store(sides, Floats(), children.sides_m + lane0);
    hn::Store(reach, Floats(), children.reach_m + lane0);
    children.above |= bits_of(hn::Gt(height, error)) << lane0;
}

/// Which children are seen, and in which order; of those that are, `steps_seen` see a step.
HWY_INLINE void set_seen(const Tile& tile, const Node& node, const Boxes& box, Lanes steps_seen,
                         int lane0, Children& children) {
    const Vi child = hn::Load(Ints(), node.child + lane0);
    const Lanes present = hn::RebindMask(Floats(), hn::Ne(child, hn::Set(Ints(), Node::kNoChild)));
    const Lanes seen = hn::And(hn::And(present, steps_seen), above_tile(tile, box));
    // Floats that are not negative are in the order of their bits; the last ones tell lanes.
    const Vi distances =
        hn::AndNot(hn::Set(Ints(), kWidth - 1), hn::BitCast(Ints(), distance2(box)));
    const Vi order = hn::Or(distances, hn::Iota(Ints(), lane0));
    const Vi none = hn::Set(Ints(), -1);
    hn::Store(hn::IfThenElse(hn::RebindMask(Ints(), seen), order, none), Ints(),
              children.order + lane0);
    children.seen |= bits_of(seen) << lane0;
}

HWY_INLINE Boxes boxes_of(const Tile& tile, const Node& node, int lane0) {
    return {load3(node.lower, lane0) - splat3(tile.upper_m),
            load3(node.upper, lane0) - splat3(tile.lower_m)};
}

template <bool kSingle>
HWY_INLINE void find_children(const Walk& walk, const Node& node, const Walk::Entry& entry,
                              Children& children) {
    const Tile& tile = walk.tile;
    children.seen = 0;
    children.above = 0;
    for (int lane0 = 0; lane0 < kWidth; lane0 += kLanes) {
        const Boxes box = boxes_of(tile, node, lane0);
        const Steps steps = cut(steps_towards(walk.ranges, box), entry.first_step, entry.last_step);
        set_seen(tile, node, box, steps.any, lane0, children);
        if constexpr (kSingle) find_bounds(tile, box, lane0, children);
        hn::Store(hn::ConvertTo(Ints(), steps.first), Ints(), children.first + lane0);
        hn::Store(hn::ConvertTo(Ints(), steps.last), Ints(), children.last + lane0);
    }
}

/// The same by rays, at few steps.
HWY_INLINE void find_children_by_rays(const Walk& walk, const Node& node, const Walk::Entry& entry,
                                      Children& children) {
    const Tile& tile = walk.tile;
    children.seen = 0;
    children.above = 0;
    const std::uint64_t open = walk.open_window(entry.first_step, entry.last_step);
    alignas(64) std::uint32_t met[kWidth];
    for (int lane0 = 0; lane0 < kWidth; lane0 += kLanes) {
        const Boxes box = boxes_of(tile, node, lane0);
        const Vi steps = steps_meeting(walk, box, entry.first_step, open);
        const Lanes any = hn::RebindMask(Floats(), hn::Ne(steps, hn::Zero(Ints())));
        set_seen(tile, node, box, any, lane0, children);
        find_bounds(tile, box, lane0, children);
        hn::Store(hn::BitCast(hn::RebindToUnsigned<Floats>(), steps),
                  hn::RebindToUnsigned<Floats>(), met + lane0);
    }
    for (std::uint32_t rest = children.seen; rest != 0; rest &= rest - 1) {
        const int lane = std::countr_zero(rest);
        children.first[lane] = entry.first_step + std::countr_zero(met[lane]);
        children.last[lane] = entry.first_step + 31 - std::countl_zero(met[lane]);
    }
}

/// Puts the children on the stack, the nearest on top. Counting those that are farther than each
/// takes no branch that depends on them.
template <bool kSingle>
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
        Walk::Entry& entry = top[farther];
        entry.child = child;
        entry.first_step = children.first[lane];
        entry.last_step = children.last[lane];
        if constexpr (kSingle) {
            entry.bounds = {children.sides_m[lane], children.reach_m[lane],
                            (children.above >> lane & 1) != 0};
        }
        if (kSingle && child < 0) prefetch(leaves[static_cast<std::size_t>(~child)]);
    }
}

/// What is fetched here has come when the leaves are looked at, a batch later; until then nothing
/// of it is read, if all its triangles fit a register.
HWY_INLINE void visit_leaf(Walk& walk, const Leaf& leaf, std::int32_t id, int first_step,
                           int last_step) {
    prefetch(leaf);
    walk.leaves[walk.leaf_count++] = {&leaf, id, 0, first_step, last_step};
    for (int lane0 = kLanes; lane0 < kWidth && !std::isnan(leaf.corner[0][lane0]); lane0 += kLanes)
        walk.leaves[walk.leaf_count++] = {&leaf, id, lane0, first_step, last_step};
}

/// Steps, from the first to the last, at which a single texel tests all of a leaf's triangles at
/// each in less time than it takes to find the steps of each triangle.
inline constexpr int kFewLeafSteps = 24;
static_assert(kFewLeafSteps <= 64, "a window of open steps");

HWY_INLINE void visit_single(Walk& walk, const Leaf& leaf, const Walk::Entry& entry) {
    if (entry.bounds.is_above && entry.last_step - entry.first_step < kFewLeafSteps) {
        cast_few(walk, leaf, entry);
    } else {
        visit_leaf(walk, leaf, ~entry.child, entry.first_step, entry.last_step);
    }
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
    walk.stack[entries++] = {0, 0, walk.steps - 1, {}};
    while (entries > 0) {
        Walk::Entry entry = walk.stack[--entries];
        // What is dark to all texels of a tile is too little to make up for looking closely.
        const bool is_open = kSingle ? walk.narrow(entry.first_step, entry.last_step)
                                     : walk.any_open(entry.first_step, entry.last_step);
        if (!is_open) continue;
        if (entry.child < 0) {
            const auto id = ~entry.child;
            const Leaf& leaf = leaves[static_cast<std::size_t>(id)];
            if constexpr (kSingle) {
                visit_single(walk, leaf, entry);
            } else {
                visit_leaf(walk, leaf, id, entry.first_step, entry.last_step);
            }
            if (walk.leaf_count <= (Walk::kLeafBatch - 1) * kVisits) continue;
            cast_leaves<kSingle>(walk);
            // Nodes alone take little time.
            if (walk.has_deadline && is_late(walk)) return false;
            continue;
        }
        const Node& node = nodes[static_cast<std::size_t>(entry.child)];
        Children children;
        if (kSingle && entry.last_step - entry.first_step < kFewRays &&
            walk.same_signs_until[entry.first_step] >= entry.last_step) {
            find_children_by_rays(walk, node, entry, children);
        } else {
            find_children<kSingle>(walk, node, entry, children);
        }
        push_children<kSingle>(walk, node, children, walk.stack + entries);
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

struct Ends {
    float least, greatest;
};

/// Of eight floats.
HWY_INLINE Ends ends_of(const float* values) {
    const hn::CappedTag<float, 8> floats;
    auto least = hn::Load(floats, values), greatest = least;
    for (std::size_t i = hn::Lanes(floats); i < 8; i += hn::Lanes(floats)) {
        least = hn::Min(least, hn::Load(floats, values + i));
        greatest = hn::Max(greatest, hn::Load(floats, values + i));
    }
    return {hn::GetLane(hn::MinOfLanes(floats, least)),
            hn::GetLane(hn::MaxOfLanes(floats, greatest))};
}

/// Of each group, and from those of fewer groups of more.
HWY_NOINLINE void set_bounds(Walk& walk) {
    constexpr int kGroups = kMaxTexels / 8;
    std::fill_n(walk.bounds[0], 4, std::numeric_limits<float>::max());
    for (int group = 0; group < kGroups; ++group) {
        const Ends s = ends_of(walk.tile.s + 8 * group), t = ends_of(walk.tile.t + 8 * group);
        const float own[4] = {s.least, t.least, -s.greatest, -t.greatest};
        const int others = 4 << group;
        const float* const from = walk.bounds[0];
        float* const to = walk.bounds[1 << group];
        for (int i = 0; i < others; i += 4) {
            for (int j = 0; j < 4; ++j)
                to[i + j] = std::min(from[i + j], own[j]);
        }
    }
}

bool walk_tree(Walk& walk) {
    walk.leaf_count = 0;
    for (Pairs* pairs : {&walk.pairs, &walk.mixed_pairs})
        pairs->records = 0;
    if (walk.tile.texels == 1) return walk_nodes<true>(walk);
    set_slants(walk);
    set_bounds(walk);
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
