#include "interval/tile.h"

#include "base/thread_time.h"
#include "interval/exact.h"
#include "interval/magnitudes.h"
#include "interval/mask.h"
#include "interval/place_tile.h"
#include "interval/walk.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

namespace gnomon::interval {

namespace {

using Clock = std::chrono::steady_clock;
using trace::kUnitRoundoff;
using trace::Receiver;

/// atan2 of ranges.inl.h, with the roundings of its argument.
constexpr double kAtanError_rad = 4e-6;
/// Roundings of a step's number, relative to the greatest number in its computation.
constexpr double kStepRoundings = 16.0;
/// Slopes of boxes are computed to about 8 roundings, and compared as squares.
constexpr double kSlopeError = 1e-5;
/// A slope whose square float holds, steeper than any that a box can have.
constexpr double kSteepest = 1e18;

RangeTerms range_terms(const DayPath& path) {
    const DayPath::Fit& fit = path.fit();
    // Of slopes off by their error; that of a pole is infinite.
    const auto signed_square = [](double slope, double errors) {
        const double steep = std::clamp(slope, -kSteepest, kSteepest);
        const double off = steep + errors * kSlopeError * (1.0 + std::abs(steep));
        const double clamped = std::clamp(off, -kSteepest, kSteepest);
        return static_cast<float>(clamped * std::abs(clamped));
    };
    RangeTerms terms;
    terms.low_slope2 = signed_square(fit.low_slope, -1.0);
    terms.high_slope2 = signed_square(fit.high_slope, 1.0);
    const double rate = std::abs(fit.steps_per_rad);
    // At least what all steps take, also where the sun does not move.
    const double period = std::max(2.0 * std::numbers::pi * rate, 1.0);
    const double slack =
        fit.slack_steps + kAtanError_rad * rate +
        kStepRoundings * kUnitRoundoff * (period + std::abs(fit.step_at_zero) + path.steps());
    terms.steps_per_rad = static_cast<float>(fit.steps_per_rad);
    terms.first_at_zero = static_cast<float>(fit.step_at_zero - slack);
    terms.last_at_zero = static_cast<float>(fit.step_at_zero + slack);
    terms.period_steps = static_cast<float>(period);
    terms.periods_per_step = 1.0f / terms.period_steps;
    terms.last_step = static_cast<float>(path.steps() - 1);
    return terms;
}

/// Of the sun's directions. Boxes are wider than what they hold by some roundings of the reach of
/// all, and no ray passes one farther away than a few reaches: so coordinates that are this small
/// may as well be a little greater.
void set_inverses(Walk& walk) {
    constexpr float kLeast = 1e-9f;
    for (int axis = 0; axis < 3; ++axis) {
        for (int step = 0; step < walk.steps; ++step) {
            const float along = walk.sun[axis][step];
            walk.per_sun[axis][step] =
                1.0f / std::copysign(std::max(std::abs(along), kLeast), along);
        }
    }
    walk.same_signs_until[walk.steps - 1] = walk.steps - 1;
    for (int step = walk.steps - 1; step-- > 0;) {
        const bool is_same = std::ranges::all_of(walk.per_sun, [&](const float* inverses) {
            return std::signbit(inverses[step]) == std::signbit(inverses[step + 1]);
        });
        walk.same_signs_until[step] = is_same ? walk.same_signs_until[step + 1] : step;
    }
}

/// All texels at the steps at which the receivers face the sun.
void open_steps(Walk& walk) {
    const Vec3 normal_ws = walk.tile.receivers[0].normal_ws;
    if (normal_ws != walk.facing_normal_ws) {
        walk.facing_normal_ws = normal_ws;
        std::ranges::fill(walk.facing, 0);
        for (int step = 0; step < walk.steps; ++step) {
            const DVec3 to_sun = walk.path->to_sun_ws()[static_cast<std::size_t>(step)];
            const bool faces = glm::dot(DVec3(normal_ws), to_sun) > 0.0;
            walk.facing[step / 64] |= std::uint64_t{faces} << (step % 64);
        }
    }
    std::ranges::copy(walk.facing, walk.open);
    walk.open[Walk::kMaxWords] = 0;
    // Also at steps that are not open, where nobody looks.
    std::fill_n(walk.lit, walk.steps, ~std::uint64_t{0} >> (kMaxTexels - walk.tile.texels));
}

/// Fills the hint leaf with the triangles that darkened most.
void gather_hints(Walk& walk) {
    const std::span<Culprit> culprits(walk.culprits, static_cast<std::size_t>(walk.culprit_count));
    const std::size_t count = std::min<std::size_t>(kWidth, culprits.size());
    std::ranges::partial_sort(culprits, culprits.begin() + static_cast<std::ptrdiff_t>(count),
                              std::ranges::greater(), &Culprit::gain);
    Leaf leaf = Leaf::empty();
    LeafIds ids;
    for (std::size_t i = 0; i < count; ++i) {
        const Culprit& culprit = culprits[i];
        const Leaf& from = walk.leaf_of(culprit.leaf);
        const auto lane = static_cast<std::size_t>(culprit.lane);
        for (int axis = 0; axis < 3; ++axis) {
            leaf.corner[axis][i] = from.corner[axis][lane];
            leaf.edge1[axis][i] = from.edge1[axis][lane];
            leaf.edge2[axis][i] = from.edge2[axis][lane];
        }
        ids[i] = walk.surface(culprit.leaf, culprit.lane);
    }
    walk.hint_leaf = leaf;
    walk.hint_ids = ids;
    walk.culprit_count = 0;
}

enum class Meeting { none, inside, near_an_edge };

/// A triangle as the leaf has it, rounded: but for its edges it tells in double what the scene's
/// tells, which is seldom in a cache.
class LeafTriangle {
public:
    LeafTriangle(const Tree& tree, const Leaf& leaf, int lane) {
        for (int axis = 0; axis < 3; ++axis) {
            corner_[axis] = double{leaf.corner[axis][lane]};
            edge1_[axis] = double{leaf.edge1[axis][lane]};
            edge2_[axis] = double{leaf.edge2[axis][lane]};
        }
        corner_error_m_ =
            kUnitRoundoff * sum_of_magnitudes(corner_) +
            kDoubleRoundings * std::numeric_limits<double>::epsilon() * tree.magnitude_m();
    }

    /// Of the triangle with a ray; what is inside is in front of it, if it surely is either in
    /// front or behind.
    Meeting meeting(DVec3 origin, DVec3 sun) const {
        const DVec3 offset = corner_ - origin;
        const double u = glm::dot(sun, glm::cross(offset, edge2_));
        const double v = glm::dot(sun, glm::cross(edge1_, offset));
        const DVec3 normal = glm::cross(edge1_, edge2_);
        const double determinant = -glm::dot(sun, normal), w = determinant - u - v;
        const double size1 = sum_of_magnitudes(edge1_), size2 = sum_of_magnitudes(edge2_);
        const double place_m = corner_error_m_ + kUnitRoundoff * sum_of_magnitudes(offset);
        const double error =
            kRoundUp * ((size1 + size2) * place_m + 2.0 * kUnitRoundoff * size1 * size2);
        const double least = std::min({u, v, w}), greatest = std::max({u, v, w});
        if (least < -error && greatest > error) return Meeting::none;
        const bool is_sure = least > error || greatest < -error;
        const bool is_in_front = determinant * glm::dot(offset, normal) < 0.0;
        return is_sure && is_in_front ? Meeting::inside : Meeting::near_an_edge;
    }

private:
    static constexpr double kDoubleRoundings = 64.0;
    /// Makes sure that a bound is not rounded down below what it bounds.
    static constexpr double kRoundUp = 1.0 + 1e-5;

    DVec3 corner_, edge1_, edge2_;
    double corner_error_m_;
};

Clock::time_point time_after(double s) {
    return Clock::now() +
           std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

/// In so many seconds of the thread; 0 = none. They last at least as long by the wall.
void set_deadline(Walk& walk, double most_s) {
    walk.has_deadline = most_s > 0.0;
    if (!walk.has_deadline) return;
    walk.deadline_s = thread_seconds() + most_s;
    walk.earliest_late = time_after(most_s);
}

/// How many of the first look the same way; a hole in the chart ends the tile.
std::size_t alike(std::span<const Receiver> receivers) {
    std::size_t count = 1;
    while (count < receivers.size() && receivers[count].exists() == receivers[0].exists() &&
           receivers[count].normal_ws == receivers[0].normal_ws)
        ++count;
    return count;
}

/// Texels at a step to steps at a texel.
void write_masks(Walk& walk, std::span<std::uint64_t> masks) {
    const auto words = static_cast<std::size_t>(walk.words);
    if (walk.tile.texels == 1) {
        std::copy_n(walk.open, words, masks.begin());
        return;
    }
    std::fill(walk.lit + walk.steps, walk.lit + 64 * words, 0);
    for (std::size_t word = 0; word < words; ++word) {
        const std::span<std::uint64_t, 64> block(walk.lit + 64 * word, 64);
        const std::uint64_t facing = walk.facing[word];
        if (walk.open[word] != 0) transpose(block);
        for (std::size_t texel = 0; texel < static_cast<std::size_t>(walk.tile.texels); ++texel)
            masks[texel * words + word] = walk.open[word] != 0 ? block[texel] & facing : 0;
    }
}

}  // namespace

bool is_late(Walk& walk) {
    if (Clock::now() <= walk.earliest_late) return false;
    const double left_s = walk.deadline_s - thread_seconds();
    walk.earliest_late = time_after(left_s);
    return left_s < 0.0;
}

std::uint64_t blocked_texels(const Walk& walk, std::uint64_t texels, int step, std::int32_t leaf,
                             int lane, bool is_in_front) {
    const trace::SurfaceId id = walk.surface(leaf, lane);
    const DVec3 to_sun = walk.path->to_sun_ws()[static_cast<std::size_t>(step)];
    const DVec3 sun = walk.path->frame().from_world(to_sun);
    const LeafTriangle rounded(*walk.tree, walk.leaf_of(leaf), lane);
    std::uint64_t blocked = 0;
    for (; texels != 0; texels &= texels - 1) {
        const int texel = std::countr_zero(texels);
        const Meeting meeting = rounded.meeting(walk.origins[texel], sun);
        if (meeting == Meeting::none) continue;
        if ((meeting == Meeting::inside && is_in_front) ||
            blocks(walk.tree->scene(), walk.tree->ignores_alpha(), id, walk.tile.receivers[texel],
                   to_sun)) {
            blocked |= std::uint64_t{1} << texel;
        }
    }
    return blocked;
}

Height height_over_tile(const Walk& walk, std::int32_t leaf, int lane) {
    const trace::SurfaceId id = walk.surface(leaf, lane);
    const trace::Triangle triangle = trace::world_triangle(walk.tree->scene(), id);
    const Tile& tile = walk.tile;
    const DVec3 normal(tile.receivers[0].normal_ws);
    const DVec3 first(tile.receivers[0].position_ws);
    double top_m = -std::numeric_limits<double>::infinity();
    for (const DVec3& corner : triangle.corners_ws)
        top_m = std::max(top_m, glm::dot(normal, corner - first));
    const double of_triangle = trace::height_error(normal, triangle.magnitude);
    const double per_m = trace::kHeightRoundings * kUnitRoundoff;
    // Double's own roundings, relative to what is subtracted.
    const double error_m = 16.0 * std::numeric_limits<double>::epsilon() *
                           (walk.tree->magnitude_m() + sum_of_magnitudes(first));
    if (top_m - tile.low_height_m <= of_triangle + per_m * tile.low_magnitude_m - error_m) {
        return Height::below;
    }
    if (top_m - tile.high_height_m > of_triangle + per_m * tile.high_magnitude_m + error_m) {
        return Height::above;
    }
    return Height::varies;
}

TileTracer::TileTracer(const Tree& tree, const DayPath& path) : walk_(std::make_unique<Walk>()) {
    walk_->tree = &tree;
    walk_->path = &path;
    for (int axis = 0; axis < 3; ++axis)
        walk_->sun[axis] = path.coordinates(axis);
    walk_->steps = path.steps();
    set_inverses(*walk_);
    walk_->words = path.words();
    walk_->ranges = range_terms(path);
}

TileTracer::~TileTracer() = default;
TileTracer::TileTracer(TileTracer&&) noexcept = default;
TileTracer& TileTracer::operator=(TileTracer&&) noexcept = default;

void TileTracer::trace(std::span<const Receiver> receivers, int texels_per_tile,
                       std::span<std::uint64_t> masks) {
    assert(texels_per_tile >= 1 && texels_per_tile <= kMaxTexels);
    const auto words = static_cast<std::size_t>(walk_->words);
    assert(masks.size() == receivers.size() * words);
    for (std::size_t first = 0; first < receivers.size();) {
        const std::size_t count = std::min<std::size_t>(receivers.size() - first, texels_per_tile);
        const std::size_t same = alike(receivers.subspan(first, count));
        trace_within(receivers.subspan(first, same), masks.subspan(first * words, same * words),
                     0.0);
        first += same;
    }
}

bool TileTracer::trace_within(std::span<const Receiver> receivers, std::span<std::uint64_t> masks,
                              double most_s) {
    assert(receivers.size() <= kMaxTexels);
    const auto words = static_cast<std::size_t>(walk_->words);
    set_deadline(*walk_, most_s);
    while (!receivers.empty()) {
        const std::size_t same = alike(receivers);
        if (!trace_tile(receivers.first(same), masks.first(same * words))) return false;
        receivers = receivers.subspan(same);
        masks = masks.subspan(same * words);
    }
    return true;
}

/// False when it is late.
bool TileTracer::trace_tile(std::span<const Receiver> receivers, std::span<std::uint64_t> masks) {
    Walk& walk = *walk_;
    const auto words = static_cast<std::size_t>(walk.words);
    if (!receivers[0].exists()) {
        const std::uint64_t last = ~std::uint64_t{0} >> (64 * walk.words - walk.steps);
        for (std::size_t i = 0; i < masks.size(); ++i)
            masks[i] = i % words + 1 == words ? last : ~std::uint64_t{0};
        return true;
    }
    const std::span<DVec3> origins(walk.origins, receivers.size());
    if (!set_tile(walk.tile, origins, *walk.tree, receivers)) {
        const std::size_t half = receivers.size() / 2;
        return trace_tile(receivers.first(half), masks.first(half * words)) &&
               trace_tile(receivers.subspan(half), masks.subspan(half * words));
    }
    open_steps(walk);
    if (!walk.tree->nodes().empty() && walk.any_open(0, walk.steps - 1)) {
        const bool in_time = walk_tree(walk);
        gather_hints(walk);
        if (!in_time) return false;
    }
    write_masks(walk, masks);
    return true;
}

}  // namespace gnomon::interval
