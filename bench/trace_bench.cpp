// Rays per second of Tracer::visibility beside Embree's own calls in bare loops on the same rays.
//
//     trace_bench [SCENE [WIDTH HEIGHT [ROUNDS [ONLY]]]]
//
// SCENE is a file or a built-in scene; without one, hills with 500 instances of a blob, a million
// triangles in all. ONLY is a part of the names of the bare loops to run. One shadow ray towards
// the first directional light (or a sun) from each receiver that faces it, pixels in tiles of 4x4.
// All contestants take turns in each round; medians are printed, for one thread and for two. Bare
// loops do less: they start a little off the surface instead of ignoring the receiver's own
// triangle, know no alpha masks, and write bits.

#include <gnomon/error.h>
#include <gnomon/scene.h>

#include "bench_main.h"
#include "trace/light_sample.h"
#include "trace/tracer.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace gnomon {
namespace {

using Clock = std::chrono::steady_clock;
using trace::Receiver;

constexpr const char* kOurs = "Tracer::visibility";

Vec3 hill(float x, float z) {
    return {x,
            12.0f * std::sin(0.013f * x) * std::cos(0.017f * z) +
                2.0f * std::sin(0.11f * x + 0.07f * z),
            z};
}

/// A grid of `cells` x `cells` squares; `place` takes (0..1, 0..1).
Mesh grid(int cells, const std::function<Vec3(float, float)>& place) {
    Mesh mesh;
    const float step = 1.0f / static_cast<float>(cells);
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            mesh.positions.push_back(
                place(static_cast<float>(i) * step, static_cast<float>(j) * step));
        }
    }
    const auto side = static_cast<unsigned>(cells + 1);
    for (unsigned j = 0; j + 1 < side; ++j) {
        for (unsigned i = 0; i + 1 < side; ++i) {
            const unsigned a = j * side + i;
            mesh.triangles.push_back({a, a + side, a + 1});
            mesh.triangles.push_back({a + 1, a + side, a + side + 1});
        }
    }
    return mesh;
}

Scene field() {
    SceneData data;
    data.materials.emplace_back();
    data.meshes.push_back(grid(
        500, [](float u, float v) { return hill(1000.0f * (u - 0.5f), 1000.0f * (v - 0.5f)); }));
    data.meshes.push_back(grid(22, [](float u, float v) {
        const float polar = kPi * v;
        const float around = 2.0f * kPi * u;
        const float radius = 3.0f + 0.4f * std::sin(9.0f * around) * std::sin(7.0f * polar);
        return Vec3(radius * std::sin(polar) * std::cos(around), 4.0f - radius * std::cos(polar),
                    -radius * std::sin(polar) * std::sin(around));
    }));
    data.instances.push_back({.mesh = 0, .object = 0, .world_from_local = Mat4(1.0f), .name = ""});
    unsigned state = 1;
    const auto random = [&] {
        state = state * 1664525u + 1013904223u;
        return static_cast<float>(state >> 8) / static_cast<float>(1 << 24);
    };
    for (std::uint32_t i = 1; i <= 500; ++i) {
        const float x = 900.0f * (random() - 0.5f);
        const float z = 900.0f * (random() - 0.5f);
        Mat4 world_from_local(1.0f);
        world_from_local[3] = Vec4(hill(x, z), 1.0f);
        data.instances.push_back(
            {.mesh = 1, .object = i, .world_from_local = world_from_local, .name = ""});
    }
    data.cameras.push_back(look_at(hill(0.0f, 400.0f) + Vec3(0, 15, 0), hill(0.0f, 0.0f)));
    data.lights.push_back(sun(radians(35.0f), radians(120.0f), 0.0f));
    return Scene(std::move(data));
}

/// The scene in Embree with nothing but triangles: what a user's first program would do.
struct BareScene {
    // Not AVX-512: see caster.cpp. Its 16 rays wide kernels hang here too.
    RTCDevice device = rtcNewDevice("max_isa=avx2");
    RTCScene top = nullptr;

    /// `flat`: a copy of each mesh for each instance.
    BareScene(const Scene& scene, RTCSceneFlags flags, bool flat) {
        std::vector<unsigned> uses(scene.meshes().size());
        for (const Instance& instance : scene.instances()) {
            if (!flat) ++uses[instance.mesh];
        }
        std::vector<RTCScene> mesh_scenes(scene.meshes().size());
        top = rtcNewScene(device);
        rtcSetSceneFlags(top, flags);
        for (const Instance& instance : scene.instances()) {
            const Mesh& mesh = scene.meshes()[instance.mesh];
            if (mesh.triangles.empty()) continue;
            if (uses[instance.mesh] <= 1) {
                attach(top, triangles(mesh, instance.world_from_local));
                continue;
            }
            RTCScene& mesh_scene = mesh_scenes[instance.mesh];
            if (mesh_scene == nullptr) {
                mesh_scene = rtcNewScene(device);
                rtcSetSceneFlags(mesh_scene, flags);
                attach(mesh_scene, triangles(mesh, Mat4(1.0f)));
                rtcCommitScene(mesh_scene);
            }
            RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
            rtcSetGeometryInstancedScene(geometry, mesh_scene);
            rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR,
                                    &instance.world_from_local);
            rtcCommitGeometry(geometry);
            attach(top, geometry);
        }
        rtcCommitScene(top);
    }

    RTCGeometry triangles(const Mesh& mesh, const Mat4& transform) const {
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* positions = static_cast<Vec3*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                    sizeof(Vec3), mesh.positions.size()));
        std::ranges::transform(mesh.positions, positions,
                               [&](Vec3 p) { return Vec3(transform * Vec4(p, 1.0f)); });
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   mesh.triangles.data(), 0, sizeof(UVec3), mesh.triangles.size());
        rtcCommitGeometry(geometry);
        return geometry;
    }

    static void attach(RTCScene scene, RTCGeometry geometry) {
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
    }
};

/// Receivers that face the light, tile by tile, and the directions of their rays.
struct Rays {
    std::vector<Vec3> origins;
    Vec3 direction;
    std::size_t size() const { return origins.size(); }
};

Rays bare_rays(std::span<const Receiver> receivers, Extent size, const DirectionalLight& light) {
    constexpr unsigned kTilePx = 4;
    // Of the distance from the world's origin: enough for Embree not to find the own triangle.
    constexpr float kOffset = 16.0f * std::numeric_limits<float>::epsilon();
    Rays rays{{}, light.to_light_ws};
    for (unsigned top = 0; top < size.height; top += kTilePx) {
        for (unsigned left = 0; left < size.width; left += kTilePx) {
            for (unsigned i = 0; i < kTilePx * kTilePx; ++i) {
                const unsigned x = left + i % kTilePx;
                const unsigned y = top + i / kTilePx;
                if (x >= size.width || y >= size.height) continue;
                const Receiver& receiver = receivers[std::size_t{y} * size.width + x];
                if (!trace::faces_light(receiver, light)) continue;
                const float offset = kOffset * glm::length(receiver.position_ws);
                rays.origins.push_back(receiver.position_ws + offset * receiver.normal_ws);
            }
        }
    }
    return rays;
}

/// Fills one ray of a packet of any width; `lane` of `Packet::org_x` and so on.
template <typename Packet>
void fill(Packet& packet, unsigned lane, const Rays& rays, std::size_t index) {
    const Vec3 origin = rays.origins[std::min(index, rays.size() - 1)];
    packet.org_x[lane] = origin.x;
    packet.org_y[lane] = origin.y;
    packet.org_z[lane] = origin.z;
    packet.dir_x[lane] = rays.direction.x;
    packet.dir_y[lane] = rays.direction.y;
    packet.dir_z[lane] = rays.direction.z;
    packet.tnear[lane] = 0.0f;
    packet.tfar[lane] = std::numeric_limits<float>::infinity();
    packet.time[lane] = 0.0f;
    packet.mask[lane] = ~0u;
    packet.id[lane] = 0;
    packet.flags[lane] = 0;
}

RTCRay single(const Rays& rays, std::size_t index) {
    const Vec3 o = rays.origins[index];
    const Vec3 d = rays.direction;
    return {o.x, o.y, o.z, 0.0f, d.x, d.y, d.z, 0.0f, std::numeric_limits<float>::infinity(),
            ~0u, 0,   0};
}

using Blocked = std::vector<std::uint8_t>;
/// Traces rays [first, last).
using BareLoop = std::function<void(RTCScene, RTCIntersectContext&, const Rays&, std::size_t first,
                                    std::size_t last, Blocked&)>;

void loop_single(RTCScene scene, RTCIntersectContext& context, const Rays& rays, std::size_t first,
                 std::size_t last, Blocked& blocked) {
    for (std::size_t i = first; i < last; ++i) {
        RTCRay ray = single(rays, i);
        rtcOccluded1(scene, &context, &ray);
        blocked[i] = ray.tfar < 0.0f;
    }
}

template <unsigned N, typename Packet,
          void (*kOccluded)(const int*, RTCScene, RTCIntersectContext*, Packet*)>
void loop_packets(RTCScene scene, RTCIntersectContext& context, const Rays& rays, std::size_t first,
                  std::size_t last, Blocked& blocked) {
    alignas(64) int valid[N];
    Packet packet;
    for (std::size_t i = first; i < last; i += N) {
        for (unsigned lane = 0; lane < N; ++lane) {
            valid[lane] = i + lane < last ? -1 : 0;
            fill(packet, lane, rays, i + lane);
        }
        kOccluded(valid, scene, &context, &packet);
        for (unsigned lane = 0; lane < N && i + lane < last; ++lane) {
            blocked[i + lane] = packet.tfar[lane] < 0.0f;
        }
    }
}

void loop_stream(RTCScene scene, RTCIntersectContext& context, const Rays& rays, std::size_t first,
                 std::size_t last, Blocked& blocked) {
    constexpr std::size_t kStream = 256;
    std::array<RTCRay, kStream> stream;
    for (std::size_t i = first; i < last; i += kStream) {
        const std::size_t count = std::min(kStream, last - i);
        for (std::size_t k = 0; k < count; ++k)
            stream[k] = single(rays, i + k);
        rtcOccluded1M(scene, &context, stream.data(), static_cast<unsigned>(count), sizeof(RTCRay));
        for (std::size_t k = 0; k < count; ++k)
            blocked[i + k] = stream[k].tfar < 0.0f;
    }
}

void loop_lane_stream(RTCScene scene, RTCIntersectContext& context, const Rays& rays,
                      std::size_t first, std::size_t last, Blocked& blocked) {
    constexpr unsigned kStream = 256;
    struct Lanes {
        float org_x[kStream], org_y[kStream], org_z[kStream], tnear[kStream];
        float dir_x[kStream], dir_y[kStream], dir_z[kStream], time[kStream], tfar[kStream];
        unsigned mask[kStream], id[kStream], flags[kStream];
    };
    alignas(64) Lanes l;
    const RTCRayNp pointers{l.org_x, l.org_y, l.org_z, l.tnear, l.dir_x, l.dir_y,
                            l.dir_z, l.time,  l.tfar,  l.mask,  l.id,    l.flags};
    for (unsigned k = 0; k < kStream; ++k)
        fill(l, k, rays, 0);
    for (std::size_t i = first; i < last; i += kStream) {
        const auto count = static_cast<unsigned>(std::min<std::size_t>(kStream, last - i));
        for (unsigned k = 0; k < count; ++k) {
            const Vec3 origin = rays.origins[i + k];
            l.org_x[k] = origin.x;
            l.org_y[k] = origin.y;
            l.org_z[k] = origin.z;
            l.tfar[k] = std::numeric_limits<float>::infinity();
        }
        rtcOccludedNp(scene, &context, &pointers, count);
        for (unsigned k = 0; k < count; ++k)
            blocked[i + k] = l.tfar[k] < 0.0f;
    }
}

void loop_packet_stream(RTCScene scene, RTCIntersectContext& context, const Rays& rays,
                        std::size_t first, std::size_t last, Blocked& blocked) {
    constexpr unsigned kPackets = 16;
    constexpr unsigned kStream = 16 * kPackets;
    std::array<RTCRay16, kPackets> packets;
    for (std::size_t i = first; i < last; i += kStream) {
        for (unsigned k = 0; k < kStream; ++k) {
            fill(packets[k / 16], k % 16, rays, i + k);
            if (i + k >= last) packets[k / 16].tfar[k % 16] = -1.0f;
        }
        rtcOccludedNM(scene, &context, reinterpret_cast<RTCRayN*>(packets.data()), 16, kPackets,
                      sizeof(RTCRay16));
        for (unsigned k = 0; k < kStream && i + k < last; ++k) {
            blocked[i + k] = packets[k / 16].tfar[k % 16] < 0.0f;
        }
    }
}

struct Contestant {
    std::string name;
    std::function<double()> run;  ///< returns the fraction of rays that are blocked
    std::vector<double> seconds;
    std::vector<double> cpu_seconds;  ///< of all threads: what other programs take is not in it
    double blocked = 0.0;
};

double fraction(const Blocked& blocked) {
    return static_cast<double>(std::ranges::count(blocked, 1)) /
           static_cast<double>(blocked.size());
}

double run_bare(const BareLoop& loop, RTCScene scene, RTCIntersectContextFlags flags,
                const Rays& rays) {
    constexpr std::size_t kRaysPerTask = 1 << 14;
    Blocked blocked(rays.size());
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, rays.size(), kRaysPerTask),
        [&](const tbb::blocked_range<std::size_t>& range) {
            RTCIntersectContext context;
            rtcInitIntersectContext(&context);
            context.flags = flags;
            loop(scene, context, rays, range.begin(), range.end(), blocked);
        },
        tbb::simple_partitioner());
    return fraction(blocked);
}

void add_bare(std::vector<Contestant>& contestants, const std::string& suffix, RTCScene scene,
              const Rays& rays) {
    const std::pair<const char*, BareLoop> loops[] = {
        {"rtcOccluded1", loop_single},
        {"rtcOccluded4", loop_packets<4, RTCRay4, rtcOccluded4>},
        {"rtcOccluded8", loop_packets<8, RTCRay8, rtcOccluded8>},
        {"rtcOccluded16", loop_packets<16, RTCRay16, rtcOccluded16>},
        {"rtcOccluded1M", loop_stream},
        {"rtcOccludedNM", loop_packet_stream},
        {"rtcOccludedNp", loop_lane_stream},
    };
    const std::pair<const char*, RTCIntersectContextFlags> all_flags[] = {
        {"", RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT},
        {" coherent", RTC_INTERSECT_CONTEXT_FLAG_COHERENT},
    };
    for (const auto& [name, loop] : loops) {
        for (const auto& [flags_name, flags] : all_flags) {
            contestants.push_back({std::string(name) + flags_name + suffix,
                                   [=, &rays] { return run_bare(loop, scene, flags, rays); },
                                   {},
                                   {},
                                   0.0});
        }
    }
}

void compete(std::vector<Contestant>& contestants, std::size_t rays, int threads, int rounds) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    for (Contestant& contestant : contestants) {
        contestant.seconds.clear();
        contestant.cpu_seconds.clear();
    }
    for (int round = 0; round < rounds; ++round) {
        for (Contestant& contestant : contestants) {
            const auto start = Clock::now();
            const std::clock_t cpu_start = std::clock();
            contestant.blocked = contestant.run();
            contestant.seconds.push_back(
                std::chrono::duration<double>(Clock::now() - start).count());
            contestant.cpu_seconds.push_back(static_cast<double>(std::clock() - cpu_start) /
                                             CLOCKS_PER_SEC);
        }
    }
    std::fflush(stdout);
    fmt::print("\n{} thread(s), {} rays, median of {} rounds\n", threads, rays, rounds);
    for (const Contestant& contestant : contestants) {
        const auto mega_rays_per = [&](const std::vector<double>& seconds) {
            return 1e-6 * static_cast<double>(rays) / median(seconds);
        };
        fmt::print("{:38} {:7.2f} Mrays/s {:7.2f} Mrays/CPU s {:8.3f} % blocked\n", contestant.name,
                   mega_rays_per(contestant.seconds), mega_rays_per(contestant.cpu_seconds),
                   100.0 * contestant.blocked);
    }
    std::fflush(stdout);
}

int run(int argc, char** argv) {
    const Scene scene = argc > 1 && argv[1][0] != 0 ? load_scene(argv[1]) : field();
    const Extent size = argc > 3 ? Extent{static_cast<unsigned>(std::atoi(argv[2])),
                                          static_cast<unsigned>(std::atoi(argv[3]))}
                                 : Extent{1920, 1080};
    const int rounds = argc > 4 ? std::atoi(argv[4]) : 5;
    DirectionalLight light = sun(radians(35.0f), radians(120.0f), 0.0f);
    for (const Light& candidate : scene.lights()) {
        if (const auto* found = std::get_if<DirectionalLight>(&candidate)) light = *found;
    }
    light.angular_diameter_rad = 0.0f;

    Progress progress;
    const trace::Tracer tracer(scene, true, progress);
    const Camera& camera = scene.cameras().at(0);
    const std::vector<Receiver> receivers =
        tracer.receivers(camera, size, tracer.visible_surfaces(camera, size, progress));
    const Rays rays = bare_rays(receivers, size, light);
    const BareScene fast(scene, RTC_SCENE_FLAG_NONE, false);
    const BareScene fast_flat(scene, RTC_SCENE_FLAG_NONE, true);
    const BareScene robust_flat(scene, RTC_SCENE_FLAG_ROBUST, true);
    std::vector<float> visibility(receivers.size());

    std::vector<Contestant> contestants;
    double blocked = 0.0;
    const auto visibility_run = [&] {
        tracer.visibility(receivers, size, light, 1, 1, visibility, progress);
        return blocked;  // counted once, outside the time
    };
    visibility_run();
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        if (visibility[i] == 0.0f && trace::faces_light(receivers[i], light)) ++blocked;
    }
    blocked /= static_cast<double>(rays.size());
    contestants.push_back({kOurs, visibility_run, {}, {}, 0.0});
    add_bare(contestants, "", fast.top, rays);
    add_bare(contestants, ", flat", fast_flat.top, rays);
    add_bare(contestants, ", flat, robust", robust_flat.top, rays);
    if (argc > 5) {
        std::erase_if(contestants, [&](const Contestant& contestant) {
            return contestant.name != kOurs && contestant.name.find(argv[5]) == std::string::npos;
        });
    }
    for (const int threads : {1, 2}) {
        compete(contestants, rays.size(), threads, rounds);
    }
    return 0;
}

}  // namespace
}  // namespace gnomon

int main(int argc, char** argv) {
    return gnomon::bench_main(argc, argv, &gnomon::run);
}
