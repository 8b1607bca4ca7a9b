#pragma once

#include "interval/tile.h"
#include "interval/tree.h"
#include "trace/receiver.h"

#include <array>
#include <bit>
#include <chrono>
#include <cstdint>

namespace gnomon::interval {

inline constexpr int kMaxTexels = TileTracer::kMaxTexels;

/// Texels of one plane, in the tree's frame. The origin of a texel's rays is
/// center + s * u_axis + t * v_axis, s and t in [-1, 1], but for `residual_m`.
struct Tile {
    const trace::Receiver* receivers = nullptr;
    int texels = 0;
    float center_m[3];
    float u_axis_m[3], v_axis_m[3];
    float normal[3];
    alignas(64) float s[kMaxTexels], t[kMaxTexels];
    /// Gradients of s and t; their product, and the greater of their magnitudes.
    float s_per_m[3], t_per_m[3];
    float per_m2, per_m;
    float size_m;                  ///< sum of magnitudes of the axes
    float lower_m[3], upper_m[3];  ///< around the origins, with room for the tree's roundings
    float residual_m = 0.0f;
    /// Heights over the tile's plane, and distances from planes of triangles, that are smaller are
    /// for double to judge: what lifts the origins, what trace::touches_only() tolerates, and what
    /// float adds.
    float touch_m = 0.0f;
    // Heights of the receivers over the first one, and dot(|normal|, |position|) of them.
    double low_height_m = 0.0, high_height_m = 0.0;
    double low_magnitude_m = 0.0, high_magnitude_m = 0.0;
};

/// DayPath::Fit in the form in which boxes are compared with it. Slopes are squared with their
/// sign; roundings are allowed for.
struct RangeTerms {
    float low_slope2 = 0.0f, high_slope2 = 0.0f;
    float steps_per_rad = 0.0f;
    float first_at_zero = 0.0f, last_at_zero = 0.0f;
    float period_steps = 1.0f, periods_per_step = 1.0f;
    float last_step = 0.0f;
};

/// Some triangles of a leaf, and the steps at which its box can be seen.
struct LeafVisit {
    const Leaf* leaf;
    std::int32_t id;  ///< index into Tree::leaves(), or kHintLeaf
    int first_lane;
    int first_step, last_step;
};
inline constexpr std::int32_t kHintLeaf = -1;

/// What is linear in the direction of the sun, for one triangle at one step; and on which side of
/// the triangle's plane a texel is, where a tile has texels on both.
struct Term {
    enum : int {
        u,
        v,
        det,
        edge1_s,
        edge1_t,
        edge2_s,
        edge2_t,
        error,
        side,
        side_along_s,
        side_along_t,
        side_error,
        count
    };
};

/// Triangles at steps that may darken some texels of the tile: to be tested texel by texel. A
/// record holds those of a leaf at one step: a register of each term, and which lanes are to be
/// tested.
struct Pairs {
    static constexpr int kRecords = 64;
    /// Texels of the first half of a tile; the others are the second.
    static constexpr int kHalf = kMaxTexels / 2;
    /// So many wait before they are tested: more darken less beforehand, fewer cost more calls.
    static constexpr int kBatch = 8;

    int records = 0;
    bool are_split = false;  ///< some are to be tested on different texels than others
    alignas(64) float terms[kRecords][Term::count * kWidth];
    std::uint32_t lanes[kRecords], masked[kRecords];  ///< a bit for each; those with holes
    std::uint32_t half_lanes[kRecords][2];  ///< those to be tested on either half of the texels
    std::int32_t step[kRecords], leaf[kRecords], first_lane[kRecords];
};

/// A triangle that has darkened texels: the next tile tries it first.
struct Culprit {
    int gain;
    std::int32_t leaf;
    int lane;
};

/// What bounds the errors of a box's triangles for a single texel.
struct BoxBounds {
    float sides_m;  ///< sum of the box's sides
    float reach_m;  ///< no point's magnitudes relative to the texel add up to more
    bool is_above;  ///< the box surely is above the texel's plane, by more than touches
};

/// Everything that a walk through the tree reads and writes. Plain arrays: it is shared by code
/// for different instruction sets.
struct Walk {
    static constexpr int kMaxWords = DayPath::kMaxSteps / 64;
    /// Splitting ends at depth 64 + log2(triangles), and a node leaves 15 others behind.
    static constexpr int kStack = (64 + 32) * kWidth;
    /// Leaves that are tested together, so that the processor need not wait for each.
    static constexpr int kLeafBatch = 8;
    static constexpr int kMaxCulprits = 512;

    const Tree* tree = nullptr;
    const DayPath* path = nullptr;
    const float* sun[3] = {};
    /// Inverses of the coordinates of the sun's directions, of those near 0 large ones.
    alignas(64) float per_sun[3][DayPath::kMaxSteps];
    /// Of each step, the last one up to which none of these signs changes.
    std::int32_t same_signs_until[DayPath::kMaxSteps];
    int steps = 0, words = 0;
    /// The steps that face receivers of this normal.
    std::uint64_t facing[kMaxWords];
    Vec3 facing_normal_ws{0.0f};
    RangeTerms ranges;
    Tile tile;
    /// The sun's direction in a tile's coordinates, where it is made as high as 1: how far it
    /// slants, and how much it was stretched for it. walk_tree() sets them for tiles of several
    /// texels.
    static constexpr int kPaddedSteps = DayPath::kMaxSteps + kWidth;  ///< read by whole registers
    alignas(64) float slant_s[kPaddedSteps], slant_t[kPaddedSteps], stretch[kPaddedSteps];
    DVec3 origins[kMaxTexels];  ///< of the texels' rays, in the tree's frame

    /// Bit i of lit[k]: texel i is not yet known to be dark at step k. Bit k of open: some are not.
    alignas(64) std::uint64_t lit[DayPath::kMaxSteps];
    std::uint64_t open[kMaxWords + 1];  ///< the last word is 0, for windows

    /// Around groups of texels, bit i standing for the eight from 8i on: the least s and t, and the
    /// greatest, negated. walk_tree() sets it for tiles of several texels.
    alignas(64) float bounds[1 << kMaxTexels / 8][4];

    struct Entry {
        std::int32_t child, first_step, last_step;
        BoxBounds bounds;  ///< for single texels
    };
    Entry stack[kStack];
    LeafVisit leaves[kLeafBatch * kWidth];  ///< with registers of one lane, one for each triangle
    int leaf_count = 0;
    Pairs pairs;        ///< triangles that have all texels in front of them
    Pairs mixed_pairs;  ///< those whose plane cuts the tile

    /// Of the walk, which then ends unfinished; never if it is not to be looked at.
    bool has_deadline = false;
    double deadline_s = 0.0;  ///< of thread_seconds()
    /// Not late before this, by a clock that takes less to read.
    std::chrono::steady_clock::time_point earliest_late;

    Leaf hint_leaf = Leaf::empty();  ///< no triangles with holes
    LeafIds hint_ids;
    Culprit culprits[kMaxCulprits];
    int culprit_count = 0;

    const Leaf& leaf_of(std::int32_t leaf) const {
        return leaf == kHintLeaf ? hint_leaf : tree->leaves()[static_cast<std::size_t>(leaf)];
    }
    trace::SurfaceId surface(std::int32_t leaf, int lane) const {
        const LeafIds& ids =
            leaf == kHintLeaf ? hint_ids : tree->leaf_ids()[static_cast<std::size_t>(leaf)];
        return ids[static_cast<std::size_t>(lane)];
    }
    /// A bit for each triangle that has holes.
    std::uint32_t masked(std::int32_t leaf) const {
        return leaf == kHintLeaf ? 0 : tree->leaf_masked()[static_cast<std::size_t>(leaf)];
    }
    bool any_open(int first_step, int last_step) const {
        const int first = first_step / 64, last = last_step / 64;
        const std::uint64_t from = ~std::uint64_t{0} << (first_step % 64);
        const std::uint64_t to = ~std::uint64_t{0} >> (63 - last_step % 64);
        if (first == last) return (open[first] & from & to) != 0;
        std::uint64_t any = (open[first] & from) | (open[last] & to);
        for (int word = first + 1; word < last; ++word)
            any |= open[word];
        return any != 0;
    }
    /// Moves the ends of [first_step, last_step] to the nearest open steps in it; false if there
    /// are none.
    bool narrow(std::int32_t& first_step, std::int32_t& last_step) const {
        if (last_step - first_step < 64) {
            const std::uint64_t window = open_window(first_step, last_step);
            last_step = first_step + 63 - std::countl_zero(window);
            first_step += std::countr_zero(window);
            return window != 0;
        }
        int first = first_step / 64, last = last_step / 64;
        std::uint64_t low = open_steps(first, first_step, last_step);
        while (low == 0) {
            if (++first > last) return false;
            low = open_steps(first, first_step, last_step);
        }
        std::uint64_t high = open_steps(last, first_step, last_step);
        while (high == 0)
            high = open_steps(--last, first_step, last_step);
        first_step = 64 * first + std::countr_zero(low);
        last_step = 64 * last + 63 - std::countl_zero(high);
        return true;
    }
    /// The open steps of a word that are in [first_step, last_step].
    std::uint64_t open_steps(int word, int first_step, int last_step) const {
        std::uint64_t bits = open[word];
        if (word == first_step / 64) bits &= ~std::uint64_t{0} << (first_step % 64);
        if (word == last_step / 64) bits &= ~std::uint64_t{0} >> (63 - last_step % 64);
        return bits;
    }
    /// The open steps of [first_step, last_step], at most 64 steps: bit 0 is the first one.
    std::uint64_t open_window(int first_step, int last_step) const {
        const std::uint64_t* const at = open + first_step / 64;
        const int bit = first_step % 64;
        const std::uint64_t bits = at[0] >> bit | at[1] << 1 << (63 - bit);
        return bits & ~std::uint64_t{0} >> (63 - (last_step - first_step));
    }
    /// For a single texel; bit 0 is `first_step`.
    void darken_window(int first_step, std::uint64_t dark) {
        std::uint64_t* const at = open + first_step / 64;
        const int bit = first_step % 64;
        at[0] &= ~(dark << bit);
        at[1] &= ~(dark >> 1 >> (63 - bit));
    }
    /// Which groups of eight texels are lit somewhere: a bit for each.
    unsigned lit_groups(int step) const {
        constexpr std::uint64_t kLastBits = 0x0101010101010101, kGather = 0x0102040810204080;
        std::uint64_t any = lit[step];
        for (const int shift : {4, 2, 1})
            any |= any >> shift;
        return static_cast<unsigned>((any & kLastBits) * kGather >> 56);
    }
    void darken(int step, std::uint64_t texels) {
        lit[step] &= ~texels;
        open[step / 64] &= ~(std::uint64_t{lit[step] == 0} << (step % 64));
    }
    void credit(std::int32_t leaf, int lane, int gain) {
        if (culprit_count > 0) {
            Culprit& last = culprits[culprit_count - 1];
            if (last.leaf == leaf && last.lane == lane) {
                last.gain += gain;
                return;
            }
        }
        if (culprit_count < kMaxCulprits) culprits[culprit_count++] = {gain, leaf, lane};
    }
};

/// Darkens the texels of walk.tile, wherever a triangle of the tree is in the way. Starts from
/// walk.lit and walk.open; for the best instruction set of this machine. False when the deadline
/// came first: then what is dark is dark, and what is lit is not known.
bool walk_tree(Walk& walk);

bool is_late(Walk& walk);

/// The instruction sets that walk_tree() is compiled for, as bits HWY_AVX2 and so on.
std::int64_t walk_targets();

// What float leaves to double.

/// Those of `texels` at `step` for which the triangle is in the way. `is_in_front` of all of them,
/// if the sun is behind it, and has no holes.
std::uint64_t blocked_texels(const Walk& walk, std::uint64_t texels, int step, std::int32_t leaf,
                             int lane, bool is_in_front);

/// Whether a triangle that is nearly in the tile's plane is in nobody's way, because it is on or
/// below all receivers' planes.
enum class Height { below, above, varies };
Height height_over_tile(const Walk& walk, std::int32_t leaf, int lane);

}  // namespace gnomon::interval
