// The scene in Embree: I. Wald et al., "Embree: A Kernel Framework for Efficient CPU Ray Tracing",
// ACM Transactions on Graphics 33(4), 2014. Compiles against Embree 3 and 4.
//
// Meshes that are used once lie in the top scene, their corners moved to the world in double;
// meshes used more often are Embree instances. Geometry number = instance number in both cases.
// RTC_SCENE_FLAG_ROBUST: without it rays can slip through the common edge of two triangles, and
// a closed room would let in light. bench/trace_bench.cpp shows what it costs.

#include "trace/caster.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "base/check.h"
#include "base/parallel.h"
#include "trace/alpha.h"

#include <glm/ext/matrix_double3x3.hpp>
#include <glm/ext/matrix_double4x4.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace gnomon::trace {

namespace {

constexpr std::string_view kBuildTask = "building the ray tracer's tree";

// What changed its name between Embree 3 and 4.
#if RTC_VERSION_MAJOR >= 4
using QueryContext = RTCRayQueryContext;
constexpr auto kCoherent = RTC_RAY_QUERY_FLAG_COHERENT;

RTCOccludedArguments occluded_arguments(QueryContext& context) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.flags = kCoherent;
    arguments.context = &context;
    return arguments;
}
void init_context(QueryContext& context) {
    rtcInitRayQueryContext(&context);
}
void occluded(const int* valid, RTCScene scene, QueryContext& context, RTCRay4& rays) {
    RTCOccludedArguments arguments = occluded_arguments(context);
    rtcOccluded4(valid, scene, &rays, &arguments);
}
void occluded(const int* valid, RTCScene scene, QueryContext& context, RTCRay8& rays) {
    RTCOccludedArguments arguments = occluded_arguments(context);
    rtcOccluded8(valid, scene, &rays, &arguments);
}
void occluded(const int* valid, RTCScene scene, QueryContext& context, RTCRay16& rays) {
    RTCOccludedArguments arguments = occluded_arguments(context);
    rtcOccluded16(valid, scene, &rays, &arguments);
}
void intersect1(RTCScene scene, QueryContext& context, RTCRayHit& ray) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &context;
    rtcIntersect1(scene, &ray, &arguments);
}
#else
using QueryContext = RTCIntersectContext;

void init_context(QueryContext& context) {
    rtcInitIntersectContext(&context);
    //context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
}
void occluded(const int* valid, RTCScene scene, QueryContext& context, RTCRay4& rays) {
    rtcOccluded4(valid, scene, &context, &rays);
}
void occluded(const int* valid, RTCScene scene, QueryContext& context, RTCRay8& rays) {
    rtcOccluded8(valid, scene, &context, &rays);
}
void occluded(const int* valid, RTCScene scene, QueryContext& context, RTCRay16& rays) {
    rtcOccluded16(valid, scene, &context, &rays);
}
void intersect1(RTCScene scene, QueryContext& context, RTCRayHit& ray) {
    rtcIntersect1(scene, &context, &ray);
}
#endif

/// Hits nearer than this cannot be told from the receiver. The filters would reject them one by
/// one; starting the ray behind them is cheaper.
float t_near(const ShadowRay& ray) {
    const float near_m = rounding_distance_m(ray.receiver->position_ws);
    return ray.to_infinity ? near_m : near_m / glm::length(ray.direction_ws);
}

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

/// What the filters need to know about a query. Embree hands back the pointer to `base`.
struct Query {
    QueryContext base;
    const Scene* scene = nullptr;
    std::span<const ShadowRay> rays;  ///< occlusion queries: by ray id
    Vec3 direction_ws{0.0f};          ///< queries for the first hit
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

/// Calls rejects(query, surface, lane) for each hit that Embree has found, and makes Embree go on
/// where it is true.
template <typename Rejects>
void filter_hits(const RTCFilterFunctionNArguments& arguments, const Rejects& rejects) {
    const Query& query = query_of(arguments);
    for (unsigned lane = 0; lane < arguments.N; ++lane) {
        if (arguments.valid[lane] == 0) continue;
        const SurfaceId surface = surface_of(arguments.hit, arguments.N, lane);
        if (rejects(query, surface, lane)) arguments.valid[lane] = 0;
    }
}

bool hits_hole(const RTCFilterFunctionNArguments& arguments, const Scene& scene, SurfaceId surface,
               unsigned lane) {
    return is_hole(scene, mesh_of(scene, surface), surface.primitive,
                   RTCHitN_u(arguments.hit, arguments.N, lane),
                   RTCHitN_v(arguments.hit, arguments.N, lane));
}

template <bool kMasked>
void reject_unblocking(const RTCFilterFunctionNArguments* arguments) {
    filter_hits(*arguments, [&](const Query& query, SurfaceId surface, unsigned lane) {
        const ShadowRay& ray = query.rays[RTCRayN_id(arguments->ray, arguments->N, lane)];
        if (surface == ray.receiver->id) return true;
        if (kMasked && hits_hole(*arguments, *query.scene, surface, lane)) return true;
        return touches_only(world_triangle(*query.scene, surface), ray);
    });
}

template <bool kMasked>
void reject_unseen(const RTCFilterFunctionNArguments* arguments) {
    filter_hits(*arguments, [&](const Query& query, SurfaceId surface, unsigned lane) {
        const Scene& scene = *query.scene;
        if (kMasked && hits_hole(*arguments, scene, surface, lane)) return true;
        if (scene.materials()[mesh_of(scene, surface).material].double_sided) return false;
        const DVec3 front = world_triangle(scene, surface).front_normal_ws();
        return glm::dot(front, DVec3(query.direction_ws)) > 0.0;
    });
}

/// The rays as a packet of N, and which of them are blocked.
template <unsigned N, typename Packet>
std::uint32_t blocked_packet(RTCScene top, QueryContext& context, std::span<const ShadowRay> rays,
                             std::size_t first) {
    alignas(Packet) int valid[N];
    Packet packet;
    const auto count = static_cast<unsigned>(std::min<std::size_t>(N, rays.size() - first));
    for (unsigned lane = 0; lane < N; ++lane) {
        valid[lane] = lane < count ? -1 : 0;
        const ShadowRay& ray = rays[first + std::min(lane, count - 1)];
        const Vec3 origin = ray.receiver->position_ws;
        packet.org_x[lane] = origin.x;
        packet.org_y[lane] = origin.y;
        packet.org_z[lane] = origin.z;
        packet.dir_x[lane] = ray.direction_ws.x;
        packet.dir_y[lane] = ray.direction_ws.y;
        packet.dir_z[lane] = ray.direction_ws.z;
        packet.tnear[lane] = t_near(ray);
        packet.tfar[lane] = ray.to_infinity ? std::numeric_limits<float>::infinity() : 1.0f;
        packet.time[lane] = 0.0f;
        packet.mask[lane] = ~0u;
        packet.id[lane] = static_cast<unsigned>(first) + lane;
        packet.flags[lane] = 0;
    }
    occluded(valid, top, context, packet);
    std::uint32_t blocked = 0;
    // Embree marks rays that hit something by an end at minus infinity.
    for (unsigned lane = 0; lane < count; ++lane) {
        if (packet.tfar[lane] < 0.0f) blocked |= 1u << lane;
    }
    return blocked << first;
}

}  // namespace

class Caster::Impl {
public:
    Impl(const Scene& scene, bool ignore_alpha, Progress& progress)
        : scene_(scene), ignore_alpha_(ignore_alpha), device_(rtcNewDevice(nullptr)) {
        if (!device_) {
            fail_machine("Embree: no device (error {})",
                         static_cast<int>(rtcGetDeviceError(nullptr)));
        }
        rtcSetDeviceErrorFunction(device_.get(), &Impl::keep_error, this);
        packet_size_ = native_packet_size();
        build(progress);
        // Only errors of the build are wanted; queries report none, and Impl is immutable from
        // here.
        rtcSetDeviceErrorFunction(device_.get(), nullptr, nullptr);
    }

    std::uint32_t blocked(std::span<const ShadowRay> rays) const {
        Query query;
        init_context(query.base);
        query.scene = &scene_;
        query.rays = rays;
        std::uint32_t result = 0;
        for (std::size_t first = 0; first < rays.size(); first += packet_size_) {
            switch (packet_size_) {
                case 16:
                    result |= blocked_packet<16, RTCRay16>(top_.get(), query.base, rays, first);
                    break;
                case 8:
                    result |= blocked_packet<8, RTCRay8>(top_.get(), query.base, rays, first);
                    break;
                default:
                    result |= blocked_packet<4, RTCRay4>(top_.get(), query.base, rays, first);
            }
        }
        return result;
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
        intersect1(top_.get(), query.base, ray);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
        return surface_of(reinterpret_cast<RTCHitN*>(&ray.hit), 1, 0);
    }

private:
    std::size_t native_packet_size() const {
        const auto has = [&](RTCDeviceProperty property) {
            return rtcGetDeviceProperty(device_.get(), property) != 0;
        };
        if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) return 16;
        return has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) ? 8 : 4;
    }

    void build(Progress& progress) {
        const std::vector<Instance>& instances = scene_.instances();
        std::vector<unsigned> uses(scene_.meshes().size());
        for (const Instance& instance : instances)
            ++uses[instance.mesh];

        top_ = new_scene(progress);
        mesh_scenes_.resize(scene_.meshes().size());
        for (std::uint32_t i = 0; i < instances.size(); ++i) {
            const Instance& instance = instances[i];
            const Mesh& mesh = scene_.meshes()[instance.mesh];
            if (mesh.triangles.empty()) continue;
            if (uses[instance.mesh] == 1 || !invertible(instance.world_from_local)) {
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
        }
        commit(top_, progress);
    }

    /// Embree takes rays into the mesh's space, which a flattened one does not have.
    static bool invertible(const Mat4& world_from_local) {
        const glm::mat3 inverse = glm::inverse(glm::mat3(world_from_local));
        for (int column = 0; column < 3; ++column) {
            if (!std::isfinite(glm::dot(inverse[column], inverse[column]))) return false;
        }
        return true;
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
    std::size_t packet_size_ = 4;
    RTCError error_ = RTC_ERROR_NONE;
    std::string error_message_;
    DevicePtr device_;
    std::vector<ScenePtr> mesh_scenes_;  // one a mesh, null for those that are not instanced
    ScenePtr top_;
};

Caster::Caster(const Scene& scene, bool ignore_alpha, Progress& progress)
    : impl_(std::make_unique<const Impl>(scene, ignore_alpha, progress)) {}

Caster::~Caster() = default;

std::uint32_t Caster::blocked(std::span<const ShadowRay> rays) const {
    return impl_->blocked(rays);
}

SurfaceId Caster::first_seen(Vec3 origin_ws, Vec3 direction_ws, float t_min, float t_max) const {
    return impl_->first_seen(origin_ws, direction_ws, t_min, t_max);
}

}  // namespace gnomon::trace
