#pragma once

/// Embree's own ways to ask for shadow rays from receivers to the steps of a day.

#include <gnomon/scene.h>

#include "trace/receiver.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace gnomon::bake_embree {

/// The scene's triangles as one mesh.
class Triangles {
public:
    Triangles(const Mesh& mesh, const std::string& config) : device_(rtcNewDevice(config.c_str())) {
        rtcSetDeviceMemoryMonitorFunction(device_, &Triangles::count, &bytes_);
        scene_ = rtcNewScene(device_);
        rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                   mesh.positions.data(), 0, sizeof(Vec3), mesh.positions.size());
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   mesh.triangles.data(), 0, sizeof(UVec3), mesh.triangles.size());
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }
    ~Triangles() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    Triangles(const Triangles&) = delete;
    Triangles& operator=(const Triangles&) = delete;

    RTCScene scene() const { return scene_; }
    std::int64_t bytes() const { return bytes_; }

private:
    static bool count(void* bytes, ssize_t change, bool) {
        *static_cast<std::int64_t*>(bytes) += change;
        return true;
    }

    RTCDevice device_;
    RTCScene scene_ = nullptr;
    std::int64_t bytes_ = 0;
};

/// What is asked, and the answers: bit k % 64 of word k / 64 of a receiver is lit at step k.
struct Question {
    std::span<const trace::Receiver> receivers;
    std::span<const Vec3> to_sun_ws;
    std::span<std::uint64_t> masks;

    std::size_t words() const { return (to_sun_ws.size() + 63) / 64; }
    bool faces(std::size_t receiver, std::size_t step) const {
        return glm::dot(receivers[receiver].normal_ws, to_sun_ws[step]) > 0.0f;
    }
    void set_lit(std::size_t receiver, std::size_t step) const {
        masks[receiver * words() + step / 64] |= std::uint64_t{1} << (step % 64);
    }
};

inline RTCRay single_ray(const Question& question, std::size_t receiver, std::size_t step) {
    const Vec3 o = trace::lifted_position_ws(question.receivers[receiver]);
    const Vec3 d = question.to_sun_ws[step];
    return {o.x, o.y, o.z, 0.0f, d.x, d.y, d.z, 0.0f, std::numeric_limits<float>::infinity(),
            ~0u, 0,   0};
}

template <typename Packet>
void fill(Packet& packet, unsigned lane, const RTCRay& ray) {
    packet.org_x[lane] = ray.org_x;
    packet.org_y[lane] = ray.org_y;
    packet.org_z[lane] = ray.org_z;
    packet.dir_x[lane] = ray.dir_x;
    packet.dir_y[lane] = ray.dir_y;
    packet.dir_z[lane] = ray.dir_z;
    packet.tnear[lane] = ray.tnear;
    packet.tfar[lane] = ray.tfar;
    packet.time[lane] = 0.0f;
    packet.mask[lane] = ray.mask;
    packet.id[lane] = ray.id;
    packet.flags[lane] = 0;
}

inline void singly(RTCScene scene, RTCIntersectContext& context, const Question& question) {
    for (std::size_t i = 0; i < question.receivers.size(); ++i) {
        for (std::size_t k = 0; k < question.to_sun_ws.size(); ++k) {
            if (!question.faces(i, k)) continue;
            RTCRay ray = single_ray(question, i, k);
            rtcOccluded1(scene, &context, &ray);
            if (ray.tfar >= 0.0f) question.set_lit(i, k);
        }
    }
}

/// 16 rays: of 16 receivers at one step, or of one receiver at 16 steps.
template <bool kReceivers>
void in_packets(RTCScene scene, RTCIntersectContext& context, const Question& question) {
    const std::size_t outer = kReceivers ? question.to_sun_ws.size() : question.receivers.size();
    const std::size_t inner = kReceivers ? question.receivers.size() : question.to_sun_ws.size();
    const auto receiver_of = [](std::size_t a, std::size_t b) { return kReceivers ? b : a; };
    const auto step_of = [](std::size_t a, std::size_t b) { return kReceivers ? a : b; };
    alignas(64) int valid[16];
    RTCRay16 packet;
    for (std::size_t a = 0; a < outer; ++a) {
        for (std::size_t first = 0; first < inner; first += 16) {
            bool any = false;
            for (unsigned lane = 0; lane < 16; ++lane) {
                const std::size_t b = std::min(first + lane, inner - 1);
                const bool asked =
                    first + lane < inner && question.faces(receiver_of(a, b), step_of(a, b));
                valid[lane] = asked ? -1 : 0;
                any |= asked;
                fill(packet, lane, single_ray(question, receiver_of(a, b), step_of(a, b)));
            }
            if (!any) continue;
            rtcOccluded16(valid, scene, &context, &packet);
            for (unsigned lane = 0; lane < 16; ++lane) {
                if (valid[lane] == 0 || packet.tfar[lane] < 0.0f) continue;
                question.set_lit(receiver_of(a, first + lane), step_of(a, first + lane));
            }
        }
    }
}

inline void step_streams(RTCScene scene, RTCIntersectContext& context, const Question& question) {
    std::vector<RTCRay> rays;
    for (std::size_t i = 0; i < question.receivers.size(); ++i) {
        rays.clear();
        for (std::size_t k = 0; k < question.to_sun_ws.size(); ++k) {
            if (!question.faces(i, k)) continue;
            rays.push_back(single_ray(question, i, k));
            rays.back().id = static_cast<unsigned>(k);
        }
        rtcOccluded1M(scene, &context, rays.data(), static_cast<unsigned>(rays.size()),
                      sizeof(RTCRay));
        for (const RTCRay& ray : rays) {
            if (ray.tfar >= 0.0f) question.set_lit(i, ray.id);
        }
    }
}

/// All receivers of the question, at most 1024, at one step.
inline void receiver_streams(RTCScene scene, RTCIntersectContext& context,
                             const Question& question) {
    // Not a power of two: lanes 4 KiB apart take each other's place in the cache.
    constexpr unsigned kStride = 1024 + 32;
    struct Lanes {
        float org_x[kStride], org_y[kStride], org_z[kStride], tnear[kStride];
        float dir_x[kStride], dir_y[kStride], dir_z[kStride], time[kStride], tfar[kStride];
        unsigned mask[kStride], id[kStride], flags[kStride];
    };
    alignas(64) Lanes l;
    const RTCRayNp pointers{l.org_x, l.org_y, l.org_z, l.tnear, l.dir_x, l.dir_y,
                            l.dir_z, l.time,  l.tfar,  l.mask,  l.id,    l.flags};
    for (std::size_t k = 0; k < question.to_sun_ws.size(); ++k) {
        unsigned count = 0;
        for (std::size_t i = 0; i < question.receivers.size(); ++i) {
            if (!question.faces(i, k)) continue;
            RTCRay ray = single_ray(question, i, k);
            ray.id = static_cast<unsigned>(i);
            fill(l, count++, ray);
        }
        if (count == 0) continue;
        rtcOccludedNp(scene, &context, &pointers, count);
        for (unsigned lane = 0; lane < count; ++lane) {
            if (l.tfar[lane] >= 0.0f) question.set_lit(l.id[lane], k);
        }
    }
}

struct Way {
    std::string name;
    std::function<void(RTCScene, RTCIntersectContext&, const Question&)> ask;
    RTCIntersectContextFlags flags;
};

/// All that are worth a try: those of 1 and 16 rays, and streams, coherent or not.
inline std::vector<Way> ways() {
    constexpr auto kNone = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    constexpr auto kCoherent = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    return {{"rtcOccluded1", singly, kNone},
            {"rtcOccluded16, 16 steps", in_packets<false>, kCoherent},
            {"rtcOccluded16, 16 texels", in_packets<true>, kCoherent},
            {"rtcOccluded1M, all steps", step_streams, kNone},
            {"rtcOccluded1M, all steps, coherent", step_streams, kCoherent},
            {"rtcOccludedNp, 1024 texels", receiver_streams, kNone},
            {"rtcOccludedNp, 1024 texels, coherent", receiver_streams, kCoherent}};
}

}  // namespace gnomon::bake_embree
