// A day of sun baked by the interval traversal, beside the same rays by Embree's own calls.
//
//     bake [NAME=VALUE...]
//
//     scene=courtyard|city|forest|FILE   default all three
//     declination=DEGREES   of the sun; default 23.44 and -23.44
//     steps=256             of the day, 64 to 1024
//     spacing=1             of the texels, times that of the scene
//     size=1                of the scene in triangles, times 0.2, 1.4 and 1.0 million
//     patches=49            of 1024 texels each
//     threads=1
//     rounds=3              medians are printed
//     isa=best              Embree's, also sse4.2, avx2, avx512
//     simd=best             the interval traversal's, also avx2, sse4
//     embree=rtc            parts of the names of its calls to run, as 1M,Np; none: embree=-
//     tiles=1,16,32,64,0    sizes of tiles; 0 = by trial
//
// Contestants take turns in each round. With one thread the processor's time counts, which other
// programs disturb less than the wall's. Embree traces solid triangles without a filter, on which
// receivers lie a little off; the interval traversal does all that the library's tracer does.

#include "interval/bake.h"

#include <gnomon/error.h>
#include <gnomon/scene.h>

#include "bake_embree.h"
#include "bake_scenes.h"
#include "base/check.h"
#include "base/parallel.h"
#include "bench_main.h"
#include "interval/path.h"
#include "interval/tile.h"
#include "interval/tree.h"

#include <fmt/format.h>
#include <hwy/targets.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <ctime>
#include <functional>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

namespace gnomon {
namespace {

using Clock = std::chrono::steady_clock;
using trace::Receiver;

/// Of the processor if there is only one thread, else of the wall.
double seconds_of(const std::function<void()>& work, int threads) {
    const auto start = Clock::now();
    const std::clock_t processor_start = std::clock();
    work();
    if (threads == 1) {
        return static_cast<double>(std::clock() - processor_start) / double{CLOCKS_PER_SEC};
    }
    return std::chrono::duration<double>(Clock::now() - start).count();
}

class Options {
public:
    Options(int argc, char** argv) {
        for (int i = 1; i < argc; ++i) {
            const std::string argument = argv[i];
            const std::size_t equals = argument.find('=');
            if (equals == std::string::npos || !values_.contains(argument.substr(0, equals))) {
                fail_input("{}: options are NAME=VALUE; see the head of bench/bake.cpp", argument);
            }
            values_[argument.substr(0, equals)] = argument.substr(equals + 1);
        }
    }
    const std::string& text(const std::string& name) const { return values_.at(name); }
    double number(const std::string& name) const { return std::atof(text(name).c_str()); }
    int count(const std::string& name) const { return static_cast<int>(number(name)); }

private:
    std::map<std::string, std::string> values_ = {
        {"scene", ""},   {"declination", ""}, {"steps", "256"}, {"spacing", "1"},
        {"size", "1"},   {"patches", "49"},   {"threads", "1"}, {"rounds", "3"},
        {"isa", "best"}, {"embree", "rtc"},   {"simd", "best"}, {"tiles", "1,16,32,64,0"}};
};

constexpr double kLatitude_rad = 48.0 * std::numbers::pi / 180.0;

/// The day from sunrise to sunset.
std::vector<DVec3> day(const interval::Frame& frame, double declination_rad, int steps) {
    const double half =
        std::acos(std::clamp(-std::tan(kLatitude_rad) * std::tan(declination_rad), -1.0, 1.0));
    std::vector<DVec3> directions;
    for (int k = 0; k < steps; ++k) {
        const double angle = half * (2.0 * (k + 0.5) / steps - 1.0);
        directions.push_back(std::cos(declination_rad) *
                                 (std::cos(angle) * frame.x_ws - std::sin(angle) * frame.y_ws) +
                             std::sin(declination_rad) * frame.z_ws);
    }
    return directions;
}

bake_scenes::Plan plan_of(const std::string& scene, const Options& options) {
    const auto spacing = static_cast<float>(options.number("spacing"));
    const auto size = static_cast<float>(options.number("size"));
    if (scene == "courtyard") return bake_scenes::courtyard(spacing, size);
    if (scene == "city") return bake_scenes::city(spacing, size);
    if (scene == "forest") return bake_scenes::forest(spacing, size);
    fail_input("scene: {} is none of courtyard, city, forest", scene);
}

/// Some of the patches, evenly over the list.
std::vector<Receiver> chosen(const std::vector<Receiver>& all, int patches) {
    constexpr std::size_t kPatch = bake_scenes::kPatchSide * bake_scenes::kPatchSide;
    const std::size_t count = all.size() / kPatch;
    const std::size_t wanted = std::min(count, static_cast<std::size_t>(std::max(1, patches)));
    std::vector<Receiver> some;
    for (std::size_t i = 0; i < wanted; ++i) {
        const auto patch = all.begin() + static_cast<std::ptrdiff_t>(i * count / wanted * kPatch);
        some.insert(some.end(), patch, patch + kPatch);
    }
    return some;
}

struct Contestant {
    std::string name;
    bool is_embree;
    std::function<void(std::vector<std::uint64_t>&)> run;
    std::vector<double> seconds{};
    std::vector<std::uint64_t> masks{};
};

struct Stage {
    Scene scene;
    interval::Tree tree;
    bake_embree::Triangles embree;
    std::vector<Receiver> receivers;
};

/// Whether any part of a list with commas is in the name.
bool has_any(const std::string& name, const std::string& parts) {
    std::istringstream list(parts);
    for (std::string part; std::getline(list, part, ',');) {
        if (name.find(part) != std::string::npos) return true;
    }
    return false;
}

void add_embree(std::vector<Contestant>& contestants, const Stage& stage,
                const std::vector<Vec3>& to_sun, const std::string& only) {
    constexpr std::size_t kPatch = 1024;
    for (const bake_embree::Way& way : bake_embree::ways()) {
        if (!has_any(way.name, only)) continue;
        const auto run = [&stage, &to_sun, way](std::vector<std::uint64_t>& masks) {
            const std::size_t words = (to_sun.size() + 63) / 64;
            masks.assign(stage.receivers.size() * words, 0);
            parallel_for(stage.receivers.size(), kPatch, [&](std::size_t first, std::size_t last) {
                RTCIntersectContext context;
                rtcInitIntersectContext(&context);
                context.flags = way.flags;
                way.ask(stage.embree.scene(), context,
                        {std::span(stage.receivers).subspan(first, last - first), to_sun,
                         std::span(masks).subspan(first * words, (last - first) * words)});
            });
        };
        contestants.push_back({way.name, true, run});
    }
}

void add_intervals(std::vector<Contestant>& contestants, const Stage& stage,
                   const interval::DayPath& path, const std::string& tiles) {
    for (const int texels : {1, 16, 32, 64, 0}) {
        if (("," + tiles + ",").find(fmt::format(",{},", texels)) == std::string::npos) continue;
        const std::string name = texels == interval::kChooseTile
                                     ? "interval traversal, tiles by trial"
                                     : fmt::format("interval traversal, tiles of {}", texels);
        contestants.push_back(
            {name, false, [&stage, &path, texels](auto& masks) {
                 Progress progress;
                 masks = interval::bake(stage.tree, path, stage.receivers, progress, texels).words;
             }});
    }
}

std::size_t differing(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        count += static_cast<std::size_t>(std::popcount(a[i] ^ b[i]));
    return count;
}

void compete(const Stage& stage, double declination_deg, const Options& options) {
    const std::vector<DVec3> directions =
        day(stage.tree.frame(), declination_deg * std::numbers::pi / 180.0, options.count("steps"));
    const interval::DayPath path(directions, stage.tree.frame());
    std::vector<Vec3> to_sun;
    for (const DVec3& direction : path.to_sun_ws())
        to_sun.emplace_back(direction);
    std::vector<Contestant> contestants;
    add_embree(contestants, stage, to_sun, options.text("embree"));
    add_intervals(contestants, stage, path, options.text("tiles"));
    const int threads = options.count("threads");
    for (int round = 0; round < options.count("rounds"); ++round) {
        for (Contestant& contestant : contestants)
            contestant.seconds.push_back(
                seconds_of([&] { contestant.run(contestant.masks); }, threads));
    }
    fmt::print("declination {:.2f} deg, {} steps, {} thread(s); ms per 1000 texels\n",
               declination_deg, path.steps(), threads);
    double embree_best = 0.0;
    for (const Contestant& contestant : contestants) {
        const double ms =
            1e6 * median(contestant.seconds) / static_cast<double>(stage.receivers.size());
        if (contestant.is_embree && (embree_best == 0.0 || ms < embree_best)) embree_best = ms;
        fmt::print("  {:38} {:8.3f}", contestant.name, ms);
        if (!contestant.is_embree && embree_best > 0.0) fmt::print("  {:5.2f}x", embree_best / ms);
        fmt::print("  {} differ from the first\n",
                   differing(contestant.masks, contestants.front().masks));
    }
    std::fflush(stdout);
}

void bench_scene(const std::string& name, const Options& options) {
    const bake_scenes::Plan plan = plan_of(name, options);
    const Scene scene = plan.scene();
    Progress progress;
    // Embree takes any name that it does not know, "default" too, for SSE2.
    const std::string& isa = options.text("isa");
    const std::string config = isa == "best" ? "" : "isa=" + isa;
    const auto start = Clock::now();
    const auto since = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
    interval::Tree tree(
        scene, interval::frame_around({0.0, std::sin(kLatitude_rad), -std::cos(kLatitude_rad)}),
        false, progress);
    const double tree_s = since();
    const Stage stage{scene,
                      std::move(tree),
                      {scene.meshes()[0], config},
                      chosen(plan.receivers(), options.count("patches"))};
    fmt::print(
        "\n{}: {} triangles, {} texels; tree {:.1f} MB in {:.2f} s, Embree's {:.1f} MB in "
        "{:.2f} s\n",
        name, stage.tree.triangle_count(), stage.receivers.size(),
        1e-6 * static_cast<double>(stage.tree.memory_bytes()), tree_s,
        1e-6 * static_cast<double>(stage.embree.bytes()), since() - tree_s);
    fmt::print("{} bytes of masks per texel, {} of receivers\n",
               8 * ((options.count("steps") + 63) / 64), sizeof(Receiver));
    const std::string declination = options.text("declination");
    for (const double degrees : {23.44, -23.44}) {
        if (declination.empty()) compete(stage, degrees, options);
    }
    if (!declination.empty()) compete(stage, options.number("declination"), options);
}

int run(int argc, char** argv) {
    const Options options(argc, argv);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(options.count("threads")));
    constexpr std::array kIsas = {"best", "sse4.2", "avx2", "avx512"};
    if (std::ranges::find(kIsas, options.text("isa")) == kIsas.end()) {
        fail_input("isa: {} is none of best, sse4.2, avx2, avx512", options.text("isa"));
    }
    const std::map<std::string, std::int64_t> targets = {
        {"best", hwy::SupportedTargets()}, {"avx2", HWY_AVX2}, {"sse4", HWY_SSE4}};
    const auto target = targets.find(options.text("simd"));
    if (target == targets.end()) {
        fail_input("simd: {} is none of best, avx2, sse4", options.text("simd"));
    }
    hwy::GetChosenTarget().Update(target->second);
    for (const char* scene : {"courtyard", "city", "forest"}) {
        if (options.text("scene").empty() || options.text("scene") == scene) {
            bench_scene(scene, options);
        }
    }
    return 0;
}

}  // namespace
}  // namespace gnomon

int main(int argc, char** argv) {
    return gnomon::bench_main(argc, argv, &gnomon::run);
}
