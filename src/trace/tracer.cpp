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

#include <glm/ext/matrix_double3x3.hpp>
#include <glm/ext/matrix_double4x4.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace gnomon::trace {

namespace {

/// Side of the square of pixels that make one packet of rays.
constexpr unsigned kTilePx = 4;
static_assert(kTilePx * kTilePx == Caster::kPacketSize);

/// Tiles or rows that one task does: some milliseconds of work, so that threads are even and a
/// cancelled job ends at once.
constexpr std::size_t kRaysPerTask = 1 << 14;
constexpr std::size_t kRowsPerTask = 4;

/// Rays through the centres of a camera's pixels, in double.
class PixelRays {
public:
    PixelRays(const Camera& camera, Extent size)
        : world_from_view_(glm::inverse(glm::dmat4(camera.view_from_world))),
          parallel_(camera.ortho_height_m > 0.0f),
          half_height_(parallel_ ? 0.5 * camera.ortho_height_m : std::tan(0.5 * camera.fov_y_rad)),
          size_(size) {}

    struct Ray {
        DVec3 origin_ws, direction_ws;  ///< of length 1 along the view axis: t is the view depth
    };
    Ray operator()(unsigned x, unsigned y) const {
        const double side = 2.0 * half_height_ / size_.height;  // of a pixel, at view depth 1
        const double right = (x + 0.5 - 0.5 * size_.width) * side;
        const double up = (0.5 * size_.height - y - 0.5) * side;
        const glm::dvec4 place(right, up, parallel_ ? 0.0 : -1.0, parallel_ ? 1.0 : 0.0);
        const DVec3 in_world(world_from_view_ * place);
        if (parallel_) return {in_world, -DVec3(world_from_view_[2])};
        return {DVec3(world_from_view_[3]), in_world};
    }

private:
    glm::dmat4 world_from_view_;
    bool parallel_;
    double half_height_;  ///< in metres if parallel, else at view depth 1
    Extent size_;
};

/// Visibility of one light at the receivers of up to a packet of pixels.
template <typename LightType>
class PacketEstimator {
public:
    /// One ray to a light without extent when `strata` is null.
    PacketEstimator(const Caster& caster, const LightType& light, const Strata* strata,
                    unsigned seed)
        : caster_(caster), light_(light), strata_(strata), seed_(seed) {}

    /// Adds receiver `index` of the picture, whose visibility is wanted in `out`.
    void add(const Receiver& receiver, std::uint32_t index, float& out) {
        if (!receiver.exists()) {
            out = 1.0f;
        } else if (strata_ != nullptr && !faces_light(receiver, light_)) {
            out = 0.0f;
        } else {
            lanes_[count_++] = {&receiver, index, &out, 0.0, 0.0};
        }
    }

    void run() {
        const int samples = strata_ != nullptr ? strata_->count() : 1;
        for (int sample = 0; sample < samples; ++sample) {
            cast(sample);
        }
        for (std::size_t i = 0; i < count_; ++i) {
            Lane& lane = lanes_[i];
            *lane.out = lane.weight > 0.0 ? static_cast<float>(lane.unblocked / lane.weight)
                                          : highest_visibility(*lane.receiver);
        }
        count_ = 0;
    }

private:
    static constexpr bool kDirectional = std::is_same_v<LightType, DirectionalLight>;

    struct Lane {
        const Receiver* receiver;
        std::uint32_t index;
        float* out;
        double weight, unblocked;
    };

    Vec2 place_of(std::uint32_t index, int sample) const {
        if (strata_ == nullptr) return {0.5f, 0.5f};
        return strata_->point(sample, random_2d(index, static_cast<std::uint32_t>(sample), seed_));
    }

    void cast(int sample) {
        std::array<ShadowRay, Caster::kPacketSize> rays;
        std::array<float, Caster::kPacketSize> weights;
        std::array<Lane*, Caster::kPacketSize> lanes;
        std::size_t rays_count = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            Lane& lane = lanes_[i];
            const LightSample place =
                sample_light(*lane.receiver, light_, place_of(lane.index, sample));
            if (!(place.weight > 0.0f)) continue;
            rays[rays_count] = {lane.receiver, place.direction_ws, kDirectional};
            weights[rays_count] = place.weight;
            lanes[rays_count++] = &lane;
        }
        if (rays_count == 0) return;
        const std::uint32_t blocked = caster_.blocked({rays.data(), rays_count});
        for (std::size_t i = 0; i < rays_count; ++i) {
            lanes[i]->weight += weights[i];
            if ((blocked >> i & 1u) == 0) lanes[i]->unblocked += weights[i];
        }
    }

    /// What counts when all samples are below the horizon: the light's highest place, if it is
    /// above.
    float highest_visibility(const Receiver& receiver) const {
        if (strata_ == nullptr) return 0.0f;
        const ShadowRay ray{&receiver, highest_direction(receiver, light_), kDirectional};
        return caster_.blocked({&ray, 1}) == 0 ? 1.0f : 0.0f;
    }

    const Caster& caster_;
    const LightType& light_;
    const Strata* strata_;
    unsigned seed_;
    std::array<Lane, Caster::kPacketSize> lanes_;
    std::size_t count_ = 0;
};

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
                const auto ray = pixel_rays(x, static_cast<unsigned>(y));
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
    const unsigned tiles_across = (size.width + kTilePx - 1) / kTilePx;
    const unsigned tiles_down = (size.height + kTilePx - 1) / kTilePx;
    const std::size_t rays_per_tile =
        Caster::kPacketSize * static_cast<std::size_t>(strata.count());
    const std::size_t tiles_per_task = std::max<std::size_t>(1, kRaysPerTask / rays_per_tile);

    const auto trace_tiles = [&](const auto& kind, std::size_t first, std::size_t last) {
        PacketEstimator estimator(*caster_, kind, soft ? &strata : nullptr, seed);
        for (std::size_t tile = first; tile < last; ++tile) {
            const unsigned left = static_cast<unsigned>(tile % tiles_across) * kTilePx;
            const unsigned top = static_cast<unsigned>(tile / tiles_across) * kTilePx;
            for (unsigned y = top; y < std::min(top + kTilePx, size.height); ++y) {
                for (unsigned x = left; x < std::min(left + kTilePx, size.width); ++x) {
                    const std::size_t i = std::size_t{y} * size.width + x;
                    estimator.add(receivers[i], static_cast<std::uint32_t>(i), out[i]);
                }
            }
            estimator.run();
        }
    };
    parallel_for(
        std::size_t{tiles_across} * tiles_down, tiles_per_task,
        [&](std::size_t first, std::size_t last) {
            std::visit([&](const auto& kind) { trace_tiles(kind, first, last); }, light);
        },
        "tracing shadow rays", &progress);
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
                    const auto ray = pixel_rays(x, static_cast<unsigned>(y));
                    surfaces[y * size.width + x] = caster_->first_seen(
                        Vec3(ray.origin_ws), Vec3(ray.direction_ws), camera.near_m, t_max);
                }
            }
        },
        "tracing rays from the eye", &progress);
    return surfaces;
}

}  // namespace gnomon::trace
