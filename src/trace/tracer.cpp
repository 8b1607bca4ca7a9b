// Ground truth by rays.
//
// The estimator is sum(w V) / sum(w) over the same stratified samples of the light, w what the
// sample would give if nothing were in the way. It is exact where all samples are visible or none
// is, stays in [0, 1], and its error is that of V along the edge of the occluder alone: dividing by
// the exact sum instead would add the error of w everywhere, and sampling in proportion to w needs
// the inverse of a polygon's cosine-weighted solid angle at each receiver. Being a ratio it has a
// bias, covariance(w, wV) / count at most; stratification shrinks it with the variance, far below
// one standard error.

#include "trace/tracer.h"

#include "base/parallel.h"
#include "trace/caster.h"
#include "trace/light_sample.h"
#include "trace/pixel_rays.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <type_traits>

namespace gnomon::trace {

namespace {

/// Side of the squares of pixels that are taken one after the other, so that rays that are traced
/// together are close together.
constexpr unsigned kTilePx = 8;

/// Tiles or rows that one task does: some milliseconds of work, so that threads are even and a
/// cancelled job ends at once.
constexpr std::size_t kRaysPerTask = 1 << 14;
constexpr std::size_t kRowsPerTask = 4;

std::size_t tiles_along(unsigned pixels) {
    return (std::size_t{pixels} + kTilePx - 1) / kTilePx;
}

template <typename LightType>
inline constexpr bool kDirectional = std::is_same_v<LightType, DirectionalLight>;

/// Visibility of a light without extent at receivers, as many at a time as are traced together.
template <typename LightType>
class HardShadows {
public:
    HardShadows(const Caster& caster, const LightType& light)
        : caster_(caster), light_(light), rays_(kDirectional<LightType>) {}

    /// Adds a receiver whose visibility is wanted in `out`, by the next finish() at the latest.
    void add(const Receiver& receiver, std::size_t, float& out) {
        if (!receiver.exists()) {
            out = 1.0f;
            return;
        }
        const LightSample place = sample_light(receiver, light_, Vec2(0.5f));
        if (!(place.weight > 0.0f)) {
            out = 0.0f;
            return;
        }
        outs_[rays_.size()] = &out;
        rays_.add(receiver, place.direction_ws);
        if (rays_.full()) finish();
    }

    void finish() {
        caster_.trace(rays_);
        for (std::size_t i = 0; i < rays_.size(); ++i)
            *outs_[i] = rays_.blocked(i) ? 0.0f : 1.0f;
        rays_.clear();
    }

private:
    const Caster& caster_;
    const LightType& light_;
    ShadowRays rays_;
    std::array<float*, ShadowRays::kCapacity> outs_;
};

/// The same for a light with extent: one sample of every receiver is traced together, then the
/// next.
template <typename LightType>
class SoftShadows {
public:
    SoftShadows(const Caster& caster, const LightType& light, const Strata& strata, unsigned seed)
        : caster_(caster),
          light_(light),
          strata_(strata),
          seed_(seed),
          rays_(kDirectional<LightType>) {}

    /// `index` of the receiver and the seed decide its samples.
    void add(const Receiver& receiver, std::size_t index, float& out) {
        if (!receiver.exists()) {
            out = 1.0f;
        } else if (!faces_light(receiver, light_)) {
            out = 0.0f;
        } else {
            lanes_[count_++] = {&receiver, &out, static_cast<std::uint32_t>(index), 0.0, 0.0};
            if (count_ == lanes_.size()) finish();
        }
    }

    void finish() {
        for (int sample = 0; sample < strata_.count() && count_ > 0; ++sample)
            cast(sample);
        for (std::size_t i = 0; i < count_; ++i) {
            const Lane& lane = lanes_[i];
            *lane.out = lane.weight > 0.0 ? static_cast<float>(lane.unblocked / lane.weight)
                                          : highest_visibility(*lane.receiver);
        }
        count_ = 0;
    }

private:
    struct Lane {
        const Receiver* receiver;
        float* out;
        std::uint32_t index;
        double weight, unblocked;
    };

    void cast(int sample) {
        rays_.clear();
        for (std::size_t i = 0; i < count_; ++i) {
            Lane& lane = lanes_[i];
            const Vec2 jitter = random_2d(lane.index, static_cast<std::uint32_t>(sample), seed_);
            const LightSample place =
                sample_light(*lane.receiver, light_, strata_.point(sample, jitter));
            if (!(place.weight > 0.0f)) continue;
            weights_[rays_.size()] = place.weight;
            lane_of_ray_[rays_.size()] = &lane;
            rays_.add(*lane.receiver, place.direction_ws);
        }
        caster_.trace(rays_);
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            lane_of_ray_[i]->weight += weights_[i];
            if (!rays_.blocked(i)) lane_of_ray_[i]->unblocked += weights_[i];
        }
    }

    /// What counts when all samples are below the horizon: the light's highest place, which is not.
    float highest_visibility(const Receiver& receiver) {
        rays_.clear();
        rays_.add(receiver, highest_direction(receiver, light_));
        caster_.trace(rays_);
        return rays_.blocked(0) ? 0.0f : 1.0f;
    }

    const Caster& caster_;
    const LightType& light_;
    const Strata& strata_;
    unsigned seed_;
    std::array<Lane, ShadowRays::kCapacity> lanes_;
    std::size_t count_ = 0;
    // The rays of one sample: of those lanes for which it is above the horizon.
    ShadowRays rays_;
    std::array<float, ShadowRays::kCapacity> weights_;
    std::array<Lane*, ShadowRays::kCapacity> lane_of_ray_;
};

/// Calls shadows.add() for the pixels of tiles [first, last), and finishes.
template <typename Shadows>
void add_tiles(Shadows& shadows, std::span<const Receiver> receivers, Extent size,
               std::size_t first, std::size_t last, std::span<float> out) {
    const std::size_t tiles_across = tiles_along(size.width);
    for (std::size_t tile = first; tile < last; ++tile) {
        const unsigned left = static_cast<unsigned>(tile % tiles_across) * kTilePx;
        const unsigned top = static_cast<unsigned>(tile / tiles_across) * kTilePx;
        for (unsigned y = top; y < std::min(top + kTilePx, size.height); ++y) {
            for (unsigned x = left; x < std::min(left + kTilePx, size.width); ++x) {
                const std::size_t i = std::size_t{y} * size.width + x;
                // The next tile's: its rows are too far apart for the processor to foresee.
                __builtin_prefetch(&receivers[std::min(i + kTilePx, receivers.size() - 1)]);
                shadows.add(receivers[i], i, out[i]);
            }
        }
    }
    shadows.finish();
}

}  // namespace

Tracer::Tracer(const Scene& scene, bool ignore_alpha, Progress& progress)
    : scene_(scene), caster_(std::make_unique<const Caster>(scene_, ignore_alpha, progress)) {}

Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;

std::vector<Receiver> Tracer::receivers(const Camera& camera, Extent size,
                                        std::span<const SurfaceId> surfaces) const {
    assert(surfaces.size() == std::size_t{size.width} * size.height);
    std::vector<Receiver> receivers(surfaces.size());
    const PixelRays pixel_rays(camera, size);
    parallel_for(size.height, kRowsPerTask, [&](std::size_t first, std::size_t last) {
        for (std::size_t y = first; y < last; ++y) {
            for (unsigned x = 0; x < size.width; ++x) {
                const SurfaceId surface = surfaces[y * size.width + x];
                if (surface.instance == kNoReceiver) continue;
                const auto ray = pixel_rays(x + 0.5, static_cast<double>(y) + 0.5);
                receivers[y * size.width + x] = receiver_on(
                    world_triangle(scene_, surface), surface, ray.origin_ws, ray.direction_ws);
            }
        }
    });
    return receivers;
}

void Tracer::visibility(std::span<const Receiver> receivers, Extent size, const Light& light,
                        int samples, unsigned seed, std::span<float> out,
                        Progress& progress) const {
    assert(receivers.size() == std::size_t{size.width} * size.height);
    assert(out.size() == receivers.size());
    const bool soft = has_extent(light);
    const Strata strata(soft ? samples : 1);
    const std::size_t rays_per_tile =
        std::size_t{kTilePx} * kTilePx * static_cast<std::size_t>(strata.count());
    const std::size_t tiles_per_task = std::max<std::size_t>(1, kRaysPerTask / rays_per_tile);
    const auto trace_tiles = [&](const auto& kind, std::size_t first, std::size_t last) {
        if (soft) {
            SoftShadows shadows(*caster_, kind, strata, seed);
            add_tiles(shadows, receivers, size, first, last, out);
        } else {
            HardShadows shadows(*caster_, kind);
            add_tiles(shadows, receivers, size, first, last, out);
        }
    };
    parallel_for(
        tiles_along(size.width) * tiles_along(size.height), tiles_per_task,
        [&](std::size_t first, std::size_t last) {
            std::visit([&](const auto& kind) { trace_tiles(kind, first, last); }, light);
        },
        "tracing shadow rays", &progress);
}

void Tracer::blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> out) const {
    assert(out.size() == rays.size());
    if (rays.empty()) return;
    ShadowRays batch(rays.front().to_infinity);
    for (std::size_t first = 0; first < rays.size(); first += batch.size()) {
        batch.clear();
        for (std::size_t i = first; i < rays.size() && !batch.full(); ++i) {
            assert(rays[i].to_infinity == rays.front().to_infinity);
            batch.add(*rays[i].receiver, rays[i].direction_ws);
        }
        caster_->trace(batch);
        for (std::size_t i = 0; i < batch.size(); ++i)
            out[first + i] = batch.blocked(i) ? 1 : 0;
    }
}

std::vector<SurfaceId> Tracer::visible_surfaces(const Camera& camera, Extent size,
                                                Progress& progress) const {
    std::vector<SurfaceId> surfaces(std::size_t{size.width} * size.height);
    const PixelRays pixel_rays(camera, size);
    const float t_max = camera.ortho_height_m > 0.0f ? camera.ortho_depth_m
                                                     : std::numeric_limits<float>::infinity();
    parallel_for(
        size.height, kRowsPerTask,
        [&](std::size_t first, std::size_t last) {
            for (std::size_t y = first; y < last; ++y) {
                for (unsigned x = 0; x < size.width; ++x) {
                    const auto ray = pixel_rays(x + 0.5, static_cast<double>(y) + 0.5);
                    surfaces[y * size.width + x] = caster_->first_seen(
                        Vec3(ray.origin_ws), Vec3(ray.direction_ws), camera.near_m, t_max);
                }
            }
        },
        "tracing rays from the eye", &progress);
    return surfaces;
}

std::vector<SurfaceId> Tracer::first_seen(std::span<const Vec3> from_ws, Vec3 direction_ws,
                                          float t_min, Progress& progress) const {
    std::vector<SurfaceId> surfaces(from_ws.size());
    parallel_for(
        from_ws.size(), kRaysPerTask,
        [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                surfaces[i] = caster_->first_seen(from_ws[i], direction_ws, t_min,
                                                  std::numeric_limits<float>::infinity());
            }
        },
        "tracing rays from points", &progress);
    return surfaces;
}

}  // namespace gnomon::trace
