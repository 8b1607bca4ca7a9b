// How well a technique's hard shadows match the traced ones, and what its passes cost, in the views
// of a comparison of engines.
//
//     shadow_iou SCENE VIEW.json "TECHNIQUE [PARAMETER=VALUE...]"...
//
// VIEW.json has eye, target, fovy_deg, near and to_sun, as the scenes of bench/peers have. At 1920
// x 1080, the sun without extent. IoU: of the receivers whose cosine to the light is 0.08 or more,
// those in shadow in both, over those in shadow in either; a half decides. Times are medians of
// seven frames, which the techniques render by turns.

#include <gnomon/error.h>
#include <gnomon/gnomon.h>

#include "base/check.h"
#include "bench_main.h"
#include "engine_view.h"
#include "visibility/context_impl.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gnomon {
namespace {

constexpr float kLeastCosine = 0.08f;
constexpr int kFrames = 7;

Vec3 vector(const nlohmann::json& view, const char* key) {
    const nlohmann::json& value = view.at(key);
    return {value.at(0), value.at(1), value.at(2)};
}

Frame frame_of(const Scene& scene, const nlohmann::json& view) {
    Camera camera = look_at(vector(view, "eye"), vector(view, "target"),
                            radians(view.at("fovy_deg").get<float>()));
    camera.near_m = view.at("near");
    const DirectionalLight light{.to_light_ws = normalize(vector(view, "to_sun"))};
    return {.scene = scene, .camera = camera, .light = light, .size = kEngineView};
}

double iou_percent(const std::vector<trace::Receiver>& receivers, const Frame& frame,
                   const Image& truth, const Image& found) {
    const Vec3 to_light = std::get<DirectionalLight>(frame.light).to_light_ws;
    std::size_t both = 0;
    std::size_t either = 0;
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        if (!receivers[i].exists() || glm::dot(receivers[i].normal_ws, to_light) < kLeastCosine) {
            continue;
        }
        const bool traced = truth.pixels()[i] < 0.5f;
        const bool shown = found.pixels()[i] < 0.5f;
        both += traced && shown ? 1 : 0;
        either += traced || shown ? 1 : 0;
    }
    return 100.0 * static_cast<double>(both) /
           static_cast<double>(std::max<std::size_t>(either, 1));
}

/// One technique with its parameters, and what its frames took.
struct Contestant {
    std::string spec;
    std::unique_ptr<Technique> technique;
    Visibility found;
    std::vector<double> total_ms;
    std::map<std::string, std::vector<double>> passes_ms;
};

void render(Contestant& contestant, const Frame& frame) {
    contestant.technique->render(frame, contestant.found);
    const RenderStats stats = contestant.technique->last_render();
    contestant.total_ms.push_back(stats.cpu_ms + stats.gpu_ms);
    contestant.passes_ms["cpu"].push_back(stats.cpu_ms);
    for (const PassTime& pass : stats.passes)
        contestant.passes_ms[pass.name].push_back(pass.ms);
}

void print(const Contestant& contestant, double iou) {
    fmt::print("{:44} IoU {:6.2f} %  {:7.1f} ms", contestant.spec, iou,
               median(contestant.total_ms));
    for (const auto& [name, ms] : contestant.passes_ms)
        fmt::print("  {} {:.1f}", name, median(ms));
    fmt::print("\n");
    std::fflush(stdout);
}

int run(int argc, char** argv) {
    if (argc < 4) fail_input("shadow_iou: SCENE VIEW.json \"TECHNIQUE [PARAMETER=VALUE...]\"...");
    std::ifstream file(argv[2]);
    if (!file) fail_input("{}: cannot be read", argv[2]);
    Context context;
    const Frame frame = frame_of(load_scene(argv[1]), nlohmann::json::parse(file));
    const Visibility truth = trace_visibility(context, frame);
    std::vector<Contestant> contestants;
    for (int i = 3; i < argc; ++i) {
        std::unique_ptr<Technique> technique = technique_of(context, argv[i]);
        Visibility found = technique->render(frame);
        contestants.push_back({argv[i], std::move(technique), std::move(found), {}, {}});
    }
    for (int i = 0; i < kFrames; ++i) {
        for (Contestant& contestant : contestants)
            render(contestant, frame);
    }
    Progress silent;
    const std::shared_ptr<FrameReceivers> receivers = context.impl().receiver_points(frame, silent);
    for (Contestant& contestant : contestants) {
        print(contestant,
              iou_percent(receivers->points, frame, truth.image(), contestant.found.image()));
    }
    return 0;
}

}  // namespace
}  // namespace gnomon

int main(int argc, char** argv) {
    return gnomon::bench_main(argc, argv, &gnomon::run);
}
