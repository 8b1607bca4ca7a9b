// The scene in Embree: I. Wald et al., "Embree: A Kernel Framework for Efficient CPU Ray Tracing",
// ACM Transactions on Graphics 33(4), 2014. Compiles against Embree 3 and 4.
//
// Meshes lie in the top scene, their corners moved to the world in double; in large scenes those
// that are used more than once are Embree instances. Geometry number = instance number in both
// cases.
// RTC_SCENE_FLAG_ROBUST: without it rays can slip through the common edge of two triangles, and
// a closed room would let in light. bench/trace_bench.cpp shows what it costs.

#include "trace/caster.h"

#if __has_include(<embree3/rtcore.h>)  // first, as cmake/dependencies.cmake looks for it
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif

#include "base/check.h"
#include "base/parallel.h"
#include "trace/alpha.h"

#include <glm/ext/matrix_double3x3.hpp>
#include <glm/ext/matrix_double4x4.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace gnomon::trace {

namespace {

/// Embree as GCC builds it hangs in its AVX-512 kernels when the stack holds the wrong garbage:
/// masks are stored with 16 bits and read with 64 (RenderKit/embree pull request 574, found
/// in 3.13.5 of Debian 12 and in releases up to 4.4.0).
constexpr const char* kDeviceConfig = "max_isa=avx2";

/// Scenes of at most so many triangles, instances counted, know no instances: one tree over all of
/// them is walked faster. It takes about 150 bytes a triangle.
constexpr std::uint64_t kFlatTriangles = 2'000'000;

constexpr std::string_view kBuildTask = "building the ray tracer's tree";

// What all shadow rays of a batch have in common, one value a lane. The id is the lane.
constexpr std::size_t kLanes = ShadowRays::kCapacity;
alignas(64) constexpr std::array<float, kLanes> kZeros{};
alignas(64) constexpr std::array<unsigned, kLanes> kNoFlags{};
alignas(64) constexpr std::array<unsigned, kLanes> kEveryMask = [] {
    std::array<unsigned, kLanes> mask{};
    mask.fill(~0u);
    return mask;
}();
alignas(64) constexpr std::array<unsigned, kLanes> kIds = [] {
    std::array<unsigned, kLanes> ids{};
    for (unsigned lane = 0; lane < kLanes; ++lane)
        ids[lane] = lane;
    return ids;
}();

// What differs between Embree 3 and 4. Streams are the fastest of Embree 3's calls for coherent
// rays (bench/trace_bench.cpp); Embree 4 has none, so there it is packets of 8, or of 4 without
// AVX. Both mark the rays that are blocked by a negative tfar.
#if RTC_VERSION_MAJOR >= 4
using QueryContext = RTCRayQueryContext;
constexpr auto kBatchSupported = RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED;

struct RayLanes {
    float *org_x, *org_y, *org_z, *tnear;
    float *dir_x, *dir_y, *dir_z, *time;
    float* tfar;
    unsigned *mask, *id, *flags;
};

void init_context(QueryContext& context) {
    rtcInitRayQueryContext(&context);
}

template <unsigned N, typename Packet>
void occluded_packets(RTCScene scene, RTCOccludedArguments& arguments, const RayLanes& rays,
                      std::size_t count,
                      void (*occluded)(const int*, RTCScene, Packet*, RTCOccludedArguments*)) {
    for (std::size_t first = 0; first < count; first += N) {
        alignas(Packet) int valid[N];
        for (unsigned lane = 0; lane < N; ++lane)
            valid[lane] = first + lane < count ? -1 : 0;
        Packet packet;
        const auto take = [first](auto& lanes, const auto* from) {
            std::memcpy(lanes, from + first, sizeof(lanes));
        };
        take(packet.org_x, rays.org_x);
        take(packet.org_y, rays.org_y);
        take(packet.org_z, rays.org_z);
        take(packet.tnear, rays.tnear);
        take(packet.dir_x, rays.dir_x);
        take(packet.dir_y, rays.dir_y);
        take(packet.dir_z, rays.dir_z);
        take(packet.time, rays.time);
        take(packet.tfar, rays.tfar);
        take(packet.mask, rays.mask);
        take(packet.id, rays.id);
        take(packet.flags, rays.flags);
        occluded(valid, scene, &packet, &arguments);
        std::memcpy(rays.tfar + first, packet.tfar, sizeof(packet.tfar));
    }
}

void occluded_batch(RTCDevice device, RTCScene scene, QueryContext& context, const RayLanes& rays,
                    std::size_t count) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    arguments.context = &context;
    if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0) {
        occluded_packets<8, RTCRay8>(scene, arguments, rays, count, &rtcOccluded8);
    } else {
        occluded_packets<4, RTCRay4>(scene, arguments, rays, count, &rtcOccluded4);
    }
}

void intersect(RTCScene scene, QueryContext& context, RTCRayHit& ray) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &context;
    rtcIntersect1(scene, &ray, &arguments);
}

#else
using QueryContext = RTCIntersectContext;
using RayLanes = RTCRayNp;
constexpr auto kBatchSupported = RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED;

void init_context(QueryContext& context) {
    rtcInitIntersectContext(&context);
}

void occluded_batch(RTCDevice, RTCScene scene, QueryContext& context, const RayLanes& rays,
                    std::size_t count) {
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcOccludedNp(scene, &context, &rays, static_cast<unsigned>(count));
}

void intersect(RTCScene scene, QueryContext& context, RTCRayHit& ray) {
    rtcIntersect1(scene, &context, &ray);
}
#endif

struct DeviceDeleter {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct GeometryDeleter {
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using DevicePtr = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceDeleter>;
using ScenePtr = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneDeleter>;
using GeometryPtr = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, GeometryDeleter>;

/// Hits that are farther than this from the receiver's plane, and whose own plane is as far from
/// the receiver and from the light, block for sure: a thousand roundings, relative to the
/// coordinates, where touches_only() tolerates seven. Only nearer ones are judged exactly, because
/// fetching the corners costs as much as the ray.
constexpr float kClearFraction = 1024.0f * static_cast<float>(kUnitRoundoff);

float sum_of_magnitudes(Vec3 v) {
    return glm::dot(glm::abs(v), Vec3(1.0f));
}

/// What the filters need to know about a query. Embree hands back the pointer to `base`.
struct Query {
    QueryContext base;
    const Scene* scene = nullptr;
    float scene_magnitude_m = 0.0f;    ///< bounds the sum of a corner's coordinates
    float local_scale = 1.0f;          ///< most that a world's metre can be in a mesh's space
    const ShadowRays* rays = nullptr;  ///< occlusion queries
    Vec3 direction_ws{0.0f};           ///< queries for the first hit
};

const Query& query_of(const RTCFilterFunctionNArguments& arguments) {
    return *reinterpret_cast<const Query*>(arguments.context);
}

SurfaceId surface_of(RTCHitN* hits, unsigned count, unsigned lane) {
    const unsigned instance = RTCHitN_instID(hits, count, lane, 0);
    return {instance != RTC_INVALID_GEOMETRY_ID ? instance : RTCHitN_geomID(hits, count, lane),
            RTCHitN_primID(hits, count, lane)};
}

const Mesh& mesh_of(const Scene& scene, SurfaceId surface) {
    return scene.meshes()[scene.instances()[surface.instance].mesh];
}

/// Calls rejects(query, lane) for each hit that Embree has found, and makes Embree go on where it
/// is true.
template <typename Rejects>
void filter_hits(const RTCFilterFunctionNArguments& arguments, const Rejects& rejects) {
    const Query& query = query_of(arguments);
    for (unsigned lane = 0; lane < arguments.N; ++lane) {
        if (arguments.valid[lane] != 0 && rejects(query, lane)) arguments.valid[lane] = 0;
    }
}

bool hits_hole(const RTCFilterFunctionNArguments& arguments, const Scene& scene, SurfaceId surface,
               unsigned lane) {
    return is_hole(scene, mesh_of(scene, surface), surface.primitive,
                   RTCHitN_u(arguments.hit, arguments.N, lane),
                   RTCHitN_v(arguments.hit, arguments.N, lane));
}

/// True for nearly all hits, and never for one on the receiver's own triangle.
bool clearly_blocks(const Query& query, const RTCFilterFunctionNArguments& arguments, unsigned lane,
                    const ShadowRay& ray) {
    // Embree gives the ray and the normal in the space of the mesh.
    RTCRayN* rays = arguments.ray;
    RTCHitN* hits = arguments.hit;
    const unsigned n = arguments.N;
    const Vec3 direction(RTCRayN_dir_x(rays, n, lane), RTCRayN_dir_y(rays, n, lane),
                         RTCRayN_dir_z(rays, n, lane));
    const Vec3 normal(RTCHitN_Ng_x(hits, n, lane), RTCHitN_Ng_y(hits, n, lane),
                      RTCHitN_Ng_z(hits, n, lane));
    const float t = RTCRayN_tfar(rays, n, lane);
    const float reach_m = query.scene_magnitude_m + sum_of_magnitudes(ray.receiver->position_ws) +
                          (ray.to_infinity ? 0.0f : sum_of_magnitudes(ray.direction_ws));
    const float clear_m = kClearFraction * reach_m;
    const float clear = clear_m * query.local_scale * glm::length(normal);
    const float slope = std::abs(glm::dot(normal, direction));
    return t * glm::dot(ray.receiver->normal_ws, ray.direction_ws) > clear_m && t * slope > clear &&
           (ray.to_infinity || (1.0f - t) * slope > clear);
}

template <bool kMasked>
void reject_unblocking(const RTCFilterFunctionNArguments* arguments) {
    filter_hits(*arguments, [&](const Query& query, unsigned lane) {
        const ShadowRay ray = query.rays->ray(RTCRayN_id(arguments->ray, arguments->N, lane));
        const bool clear = clearly_blocks(query, *arguments, lane, ray);
        if (!kMasked && clear) return false;
        const SurfaceId surface = surface_of(arguments->hit, arguments->N, lane);
        if (surface == ray.receiver->id) return true;
        if (kMasked && hits_hole(*arguments, *query.scene, surface, lane)) return true;
        return !clear && touches_only(*query.scene, world_triangle(*query.scene, surface), ray);
    });
}

template <bool kMasked>
void reject_unseen(const RTCFilterFunctionNArguments* arguments) {
    filter_hits(*arguments, [&](const Query& query, unsigned lane) {
        const Scene& scene = *query.scene;
        const SurfaceId surface = surface_of(arguments->hit, arguments->N, lane);
        if (kMasked && hits_hole(*arguments, scene, surface, lane)) return true;
        if (scene.materials()[mesh_of(scene, surface).material].double_sided) return false;
        const DVec3 front = world_triangle(scene, surface).front_normal_ws();
        return glm::dot(front, DVec3(query.direction_ws)) > 0.0;
    });
}

template <typename T>
T* unchanged(const std::array<T, kLanes>& lanes) {
    return const_cast<T*>(lanes.data());  // Embree's interface knows no const
}

}  // namespace

ShadowRays::ShadowRays(bool to_infinity)
    : to_infinity_(to_infinity),
      end_(to_infinity ? std::numeric_limits<float>::infinity() : 1.0f) {}

class Caster::Impl {
public:
    Impl(const Scene& scene, bool ignore_alpha, Progress& progress)
        : scene_(scene), ignore_alpha_(ignore_alpha), device_(rtcNewDevice(kDeviceConfig)) {
        if (!device_) {
            fail_machine("Embree: no device (error {})",
                         static_cast<int>(rtcGetDeviceError(nullptr)));
        }
        rtcSetDeviceErrorFunction(device_.get(), &Impl::keep_error, this);
        if (rtcGetDeviceProperty(device_.get(), kBatchSupported) == 0) {
            fail_machine("Embree has no ray packets; it must be built with EMBREE_RAY_PACKETS=ON");
        }
        build(progress);
        // Only errors of the build are wanted; queries report none, and Impl is immutable from
        // here.
        rtcSetDeviceErrorFunction(device_.get(), nullptr, nullptr);
    }

    void trace(const ShadowRays& rays, const RayLanes& lanes) const {
        Query query;
        init_context(query.base);
        query.scene = &scene_;
        query.scene_magnitude_m = scene_magnitude_m_;
        query.local_scale = local_scale_;
        query.rays = &rays;
        occluded_batch(device_.get(), top_.get(), query.base, lanes, rays.size());
    }

    SurfaceId first_seen(Vec3 origin_ws, Vec3 direction_ws, float t_min, float t_max) const {
        Query query;
        init_context(query.base);
        query.scene = &scene_;
        query.direction_ws = direction_ws;
        RTCRayHit ray{};
        ray.ray.org_x = origin_ws.x;
        ray.ray.org_y = origin_ws.y;
        ray.ray.org_z = origin_ws.z;
        ray.ray.dir_x = direction_ws.x;
        ray.ray.dir_y = direction_ws.y;
        ray.ray.dir_z = direction_ws.z;
        ray.ray.tnear = t_min;
        ray.ray.tfar = t_max;
        ray.ray.mask = ~0u;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        intersect(top_.get(), query.base, ray);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
        return surface_of(reinterpret_cast<RTCHitN*>(&ray.hit), 1, 0);
    }

private:
    void build(Progress& progress) {
        const std::vector<Instance>& instances = scene_.instances();
        std::vector<unsigned> uses(scene_.meshes().size());
        for (const Instance& instance : instances)
            ++uses[instance.mesh];

        const bool flat = scene_.triangle_count() <= kFlatTriangles;
        top_ = new_scene(progress);
        mesh_scenes_.resize(scene_.meshes().size());
        if (!scene_.bounds().empty()) {
            scene_magnitude_m_ = sum_of_magnitudes(
                glm::max(glm::abs(scene_.bounds().min), glm::abs(scene_.bounds().max)));
        }
        for (std::uint32_t i = 0; i < instances.size(); ++i) {
            const Instance& instance = instances[i];
            const Mesh& mesh = scene_.meshes()[instance.mesh];
            if (mesh.triangles.empty()) continue;
            const float local_scale = scale_of_inverse(instance.world_from_local);
            if (flat || uses[instance.mesh] == 1 || !std::isfinite(local_scale)) {
                attach(top_, new_triangles(mesh, instance.world_from_local), i);
                continue;
            }
            ScenePtr& mesh_scene = mesh_scenes_[instance.mesh];
            if (!mesh_scene) {
                mesh_scene = new_scene(progress);
                attach(mesh_scene, new_triangles(mesh, Mat4(1.0f)), 0);
                commit(mesh_scene, progress);
            }
            attach(top_, new_instance(mesh_scene, instance.world_from_local), i);
            local_scale_ = std::max(local_scale_, local_scale);
        }
        commit(top_, progress);
    }

    /// The most by which the inverse lengthens a vector, or a little more: its Frobenius norm. Not
    /// finite when there is no inverse, by which Embree would take rays into the mesh's space.
    static float scale_of_inverse(const Mat4& world_from_local) {
        const glm::mat3 inverse = glm::inverse(glm::mat3(world_from_local));
        return std::sqrt(glm::dot(inverse[0], inverse[0]) + glm::dot(inverse[1], inverse[1]) +
                         glm::dot(inverse[2], inverse[2]));
    }

    ScenePtr new_scene(Progress& progress) {
        ScenePtr scene(rtcNewScene(device_.get()));
        require_no_error(progress);
        rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneProgressMonitorFunction(scene.get(), &Impl::report, &progress);
        return scene;
    }

    GeometryPtr new_triangles(const Mesh& mesh, const Mat4& world_from_local) {
        GeometryPtr geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
        auto* positions = static_cast<Vec3*>(
            rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                    sizeof(Vec3), mesh.positions.size()));
        if (positions == nullptr) fail_out_of_memory();
        const glm::dmat4 transform(world_from_local);
        std::ranges::transform(mesh.positions, positions, [&](Vec3 p) {
            return Vec3(DVec3(transform * glm::dvec4(DVec3(p), 1.0)));
        });
        rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   mesh.triangles.data(), 0, sizeof(UVec3), mesh.triangles.size());
        const bool masked = !ignore_alpha_ && scene_.materials()[mesh.material].masked();
        rtcSetGeometryOccludedFilterFunction(
            geometry.get(), masked ? &reject_unblocking<true> : &reject_unblocking<false>);
        if (masked) {
            rtcSetGeometryIntersectFilterFunction(geometry.get(), &reject_unseen<true>);
        } else if (!scene_.materials()[mesh.material].double_sided) {
            rtcSetGeometryIntersectFilterFunction(geometry.get(), &reject_unseen<false>);
        }
        rtcCommitGeometry(geometry.get());
        return geometry;
    }

    GeometryPtr new_instance(const ScenePtr& mesh_scene, const Mat4& world_from_local) {
        GeometryPtr geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE));
        rtcSetGeometryInstancedScene(geometry.get(), mesh_scene.get());
        rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR,
                                &world_from_local);
        rtcCommitGeometry(geometry.get());
        return geometry;
    }

    static void attach(const ScenePtr& scene, const GeometryPtr& geometry, unsigned id) {
        rtcAttachGeometryByID(scene.get(), geometry.get(), id);
    }

    void commit(const ScenePtr& scene, Progress& progress) {
        rtcCommitScene(scene.get());
        require_no_error(progress);
        // The monitor's Progress does not outlive the build.
        rtcSetSceneProgressMonitorFunction(scene.get(), nullptr, nullptr);
    }

    static bool report(void* progress, double fraction) {
        auto& monitor = *static_cast<Progress*>(progress);
        monitor.report(kBuildTask, fraction);
        return !monitor.cancelled();
    }

    static void keep_error(void* self, RTCError code, const char* message) {
        auto& impl = *static_cast<Impl*>(self);
        if (impl.error_ != RTC_ERROR_NONE) return;  // the first one is the cause
        impl.error_ = code;
        impl.error_message_ = message != nullptr ? message : "";
    }

    void require_no_error(const Progress& progress) const {
        throw_if_cancelled(progress, kBuildTask);
        if (error_ == RTC_ERROR_NONE) return;
        if (error_ == RTC_ERROR_OUT_OF_MEMORY) fail_out_of_memory();
        fail_machine("Embree: {} (error {}) while {}", error_message_, static_cast<int>(error_),
                     kBuildTask);
    }

    [[noreturn]] void fail_out_of_memory() const {
        fail_machine("out of memory while {}: the scene has {} triangles", kBuildTask,
                     scene_.triangle_count());
    }

    Scene scene_;
    bool ignore_alpha_;
    RTCError error_ = RTC_ERROR_NONE;
    std::string error_message_;
    float scene_magnitude_m_ = 0.0f;
    float local_scale_ = 1.0f;
    DevicePtr device_;
    std::vector<ScenePtr> mesh_scenes_;  // one a mesh, null for those that are not instanced
    ScenePtr top_;
};

Caster::Caster(const Scene& scene, bool ignore_alpha, Progress& progress)
    : impl_(std::make_unique<const Impl>(scene, ignore_alpha, progress)) {}

Caster::~Caster() = default;

void Caster::trace(ShadowRays& rays) const {
    if (rays.size() == 0) return;
    impl_->trace(rays, {.org_x = rays.origin_x_.data(),
                        .org_y = rays.origin_y_.data(),
                        .org_z = rays.origin_z_.data(),
                        .tnear = unchanged(kZeros),
                        .dir_x = rays.direction_x_.data(),
                        .dir_y = rays.direction_y_.data(),
                        .dir_z = rays.direction_z_.data(),
                        .time = unchanged(kZeros),
                        .tfar = rays.far_.data(),
                        .mask = unchanged(kEveryMask),
                        .id = unchanged(kIds),
                        .flags = unchanged(kNoFlags)});
}

SurfaceId Caster::first_seen(Vec3 origin_ws, Vec3 direction_ws, float t_min, float t_max) const {
    return impl_->first_seen(origin_ws, direction_ws, t_min, t_max);
}

}  // namespace gnomon::trace
