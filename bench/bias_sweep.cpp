// What the biases that nobody set do: artefacts of every technique with a depth map, at its
// defaults, with every filter and every content, over suns and scenes.
//
//     bias_sweep ["TECHNIQUE[/FILTER,...] [PARAMETER=VALUE...]" [SCENE...]]
//
// Without arguments all such techniques, on the built-in scenes that have a sun; with filters or
// contents, those alone; with parameters, at these. Other scenes are named by their files,
// FILE.obj:z for those whose Z points up. Suns of five elevations (5 to 85 degrees) and four
// azimuths, 640x360, maps of 1024 and of 2048 texels. Prints the mean RMSE to the sun's disc and,
// for each elevation, the worst artefact_lit and artefact_shadow over all scenes and azimuths, in
// millionths, and where the worst of all was. The aim is at most 1000 and 300. What no bias mends
// is left out of them: filters that do not know how wide the sun is are judged by a sun without
// width, since where most of its disc is hidden, but not its middle, they are lit. The last figures
// are theirs by the disc.

#include <gnomon/error.h>
#include <gnomon/gnomon.h>

#include "bench_main.h"
#include "engine_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon {
namespace {

constexpr Extent kSize{640, 360};
constexpr int kTruthSamples = 32;
constexpr std::size_t kElevations = 5;
constexpr std::array<float, kElevations> kElevations_deg{5.0f, 15.0f, 35.0f, 60.0f, 85.0f};
constexpr float kAzimuths_deg[] = {30.0f, 120.0f, 210.0f, 300.0f};
constexpr int kMapSizes[] = {1024, 2048};

struct Worst {
    double value = 0.0;
    std::string where;
    void include(double other, const std::string& place) {
        if (other <= value) return;
        value = other;
        where = place;
    }
};

struct Contestant {
    std::string technique, reading;  ///< filter or content
    int map_size = 0;
    std::unique_ptr<Technique> made;
    std::array<Worst, kElevations> lit, shadow;            ///< by elevation
    std::array<Worst, kElevations> disc_lit, disc_shadow;  ///< by a disc that the filter ignores
    double rmse = 0.0;
    int runs = 0;

    bool knows_the_disc() const { return reading == "pcss"; }
};

/// What a technique is compared with.
struct Judge {
    Frame frame;
    Visibility truth;
    ComparisonMask mask;

    Judge(Context& context, const Frame& judged)
        : frame(judged),
          truth(trace_visibility(context, frame, {.samples = kTruthSamples})),
          mask(comparison_mask(context, frame)) {}
    Comparison error(Technique& technique) const {
        return compare(technique.render(frame), truth, mask);
    }
};

/// `spec` is "TECHNIQUE[/READING,...] [PARAMETER=VALUE...]", or empty for all.
std::vector<Contestant> contestants(Context& context, const std::string& spec) {
    std::vector<Contestant> result;
    std::istringstream words(spec);
    std::string only;
    words >> only;
    const std::string technique = only.substr(0, only.find('/'));
    const std::string readings =
        technique.size() < only.size() ? "," + only.substr(technique.size() + 1) + "," : "";
    const Params common = technique.empty() ? Params() : params_of(technique, words);
    for (const TechniqueInfo& info : techniques()) {
        if (!technique.empty() && info.name != technique) continue;
        const std::vector<ParamInfo>& params = info.params();
        const auto filter = std::ranges::find(params, "filter", &ParamInfo::name);
        const bool has_map =
            std::ranges::find(params, "map_size", &ParamInfo::name) != params.end();
        if (filter == params.end() || !has_map) continue;
        const auto add = [&](const std::string& param, const std::string& word) {
            if (!readings.empty() && readings.find("," + word + ",") == std::string::npos) return;
            for (const int map_size : kMapSizes) {
                Contestant contestant;
                contestant.technique = info.name;
                contestant.reading = word;
                contestant.map_size = map_size;
                Params all = common;
                all.set(param, word);
                all.set("map_size", map_size);
                contestant.made = make_technique(context, info.name, all);
                result.push_back(std::move(contestant));
            }
        };
        for (const std::string& word : filter->choices)
            add("filter", word);
        const auto content = std::ranges::find(params, "content", &ParamInfo::name);
        for (std::size_t i = 1; content != params.end() && i < content->choices.size(); ++i)
            add("content", content->choices[i]);
    }
    return result;
}

void judge(Context& context, const Scene& scene, const std::string& name,
           std::vector<Contestant>& all) {
    for (std::size_t e = 0; e < kElevations; ++e) {
        const float elevation_deg = kElevations_deg[e];
        for (const float azimuth_deg : kAzimuths_deg) {
            DirectionalLight light = sun(radians(elevation_deg), radians(azimuth_deg));
            Frame frame{
                .scene = scene, .camera = scene.cameras().at(0), .light = light, .size = kSize};
            const Judge by_disc(context, frame);
            light.angular_diameter_rad = 0.0f;
            frame.light = light;
            const Judge by_point(context, frame);
            const std::string place = fmt::format("{} {}/{}", name, elevation_deg, azimuth_deg);
            for (Contestant& contestant : all) {
                const Comparison disc = by_disc.error(*contestant.made);
                const bool knows = contestant.knows_the_disc();
                const Comparison own = knows ? disc : by_point.error(*contestant.made);
                contestant.lit[e].include(own.artefact_lit, place);
                contestant.shadow[e].include(own.artefact_shadow, place);
                contestant.disc_lit[e].include(disc.artefact_lit, place);
                contestant.disc_shadow[e].include(disc.artefact_shadow, place);
                contestant.rmse += disc.rmse;
                ++contestant.runs;
            }
            fmt::print(stderr, "{}\n", place);
        }
    }
}

/// Of each elevation, in millionths, and where the worst of all was.
void print_worst(std::span<const Worst> worst) {
    for (const Worst& one : worst)
        fmt::print(" {:5.0f}", 1e6 * one.value);
    fmt::print(" {:20}", std::ranges::max(worst, {}, &Worst::value).where);
}

/// A scene by its name or file, and whether that ends in ":z".
Scene named_scene(std::string name) {
    constexpr std::string_view kZUp = ":z";
    LoadOptions options;
    if (name.ends_with(kZUp)) {
        options.up = UpAxis::z;
        name.resize(name.size() - kZUp.size());
    }
    return load_scene(name, options);
}

int run(int argc, char** argv) {
    Context context;
    std::vector<Contestant> all = contestants(context, argc > 1 ? argv[1] : "");
    if (all.empty()) {
        fmt::print(stderr,
                   "error: \"{}\" is no technique with a depth map, or none of its filters\n",
                   argv[1]);
        return 2;
    }
    std::vector<std::string> scenes(argv + std::min(argc, 2), argv + argc);
    if (scenes.empty()) {
        for (const BuiltinSceneInfo& info : builtin_scenes())
            scenes.emplace_back(info.name);
    }
    for (const std::string& name : scenes) {
        const Scene scene = named_scene(name);
        if (std::holds_alternative<DirectionalLight>(scene.lights().at(0))) {
            judge(context, scene, std::filesystem::path(name).filename().string(), all);
        }
    }
    for (const Contestant& c : all) {
        fmt::print("{:10} {:20} {:4} RMSE {:.4f}  lit", c.technique, c.reading, c.map_size,
                   c.rmse / c.runs);
        print_worst(c.lit);
        fmt::print("  shadow");
        print_worst(c.shadow);
        fmt::print("  by the disc: lit");
        print_worst(c.disc_lit);
        fmt::print("  shadow");
        print_worst(c.disc_shadow);
        fmt::print("\n");
    }
    return 0;
}

}  // namespace
}  // namespace gnomon

int main(int argc, char** argv) {
    return gnomon::bench_main(argc, argv, &gnomon::run);
}
