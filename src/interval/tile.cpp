#include "interval/tile.h"

#include "base/thread_time.h"
#include "interval/exact.h"
#include "interval/mask.h"
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

/// Tiles are plane to this part of their size, or they are taken apart: what is not plane is taken
/// for an error of float, and left to double.
constexpr double kPlane = 1e-4;

/// The axes are a little longer than the tile, so that no s or t is rounded to more than 1.
constexpr double kLonger = 1.0 + 1e-5;

/// The normal is a unit vector and at right angles to the axes to kPlane.
constexpr double kFrameError = 1.0 + 10.0 * kPlane;

/// atan2 of ranges.inl.h, with the roundings of its argument.
constexpr double kAtanError_rad = 4e-6;
/// Roundings of a step's number, relative to the greatest number in its computation.
constexpr double kStepRoundings = 16.0;
/// Slopes of boxes are computed to about 8 roundings, and compared as squares.
constexpr double kSlopeError = 1e-5;
/// A slope whose square float holds, steeper than any that a box can have.
constexpr double kSteepest = 1e18;

double sum_of_magnitudes(DVec3 v) {
    return glm::dot(glm::abs(v), DVec3(1.0));
}

void store(float (&to)[3], DVec3 v) {
    for (int axis = 0; axis < 3; ++axis)
        to[axis] = static_cast<float>(v[axis]);
}

DVec3 loaded(const float (&from)[3]) {
    return {from[0], from[1], from[2]};
}

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

/// Around the receivers: its centre, and half of its sides.
struct Rectangle {
    DVec3 center, half_u, half_v;
};

/// With a side along `u`, a unit vector in the plane of the receivers. No side is much shorter than
/// the other: lines of receivers have coordinates, too.
Rectangle rectangle_along(std::span<const DVec3> origins, DVec3 normal, DVec3 u) {
    constexpr double kLeastSide = 1.0 / 16.0;
    const DVec3 v = glm::cross(normal, u);
    double low_u = 0.0, high_u = 0.0, low_v = 0.0, high_v = 0.0;
    for (const DVec3& origin : origins) {
        const double along_u = glm::dot(origin - origins[0], u);
        const double along_v = glm::dot(origin - origins[0], v);
        low_u = std::min(low_u, along_u);
        high_u = std::max(high_u, along_u);
        low_v = std::min(low_v, along_v);
        high_v = std::max(high_v, along_v);
    }
    const double length_u = high_u - low_u, length_v = high_v - low_v;
    return {origins[0] + 0.5 * (low_u + high_u) * u + 0.5 * (low_v + high_v) * v,
            0.5 * kLonger * std::max(length_u, kLeastSide * length_v) * u,
            0.5 * kLonger * std::max(length_v, kLeastSide * length_u) * v};
}

/// Along the way from the first receiver to the next, which fits rows of texels; or, where most of
/// that is empty, along that to the farthest, a diagonal of a square of texels, which fits lines,
/// if it is smaller. Receivers at one place have a little one.
Rectangle rectangle_around(std::span<const DVec3> origins, DVec3 normal) {
    constexpr double kLeastHalf_m = 1e-3, kMostlyEmpty = 2.0;
    const auto far_from_first = [&](DVec3 p) { return glm::dot(p - origins[0], p - origins[0]); };
    const auto towards = [&](DVec3 p) {
        return rectangle_along(origins, normal, glm::normalize(p - origins[0]));
    };
    const auto area = [](const Rectangle& r) {
        return 4.0 * glm::length(r.half_u) * glm::length(r.half_v);
    };
    const double spacing2 = far_from_first(origins[1]);
    Rectangle row{};
    if (spacing2 > 0.0) {
        row = towards(origins[1]);
        const double full = static_cast<double>(origins.size()) * spacing2;
        if (area(row) < kMostlyEmpty * full) return row;
    }
    const DVec3 farthest = *std::ranges::max_element(origins, {}, far_from_first);
    if (!(far_from_first(farthest) > 0.0)) {
        const DVec3 any =
            std::abs(normal.x) < std::abs(normal.y) ? DVec3(1.0, 0.0, 0.0) : DVec3(0.0, 1.0, 0.0);
        const DVec3 u = glm::normalize(glm::cross(normal, any));
        return {origins[0], kLeastHalf_m * u, kLeastHalf_m * glm::cross(normal, u)};
    }
    const Rectangle diagonal = towards(farthest);
    return spacing2 > 0.0 && area(row) < area(diagonal) ? row : diagonal;
}

/// Along `axis` from 0 to 1; nowhere without one.
DVec3 gradient_along(DVec3 axis) {
    const double length2 = glm::dot(axis, axis);
    return length2 > 0.0 ? axis / length2 : DVec3(0.0);
}

/// Sets what Tile::touch_m promises, and what height_over_tile() needs. No origin is farther than
/// `height_m` from the plane through the tile's centre.
void set_heights(Tile& tile, const Tree& tree, std::span<const Receiver> receivers,
                 double height_m) {
    const DVec3 normal(receivers[0].normal_ws);
    double lift_m = 0.0, magnitude_m = 0.0;
    tile.low_height_m = tile.low_magnitude_m = std::numeric_limits<double>::infinity();
    tile.high_height_m = tile.high_magnitude_m = -tile.low_height_m;
    for (const Receiver& receiver : receivers) {
        const DVec3 position(receiver.position_ws);
        const double height = glm::dot(normal, position - DVec3(receivers[0].position_ws));
        tile.low_height_m = std::min(tile.low_height_m, height);
        tile.high_height_m = std::max(tile.high_height_m, height);
        const double along_normal = glm::dot(glm::abs(normal), glm::abs(position));
        tile.low_magnitude_m = std::min(tile.low_magnitude_m, along_normal);
        tile.high_magnitude_m = std::max(tile.high_magnitude_m, along_normal);
        const DVec3 lift = DVec3(trace::lifted_position_ws(receiver)) - position;
        lift_m = std::max(lift_m, sum_of_magnitudes(lift));
        magnitude_m = std::max(magnitude_m, sum_of_magnitudes(position));
    }
    const double tolerated_m =
        trace::kHeightRoundings * kUnitRoundoff * (tree.magnitude_m() + magnitude_m);
    tile.touch_m = static_cast<float>(
        kLonger * (tolerated_m + lift_m + tile.residual_m + height_m +
                   2.0 * kUnitRoundoff * sum_of_magnitudes(loaded(tile.center_m))));
}

/// The axes of the tile; a single receiver has none.
void set_frame(Tile& tile, std::span<const DVec3> origins, DVec3 normal) {
    Rectangle around{origins[0], DVec3(0.0), DVec3(0.0)};
    if (origins.size() > 1) {
        around = rectangle_around(origins, normal);
        // The centre is stored as floats: no receiver is to have a coordinate beyond 1 for that.
        const double rounding_m = 2.0 * kUnitRoundoff * sum_of_magnitudes(around.center);
        around.half_u += rounding_m * glm::normalize(around.half_u);
        around.half_v += rounding_m * glm::normalize(around.half_v);
    }
    store(tile.center_m, around.center);
    store(tile.u_axis_m, around.half_u);
    store(tile.v_axis_m, around.half_v);
    store(tile.normal, normal);
    const DVec3 along_s = gradient_along(around.half_u), along_t = gradient_along(around.half_v);
    store(tile.s_per_m, along_s);
    store(tile.t_per_m, along_t);
    const double s_per_m = glm::length(along_s), t_per_m = glm::length(along_t);
    tile.per_m = static_cast<float>(kFrameError * std::max(s_per_m, t_per_m));
    tile.per_m2 = static_cast<float>(kFrameError * s_per_m * t_per_m);
    tile.size_m = static_cast<float>(
        kLonger * (sum_of_magnitudes(around.half_u) + sum_of_magnitudes(around.half_v)));
}

/// Sets the origins of their rays as well. False when the receivers are not in one plane.
bool set_tile(Tile& tile, std::span<DVec3> origins, const Tree& tree,
              std::span<const Receiver> receivers) {
    std::ranges::transform(receivers, origins.begin(), [&](const Receiver& receiver) {
        return tree.from_world(DVec3(trace::lifted_position_ws(receiver)));
    });
    const DVec3 normal = tree.frame().from_world(DVec3(receivers[0].normal_ws));
    set_frame(tile, origins, normal);
    const DVec3 u = loaded(tile.u_axis_m), v = loaded(tile.v_axis_m);
    const DVec3 along_s = loaded(tile.s_per_m), along_t = loaded(tile.t_per_m);
    std::ranges::fill(tile.s, 0.0f);
    std::ranges::fill(tile.t, 0.0f);
    DVec3 lower(std::numeric_limits<double>::infinity()), upper = -lower;
    double residual_m = 0.0, height_m = 0.0;
    for (std::size_t i = 0; i < origins.size(); ++i) {
        const DVec3 offset = origins[i] - loaded(tile.center_m);
        tile.s[i] = static_cast<float>(glm::dot(offset, along_s));
        tile.t[i] = static_cast<float>(glm::dot(offset, along_t));
        const DVec3 rest = offset - double{tile.s[i]} * u - double{tile.t[i]} * v;
        residual_m = std::max(residual_m, sum_of_magnitudes(rest));
        height_m = std::max(height_m, std::abs(glm::dot(normal, offset)));
        lower = glm::min(lower, origins[i]);
        upper = glm::max(upper, origins[i]);
    }
    const double reach_m =
        std::max(double{tree.reach_m()}, glm::length(glm::max(glm::abs(lower), glm::abs(upper))));
    const double rounding_m = 4.0 * kUnitRoundoff * reach_m;
    // Two receivers always lie on a line, but perhaps on a steep one.
    const double plane_m = kPlane * (glm::length(u) + glm::length(v)) + rounding_m;
    if (std::max(residual_m, height_m) > plane_m) return false;
    tile.receivers = receivers.data();
    tile.texels = static_cast<int>(receivers.size());
    tile.residual_m = static_cast<float>(kLonger * std::max(residual_m, height_m));
    store(tile.lower_m, lower - 2.0 * rounding_m);
    store(tile.upper_m, upper + 2.0 * rounding_m);
    set_heights(tile, tree, receivers, height_m);
    return true;
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
            kLonger * ((size1 + size2) * place_m + 2.0 * kUnitRoundoff * size1 * size2);
        const double least = std::min({u, v, w}), greatest = std::max({u, v, w});
        if (least < -error && greatest > error) return Meeting::none;
        const bool is_sure = least > error || greatest < -error;
        const bool is_in_front = determinant * glm::dot(offset, normal) < 0.0;
        return is_sure && is_in_front ? Meeting::inside : Meeting::near_an_edge;
    }

private:
    static constexpr double kDoubleRoundings = 64.0;

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
