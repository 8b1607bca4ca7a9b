// Where a day of the interval traversal differs from a ray for each texel and step, and why.
//
//     bake_agreement [NAME=VALUE...] SCENE...
//
//     texels=30000          about so many of each scene's light map, 1000 to 1000000
//     steps=256             of 21 June, 48 degrees north, sunrise to sunset, 16 to 1024
//
// The rays are Embree's single ones, robust, from the same lifted points; its filter leaves out the
// texel's own triangle and the holes of masks, and nothing else. Of the samples that differ, those
// whose ray only touches what it hits are told apart: all of the library lets such rays pass. Each
// other is looked into in double, with the triangle that one side found and the other did not.
// Those that differ from the library's own rays, as `gnomon bake --method rays` asks them, which
// only touch nothing either, are counted besides.

#include <gnomon/scene.h>
#include <gnomon/sun.h>

#include "bake/ray_steps.h"
#include "bake/texel_receivers.h"
#include "base/check.h"
#include "base/parallel.h"
#include "bench_main.h"
#include "interval/bake.h"
#include "interval/exact.h"
#include "lightmap/atlas.h"
#include "lightmap/texels.h"
#include "trace/alpha.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gnomon {
namespace {

using interval::DayMasks;
using trace::Receiver;
using trace::SurfaceId;

/// Whether triangles are in the way that a ray only touches (trace::touches_only).
enum class Touching { counts, is_left_out };

/// The scene's triangles in the world, and the surface of each.
class Rays {
public:
    explicit Rays(const Scene& scene) : scene_(scene), device_(rtcNewDevice(nullptr)) {
        for (std::uint32_t i = 0; i < scene.instances().size(); ++i) {
            const Mesh& mesh = scene.meshes()[scene.instances()[i].mesh];
            for (std::uint32_t p = 0; p < mesh.triangles.size(); ++p)
                add({i, p});
        }
        corners_.emplace_back(0.0f);  // Embree reads 16 bytes of the last corner
        embree_ = rtcNewScene(device_);
        rtcSetSceneFlags(embree_, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                   corners_.data(), 0, sizeof(Vec3), corners_.size() - 1);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   indices_.data(), 0, sizeof(UVec3), indices_.size());
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(embree_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(embree_);
    }
    ~Rays() {
        rtcReleaseScene(embree_);
        rtcReleaseDevice(device_);
    }
    Rays(const Rays&) = delete;
    Rays& operator=(const Rays&) = delete;

    const Scene& scene() const { return scene_; }
    const std::vector<SurfaceId>& surfaces() const { return surfaces_; }

    bool blocked(const Receiver& receiver, Vec3 to_sun,
                 Touching touching = Touching::counts) const {
        Query query(*this, {&receiver, to_sun, true}, touching);
        RTCRay ray = ray_of(receiver, to_sun);
        rtcOccluded1(embree_, &query.context, &ray);
        return ray.tfar < 0.0f;
    }
    /// What is nearest and not only touched; none when that ray finds nothing, as near edges it can
    /// be.
    std::optional<SurfaceId> blocker(const Receiver& receiver, Vec3 to_sun) const {
        Query query(*this, {&receiver, to_sun, true}, Touching::is_left_out);
        RTCRayHit hit{ray_of(receiver, to_sun), {}};
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(embree_, &query.context, &hit);
        if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
        return surfaces_[hit.hit.primID];
    }

private:
    struct Query {
        RTCIntersectContext context;
        const Rays& rays;
        trace::ShadowRay ray;
        Touching touching;

        Query(const Rays& of, const trace::ShadowRay& asked, Touching as)
            : rays(of), ray(asked), touching(as) {
            rtcInitIntersectContext(&context);
            context.filter = &Query::leave_out;
        }
        bool counts(SurfaceId id, float u, float v) const {
            const Scene& scene = rays.scene_;
            const Mesh& mesh = scene.meshes()[scene.instances()[id.instance].mesh];
            if (id == ray.receiver->id || trace::is_hole(scene, mesh, id.primitive, u, v)) {
                return false;
            }
            return touching == Touching::counts ||
                   !trace::touches_only(scene, trace::world_triangle(scene, id), ray);
        }
        static void leave_out(const RTCFilterFunctionNArguments* arguments) {
            const auto& query = *reinterpret_cast<const Query*>(arguments->context);
            const SurfaceId id =
                query.rays.surfaces_[RTCHitN_primID(arguments->hit, arguments->N, 0)];
            if (!query.counts(id, RTCHitN_u(arguments->hit, arguments->N, 0),
                              RTCHitN_v(arguments->hit, arguments->N, 0))) {
                arguments->valid[0] = 0;
            }
        }
    };

    void add(SurfaceId id) {
        const auto first = static_cast<std::uint32_t>(corners_.size());
        for (const DVec3& corner : trace::world_triangle(scene_, id).corners_ws)
            corners_.emplace_back(corner);
        indices_.emplace_back(first, first + 1, first + 2);
        surfaces_.push_back(id);
    }
    static RTCRay ray_of(const Receiver& receiver, Vec3 d) {
        const Vec3 o = trace::lifted_position_ws(receiver);
        return {o.x, o.y, o.z, 0.0f, d.x, d.y, d.z, 0.0f, std::numeric_limits<float>::infinity(),
                ~0u, 0,   0};
    }

    const Scene& scene_;
    RTCDevice device_;
    RTCScene embree_ = nullptr;
    std::vector<Vec3> corners_;
    std::vector<UVec3> indices_;
    std::vector<SurfaceId> surfaces_;
};

/// A ray and a triangle, in double.
struct Hit {
    double u, v, w;     ///< barycentric
    double distance_m;  ///< along the ray, of length 1
    double slope;       ///< cosine between the ray and the triangle's normal
    double edge_m;      ///< from the nearest edge, less than 0 outside
};

Hit hit_of(const trace::Triangle& triangle, const Receiver& receiver, DVec3 d) {
    const auto& c = triangle.corners_ws;
    const DVec3 a = c[1] - c[0], b = c[2] - c[0];
    const DVec3 normal = glm::cross(a, b);
    const double det = -glm::dot(d, normal);
    const DVec3 offset = DVec3(trace::lifted_position_ws(receiver)) - c[0];
    Hit hit{};
    hit.u = glm::dot(d, glm::cross(b, offset)) / det;
    hit.v = glm::dot(d, glm::cross(offset, a)) / det;
    hit.w = 1.0 - hit.u - hit.v;
    hit.distance_m = glm::dot(offset, normal) / det;
    const double area2 = glm::length(normal);
    hit.slope = std::abs(det) / area2;
    // A barycentric coordinate times its height is the distance from that edge.
    hit.edge_m = std::min({hit.u * area2 / glm::length(b), hit.v * area2 / glm::length(a),
                           hit.w * area2 / glm::length(b - a)});
    return hit;
}

/// Why a triangle counts for one side only, the likelier first.
std::string kind_of(const Scene& scene, SurfaceId id, const Receiver& receiver, DVec3 to_sun) {
    constexpr double kGrazing = 1e-3;     // of a right angle's sine: a twentieth of a degree
    constexpr double kMaskTexels = 1e-3;  // of the triangle: alpha within is not the same
    const trace::Triangle triangle = trace::world_triangle(scene, id);
    const Hit hit = hit_of(triangle, receiver, to_sun);
    const double reach_m = hit.distance_m + glm::length(DVec3(receiver.position_ws)) +
                           glm::length(triangle.corners_ws[0]);
    // Float places a point of the ray to some roundings of all that it is computed from.
    const double float_m = 16.0 * trace::kUnitRoundoff * reach_m / std::max(hit.slope, 1e-9);
    if (std::abs(hit.distance_m) <= float_m) return "from the triangle's own plane";
    if (std::abs(hit.edge_m) <= float_m) {
        return hit.slope < kGrazing ? "through an edge, grazing" : "through an edge";
    }
    const Mesh& mesh = scene.meshes()[scene.instances()[id.instance].mesh];
    if (scene.materials()[mesh.material].masked()) {
        const auto hole = [&](double u, double v) {
            return trace::is_hole(scene, mesh, id.primitive, static_cast<float>(u),
                                  static_cast<float>(v));
        };
        const bool here = hole(hit.u, hit.v);
        for (const auto& [du, dv] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
            if (hole(hit.u + kMaskTexels * du, hit.v + kMaskTexels * dv) != here)
                return "at the edge of a mask's hole";
        }
    }
    if (hit.slope < kGrazing) return "grazing";
    return "unexplained";
}

struct Sample {
    std::size_t texel;
    int step;
    bool ray_blocked;
};

const std::string kTouching = "rays alone: the texel lies on all that they hit";

std::string explain(const Rays& rays, const std::vector<Receiver>& receivers,
                    const interval::DayPath& path, const Sample& sample) {
    const Receiver& receiver = receivers[sample.texel];
    const DVec3 to_sun = path.to_sun_ws()[static_cast<std::size_t>(sample.step)];
    if (sample.ray_blocked) {
        if (!rays.blocked(receiver, Vec3(to_sun), Touching::is_left_out)) return kTouching;
        const auto id = rays.blocker(receiver, Vec3(to_sun));
        if (!id) return "Embree's two calls differ";
        return "rays alone: " + kind_of(rays.scene(), *id, receiver, to_sun);
    }
    for (const SurfaceId id : rays.surfaces()) {
        if (interval::blocks(rays.scene(), false, id, receiver, to_sun))
            return "traversal alone: " + kind_of(rays.scene(), id, receiver, to_sun);
    }
    return "traversal alone: unexplained";
}

double texel_size_m(const Scene& scene, int texels) {
    double area_m2 = 0.0;
    for (std::uint32_t i = 0; i < scene.instances().size(); ++i) {
        const Mesh& mesh = scene.meshes()[scene.instances()[i].mesh];
        for (std::uint32_t p = 0; p < mesh.triangles.size(); ++p)
            area_m2 += 0.5 * glm::length(trace::world_triangle(scene, {i, p}).front_normal_ws());
    }
    return std::sqrt(2.0 * area_m2 / texels);  // both sides
}

std::vector<DVec3> day(int steps, DVec3& pole_ws) {
    using namespace std::chrono;
    SunPathOptions options;
    options.steps = steps;
    const SunPath sun = sun_path({48.0, 11.0, 0.0}, 2026y / June / 21, hours(1), options);
    pole_ws = sun.pole_ws;
    std::vector<DVec3> to_sun;
    for (const SunStep& step : sun.steps)
        to_sun.push_back(step.to_sun_ws);
    return to_sun;
}

/// What was asked, and where the answers differ.
struct Differences {
    std::uint64_t rays = 0;
    std::vector<Sample> samples;
};

Differences differences(const Rays& rays, const std::vector<Receiver>& receivers,
                        const interval::DayPath& path, const DayMasks& masks) {
    constexpr std::size_t kGrain = 64;
    std::vector<Differences> parts(receivers.size() / kGrain + 1);
    parallel_for(receivers.size(), kGrain, [&](std::size_t first, std::size_t last) {
        Differences& part = parts[first / kGrain];
        for (std::size_t i = first; i < last; ++i) {
            for (int k = 0; k < path.steps(); ++k) {
                const DVec3 d = path.to_sun_ws()[static_cast<std::size_t>(k)];
                if (!(glm::dot(DVec3(receivers[i].normal_ws), d) > 0.0)) continue;
                ++part.rays;
                const bool blocked = rays.blocked(receivers[i], Vec3(d));
                if (blocked == interval::is_lit(masks.mask(i), k))
                    part.samples.push_back({i, k, blocked});
            }
        }
    });
    Differences all;
    for (const Differences& part : parts) {
        all.rays += part.rays;
        all.samples.insert(all.samples.end(), part.samples.begin(), part.samples.end());
    }
    return all;
}

/// Samples at which the library's own rays say something else.
std::uint64_t other_by_rays(const Scene& scene, const std::vector<Receiver>& receivers,
                            const interval::DayPath& path, const DayMasks& masks) {
    constexpr std::size_t kGrain = 512;
    Progress silent;
    const trace::Tracer tracer(scene, false, silent);
    std::vector<std::uint64_t> traced(masks.words.size());
    const std::size_t words = masks.words_per_mask();
    parallel_for(receivers.size(), kGrain, [&](std::size_t first, std::size_t last) {
        bake::ray_masks(tracer, path.to_sun_ws(), std::span(receivers).subspan(first, last - first),
                        std::span(traced).subspan(first * words, (last - first) * words));
    });
    std::uint64_t others = 0;
    for (std::size_t i = 0; i < traced.size(); ++i)
        others += static_cast<std::uint64_t>(std::popcount(traced[i] ^ masks.words[i]));
    return others;
}

void compare(const std::string& name, int texels, int steps) {
    Progress silent;
    const Scene scene = load_scene(name);
    const lightmap::Atlas atlas =
        lightmap::make_atlas(scene, {.texel_size_m = texel_size_m(scene, texels)}, silent);
    const std::vector<Receiver> receivers =
        bake::texel_receivers(atlas, lightmap::make_texels(scene, atlas, silent));
    DVec3 pole_ws;
    const std::vector<DVec3> to_sun = day(steps, pole_ws);
    const interval::Frame frame = interval::frame_around(pole_ws);
    const interval::DayPath path(to_sun, frame);
    const interval::Tree tree(scene, frame, false, silent);
    const DayMasks masks = interval::bake(tree, path, receivers, silent);
    const Rays rays(scene);
    const Differences differing = differences(rays, receivers, path, masks);
    std::map<std::string, std::size_t> kinds;
    for (const Sample& sample : differing.samples)
        ++kinds[explain(rays, receivers, path, sample)];
    const std::size_t differ = differing.samples.size() - kinds[kTouching];
    fmt::print(
        "{}: {} triangles, {} texels x {} steps, {} rays; {} differ, {:.2g}, and {} touch; from "
        "--method rays {} differ\n",
        name, scene.triangle_count(), receivers.size(), path.steps(), differing.rays, differ,
        static_cast<double>(differ) / static_cast<double>(differing.rays), kinds[kTouching],
        other_by_rays(scene, receivers, path, masks));
    for (const auto& [kind, samples] : kinds)
        fmt::print("  {:6} {}\n", samples, kind);
    std::fflush(stdout);
}

struct Options {
    int texels = 30'000, steps = 256;
    std::vector<std::string> scenes;
};

int number(const std::string& name, const std::string& text, int least, int most) {
    int value = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stop != end || value < least || value > most) {
        fail_input("{}: {} is no whole number of {} to {}", name, text, least, most);
    }
    return value;
}

Options options_of(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        const std::size_t equals = argument.find('=');
        if (equals == std::string::npos) {
            options.scenes.push_back(argument);
            continue;
        }
        const std::string name = argument.substr(0, equals), value = argument.substr(equals + 1);
        if (name == "texels") {
            options.texels = number(name, value, 1'000, 1'000'000);
        } else if (name == "steps") {
            options.steps = number(name, value, 16, interval::DayPath::kMaxSteps);
        } else {
            fail_input("{}: options are texels=N and steps=N", argument);
        }
    }
    if (options.scenes.empty()) fail_input("scenes: none given; bake_agreement SCENE...");
    return options;
}

int run(int argc, char** argv) {
    const Options options = options_of(argc, argv);
    for (const std::string& scene : options.scenes)
        compare(scene, options.texels, options.steps);
    return 0;
}

}  // namespace
}  // namespace gnomon

int main(int argc, char** argv) {
    return gnomon::bench_main(argc, argv, &gnomon::run);
}
