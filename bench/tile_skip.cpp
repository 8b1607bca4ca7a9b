// What bounds of a map's tiles spare its filters: of the receivers that face the light, how many
// they prove lit and dark, and what the passes cost with and without them.
//
//     tile_skip [TECHNIQUE [SCENE...]]
//
// Without arguments `pssm` and `shadow_map`, on the four built-in scenes that have a sun and more
// than a cube. Every filter, 1280x720, defaults otherwise. Times are medians of nine frames, with
// and without bounds by turns; * marks what `automatic` skips. Fails when any pixel differs.

#include <gnomon/error.h>
#include <gnomon/gnomon.h>

#include "base/check.h"
#include "bench_main.h"
#include "technique/map_technique.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gnomon {
namespace {

constexpr Extent kSize{1280, 720};
constexpr int kFrames = 9;

/// A technique that skips always or never, and what its passes took.
struct Contestant {
    std::unique_ptr<Technique> technique;
    std::map<std::string, std::vector<double>> passes_ms;

    Visibility render(const Frame& frame) {
        Visibility out = technique->render(frame);
        for (const PassTime& pass : technique->last_render().passes)
            passes_ms[pass.name].push_back(pass.ms);
        return out;
    }
    double ms(const char* pass) { return passes_ms[pass].empty() ? 0.0 : median(passes_ms[pass]); }
};

Contestant contestant(Context& context, const std::string& technique, const std::string& filter,
                      const std::string& skip) {
    return {make_technique(context, technique, {{"filter", filter}, {"skip_uniform", skip}}), {}};
}

struct Shares {
    double lit = 0.0, dark = 0.0, filtered = 0.0;
};

/// Of the receivers that face the light.
Shares shares_of(Context& context, const std::string& technique, const std::string& filter,
                 const Frame& frame) {
    Contestant counted = contestant(context, technique, filter, "always");
    dynamic_cast<MapTechnique&>(*counted.technique).show_proven();
    const Visibility shown = counted.render(frame);
    const ComparisonMask mask = comparison_mask(context, frame);
    Shares shares;
    double receivers = 0.0;
    for (std::size_t i = 0; i < shown.image().pixels().size(); ++i) {
        if (mask.facing.pixels()[i] <= 0.0f) continue;
        const float proven = shown.image().pixels()[i];
        ++receivers;
        ++(proven == 1.0f ? shares.lit : proven == 0.0f ? shares.dark : shares.filtered);
    }
    return {shares.lit / receivers, shares.dark / receivers, shares.filtered / receivers};
}

void judge(Context& context, const std::string& technique, const std::string& name) {
    const Scene scene = load_scene(name);
    const Frame frame{.scene = scene,
                      .camera = scene.cameras().at(0),
                      .light = scene.lights().at(0),
                      .size = kSize};
    for (const std::string& filter :
         find_param(technique, find_technique(technique).params(), "filter").choices) {
        Contestant with = contestant(context, technique, filter, "always");
        Contestant without = contestant(context, technique, filter, "never");
        for (int i = 0; i < kFrames; ++i) {
            const Visibility a = with.render(frame);
            const Visibility b = without.render(frame);
            if (!std::ranges::equal(a.image().pixels(), b.image().pixels())) {
                fail_machine("{}, {}, {}: pictures with and without bounds differ", technique, name,
                             filter);
            }
        }
        Contestant automatic = contestant(context, technique, filter, "automatic");
        automatic.render(frame);
        const Shares shares = shares_of(context, technique, filter, frame);
        const double before_ms = without.ms("lookup");
        const double after_ms = with.ms("bounds") + with.ms("lookup");
        fmt::print(
            "{:10} {:12} {:12} lit {:5.1f} %  dark {:5.1f} %  filtered {:5.1f} %  lookup "
            "{:6.1f} ms  bounds {:5.1f} + lookup {:6.1f} ms  {:4.2f}{}\n",
            technique, name, filter, 100.0 * shares.lit, 100.0 * shares.dark,
            100.0 * shares.filtered, before_ms, with.ms("bounds"), with.ms("lookup"),
            after_ms / before_ms, automatic.passes_ms.contains("bounds") ? " *" : "");
        std::fflush(stdout);
    }
}

int run(int argc, char** argv) {
    Context context;
    std::vector<std::string> techniques{"pssm", "shadow_map"};
    if (argc > 1) techniques = {argv[1]};
    std::vector<std::string> scenes(argv + std::min(argc, 2), argv + argc);
    if (scenes.empty()) scenes = {"courtyard", "gas-station", "field-small", "field-large"};
    for (const std::string& technique : techniques) {
        for (const std::string& scene : scenes)
            judge(context, technique, scene);
    }
    return 0;
}

}  // namespace
}  // namespace gnomon

int main(int argc, char** argv) {
    return gnomon::bench_main(argc, argv, &gnomon::run);
}
