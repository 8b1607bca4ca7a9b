// What a technique's passes cost while the camera goes on.
//
//     camera_path SCENE turn|walk FRAMES "TECHNIQUE [PARAMETER=VALUE...]"...
//
// SCENE is a file or a built-in scene, seen by its first camera at 1920 x 1080 under its first
// directional light. `turn` turns the camera about the vertical by 0.05 degrees a frame, as the
// engines of bench/peers do; `walk` moves it ahead on the level by 0.1 m a frame, 6 m/s at 60
// frames a second. Medians, means and maxima over the frames after the first few.

#include <gnomon/error.h>
#include <gnomon/gnomon.h>

#include "base/check.h"
#include "bench_main.h"
#include "engine_view.h"

#include <fmt/format.h>
#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <variant>
#include <vector>

namespace gnomon {
namespace {

constexpr float kTurn_rad = radians(0.05f);
constexpr float kStep_m = 0.1f;
constexpr int kWarmUpFrames = 3;

/// The camera after so many frames.
Camera camera_at(const Camera& start, bool turns, int frame) {
    const auto count = static_cast<float>(frame);
    Camera camera = start;
    if (turns) {
        // About the vertical through the eye: the world turns the other way.
        const Vec3 eye(glm::inverse(start.view_from_world)[3]);
        Mat4 turned = glm::translate(Mat4(1.0f), eye);
        turned = glm::rotate(turned, count * kTurn_rad, Vec3(0, 1, 0));
        camera.view_from_world = start.view_from_world * glm::translate(turned, -eye);
    } else {
        const Vec3 ahead(-glm::inverse(start.view_from_world)[2]);
        const Vec3 level = normalize(Vec3(ahead.x, 0.0f, ahead.z));
        camera.view_from_world = glm::translate(start.view_from_world, -count * kStep_m * level);
    }
    return camera;
}

Frame frame_of(const Scene& scene) {
    for (const Light& light : scene.lights()) {
        if (!std::holds_alternative<DirectionalLight>(light)) continue;
        if (scene.cameras().empty()) break;
        return {
            .scene = scene, .camera = scene.cameras().front(), .light = light, .size = kEngineView};
    }
    fail_input("camera_path: the scene needs a camera and a directional light");
}

void print_times(const std::string& name, const std::vector<double>& times_ms) {
    const double sum_ms = std::accumulate(times_ms.begin(), times_ms.end(), 0.0);
    fmt::print("  {} {:.1f} / {:.1f} / {:.1f}", name, median(times_ms),
               sum_ms / static_cast<double>(times_ms.size()), *std::ranges::max_element(times_ms));
}

void follow(Context& context, Frame frame, bool turns, int frames, const std::string& spec) {
    const std::unique_ptr<Technique> technique = technique_of(context, spec);
    const Camera start = frame.camera;
    Visibility visibility = technique->render(frame);
    std::vector<double> total_ms;
    std::map<std::string, std::vector<double>> passes_ms;
    for (int i = -kWarmUpFrames; i < frames; ++i) {
        frame.camera = camera_at(start, turns, i);
        technique->render(frame, visibility);
        if (i < 0) continue;
        const RenderStats stats = technique->last_render();
        total_ms.push_back(stats.cpu_ms + stats.gpu_ms);
        for (const PassTime& pass : stats.passes)
            passes_ms[pass.name].push_back(pass.ms);
    }
    fmt::print("{:60} median / mean / most ms:", spec);
    print_times("total", total_ms);
    for (const auto& [name, times_ms] : passes_ms)
        print_times(name, times_ms);
    fmt::print("\n");
    std::fflush(stdout);
}

int run(int argc, char** argv) {
    const std::string way = argc > 2 ? argv[2] : "";
    const int frames = argc > 3 ? std::atoi(argv[3]) : 0;
    if (argc < 5 || (way != "turn" && way != "walk") || frames < 1) {
        fail_input(
            "camera_path: SCENE turn|walk FRAMES \"TECHNIQUE [PARAMETER=VALUE...]\"..., FRAMES 1 "
            "or more");
    }
    Context context;
    const Frame frame = frame_of(load_scene(argv[1]));
    for (int i = 4; i < argc; ++i)
        follow(context, frame, way == "turn", frames, argv[i]);
    return 0;
}

}  // namespace
}  // namespace gnomon

int main(int argc, char** argv) {
    return gnomon::bench_main(argc, argv, &gnomon::run);
}
