// What the texts that techniques follow claim of them, measured here, a table each:
//
//     published_claims [taps|perspective|splits|cube]...
//
// taps: 4 dithered taps beside 16 (GPU Gems 2004, chapter 11). perspective: perspective maps beside
// uniform ones, near and far, under suns overhead and head-on, unit-cube clipping on and off
// (chapter 14), and LiSPSM and TSM. splits: the article's table of parallel splits, maps and times.
// cube: what a lamp's map costs by its content (chapter 12), and what two paraboloids cost.

#include <gnomon/gnomon.h>

#include "bench_main.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gnomon {
namespace {

constexpr Extent kSmall{640, 360};
constexpr Extent kLarge{1920, 1080};
constexpr int kTruthSamples = 64;
constexpr int kRounds = 9;

Frame frame_of(const Scene& scene, const Light& light, Extent size) {
    return {.scene = scene, .camera = scene.cameras().at(0), .light = light, .size = size};
}

struct Contestant {
    std::string label, technique;
    Params params;
    std::unique_ptr<Technique> made;
    std::vector<double> total_ms, lookup_ms;
};

/// Contestants take turns; what they made of the frame is judged by `told`.
void race(Context& context, const Frame& frame, std::vector<Contestant>& all,
          const std::function<void(const Contestant&, const Visibility&)>& told) {
    for (Contestant& contestant : all)
        contestant.made = make_technique(context, contestant.technique, contestant.params);
    for (int round = 0; round <= kRounds; ++round) {
        for (Contestant& contestant : all) {
            const Visibility visibility = contestant.made->render(frame);
            const RenderStats stats = contestant.made->last_render();
            if (round == 0) continue;  // pipelines are made
            contestant.total_ms.push_back(stats.cpu_ms + stats.gpu_ms);
            for (const PassTime& pass : stats.passes) {
                if (pass.name == "lookup") contestant.lookup_ms.push_back(pass.ms);
            }
            if (round == kRounds) told(contestant, visibility);
        }
    }
}

void taps(Context& context) {
    fmt::print("4 dithered taps beside 16\n");
    for (const char* name : {"courtyard", "gas-station", "field-small", "field-large"}) {
        const Scene scene = load_scene(name);
        const Frame frame = frame_of(scene, scene.lights().at(0), kLarge);
        const Visibility truth = trace_visibility(context, frame, {.samples = 16});
        const ComparisonMask mask = comparison_mask(context, frame);
        std::vector<Contestant> all;
        for (const char* filter : {"taps_16", "dithered_4", "box_4x4"})
            all.push_back({filter, "shadow_map", {{"filter", filter}}, {}, {}, {}});
        race(context, frame, all, [&](const Contestant& c, const Visibility& visibility) {
            fmt::print("{:12} {:10} RMSE {:.4f}  lookup {:6.1f} ms\n", name, c.label,
                       compare(visibility, truth, mask).rmse, median(c.lookup_ms));
        });
    }
}

/// Root mean square errors of the nearer and the farther half of the receivers that are judged.
std::pair<double, double> near_and_far(const Visibility& visibility, const Visibility& truth,
                                       const ComparisonMask& mask) {
    std::vector<std::pair<float, double>> errors;  // a pixel's size grows with the distance
    for (unsigned y = 0; y < mask.facing.height(); ++y) {
        for (unsigned x = 0; x < mask.facing.width(); ++x) {
            if (mask.facing.at(x, y) == 0.0f) continue;
            const double error =
                static_cast<double>(visibility.image().at(x, y) - truth.image().at(x, y));
            errors.emplace_back(mask.pixel_size_m.at(x, y), error * error);
        }
    }
    std::ranges::sort(errors);
    double sums[2] = {};
    for (std::size_t i = 0; i < errors.size(); ++i)
        sums[2 * i >= errors.size() ? 1 : 0] += errors[i].second;
    const double half = 0.5 * static_cast<double>(errors.size());
    return {std::sqrt(sums[0] / half), std::sqrt(sums[1] / half)};
}

void perspective(Context& context) {
    fmt::print(
        "perspective maps beside uniform ones: RMSE of the nearer half, of the farther half\n");
    const Scene scene = load_scene("field-small");
    const Vec3 view = -Vec3(glm::inverse(scene.cameras().at(0).view_from_world)[2]);
    const float ahead_rad = std::atan2(view.x, -view.z);
    const std::vector<std::pair<std::string, Light>> suns{
        {"overhead", sun(radians(85.0f), ahead_rad)},
        {"behind", sun(radians(30.0f), ahead_rad + kPi)},
        {"beside", sun(radians(30.0f), ahead_rad + 0.5f * kPi)},
        {"ahead", sun(radians(30.0f), ahead_rad)},
        {"head-on", sun(radians(10.0f), ahead_rad)}};
    for (const auto& [where, light] : suns) {
        const Frame frame = frame_of(scene, light, kSmall);
        const Visibility truth = trace_visibility(context, frame, {.samples = kTruthSamples});
        const ComparisonMask mask = comparison_mask(context, frame);
        for (const auto& [label, technique, params] :
             std::vector<std::tuple<std::string, std::string, Params>>{
                 {"uniform", "shadow_map", {}},
                 {"psm, whole cube", "psm", {{"unit_cube_clipping", false}}},
                 {"psm, slide back", "psm", {{"virtual_camera", "slide_back"}}},
                 {"psm, no slide", "psm", {{"virtual_camera", "none"}}},
                 {"psm", "psm", {}},
                 {"psm, cube", "psm", {{"map", "cube"}}},
                 {"lispsm", "lispsm", {}},
                 {"tsm", "tsm", {}}}) {
            const Visibility visibility = make_technique(context, technique, params)->render(frame);
            const auto [near, far] = near_and_far(visibility, truth, mask);
            fmt::print("{:9} {:16} {:.4f} {:.4f}\n", where, label, near, far);
        }
    }
}

void splits(Context& context) {
    fmt::print("parallel splits: ms, and the ratio to no shadows\n");
    for (const char* name : {"field-small", "field-large"}) {
        const Scene scene = load_scene(name);
        const Frame frame = frame_of(scene, scene.lights().at(0), kLarge);
        const Visibility truth = trace_visibility(context, frame, {.samples = 16});
        const ComparisonMask mask = comparison_mask(context, frame);
        std::vector<Contestant> all;
        all.push_back({"no shadows", "local_illumination", {}, {}, {}, {}});
        for (const int count : {2, 3, 4}) {
            for (const int size : {1024, 2048, 4096}) {
                all.push_back({fmt::format("{} x {}", count, size),
                               "pssm",
                               {{"splits", count}, {"map_size", size}},
                               {},
                               {},
                               {}});
            }
        }
        double none_ms = 0.0;
        race(context, frame, all, [&](const Contestant& c, const Visibility& visibility) {
            const double ms = median(c.total_ms);
            if (none_ms == 0.0) none_ms = ms;
            fmt::print("{:12} {:10} {:7.1f} ms {:6.1f}  RMSE {:.4f}\n", name, c.label, ms,
                       ms / none_ms, compare(visibility, truth, mask).rmse);
        });
    }
}

void cube(Context& context) {
    fmt::print("a lamp's map by its content: memory, ms\n");
    const Scene scene = load_scene("torches");
    const Frame frame = frame_of(scene, scene.lights().at(0), kLarge);
    const Visibility truth = trace_visibility(context, frame);
    const ComparisonMask mask = comparison_mask(context, frame);
    std::vector<Contestant> all;
    for (const char* content : {"depth", "distance", "packed", "packed_two", "variance"})
        all.push_back({content, "omni", {{"content", content}}, {}, {}, {}});
    all.push_back({"depth, tetrahedron", "omni", {{"projection", "tetrahedral"}}, {}, {}, {}});
    all.push_back(
        {"depth, disc of 4", "omni", {{"filter", "disc"}, {"filter_taps", 4}}, {}, {}, {}});
    all.push_back({"depth, disc of 16", "omni", {{"filter", "disc"}}, {}, {}, {}});
    all.push_back({"paraboloids, 1024", "dual_paraboloid", {{"map_size", 1024}}, {}, {}, {}});
    all.push_back({"paraboloids, 2048", "dual_paraboloid", {}, {}, {}, {}});
    all.push_back({"not subdivided", "dual_paraboloid", {{"subdivide", false}}, {}, {}, {}});
    race(context, frame, all, [&](const Contestant& c, const Visibility& visibility) {
        const double mib = static_cast<double>(c.made->last_render().memory_bytes) / (1 << 20);
        fmt::print("{:18} {:5.0f} MiB {:6.1f} ms  RMSE {:.4f}\n", c.label, mib, median(c.total_ms),
                   compare(visibility, truth, mask).rmse);
    });
}

int run(int argc, char** argv) {
    const std::vector<std::pair<std::string, void (*)(Context&)>> tables{
        {"taps", &taps}, {"perspective", &perspective}, {"splits", &splits}, {"cube", &cube}};
    Context context;
    for (int i = 1; i < argc; ++i) {
        const std::string wanted = argv[i];
        if (std::ranges::none_of(tables, [&](const auto& t) { return t.first == wanted; })) {
            fmt::print(stderr,
                       "error: no table \"{}\"; there are taps, perspective, splits, cube\n",
                       wanted);
            return 2;
        }
    }
    for (const auto& [name, print] : tables) {
        const bool wanted = argc == 1 || std::find(argv + 1, argv + argc, name) != argv + argc;
        if (wanted) print(context);
    }
    return 0;
}

}  // namespace
}  // namespace gnomon

int main(int argc, char** argv) {
    return gnomon::bench_main(argc, argv, &gnomon::run);
}
