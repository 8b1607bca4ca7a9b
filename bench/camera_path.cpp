// What a technique's passes cost while the camera goes on, or instances of the scene move.
//
//     camera_path SCENE turn|walk|rest FRAMES [moving=COUNT] "TECHNIQUE [PARAMETER=VALUE...]"...
//
// SCENE is a file or a built-in scene, seen by its first camera at 1920 x 1080 under its first
// directional light. `turn` turns the camera about the vertical by 0.05 degrees a frame, as the
// engines of bench/peers do; `walk` moves it ahead on the level by 0.1 m a frame, 6 m/s at 60
// frames a second; `rest` leaves it where it is. With `moving`, so many of the instances that share
// their mesh with others, those nearest to a point before the camera, go round by 0.1 m a frame.
// Medians, means and maxima over the frames after the first few; `scene` is what Scene::moved()
// and prepare() take.

#include <gnomon/error.h>
#include <gnomon/gnomon.h>

#include "base/check.h"
#include "bench_main.h"
#include "engine_view.h"

#include <fmt/format.h>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gnomon {
namespace {

constexpr float kTurn_rad = radians(0.05f);
constexpr float kStep_m = 0.1f;
constexpr float kCircle_m = 0.5f;   ///< radius of the way of what moves
constexpr float kBefore_m = 10.0f;  ///< what moves is nearest to there
constexpr int kWarmUpFrames = 3;

enum class Way { turn, walk, rest };

/// The camera after so many frames.
Camera camera_at(const Camera& start, Way way, int frame) {
    const auto count = static_cast<float>(frame);
    Camera camera = start;
    if (way == Way::turn) {
        // About the vertical through the eye: the world turns the other way.
        const Vec3 eye(glm::inverse(start.view_from_world)[3]);
        Mat4 turned = glm::translate(Mat4(1.0f), eye);
        turned = glm::rotate(turned, count * kTurn_rad, Vec3(0, 1, 0));
        camera.view_from_world = start.view_from_world * glm::translate(turned, -eye);
    } else if (way == Way::walk) {
        const Vec3 ahead(-glm::inverse(start.view_from_world)[2]);
        const Vec3 level = normalize(Vec3(ahead.x, 0.0f, ahead.z));
        camera.view_from_world = glm::translate(start.view_from_world, -count * kStep_m * level);
    }
    return camera;
}

/// So many of the instances whose mesh has others, the nearest before the camera.
std::vector<std::uint32_t> chosen_instances(const Scene& scene, const Camera& camera,
                                            std::size_t count) {
    std::vector<std::size_t> users(scene.meshes().size());
    for (const Instance& instance : scene.instances())
        ++users[instance.mesh];
    std::vector<std::uint32_t> shared;
    for (std::uint32_t i = 0; i < scene.instances().size(); ++i) {
        if (users[scene.instances()[i].mesh] > 1) shared.push_back(i);
    }
    if (count > shared.size()) {
        fail_input("camera_path: moving is {}; {} instances share their mesh", count,
                   shared.size());
    }
    const Mat4 world_from_view = glm::inverse(camera.view_from_world);
    const Vec3 before_ws(world_from_view * Vec4(0.0f, 0.0f, -kBefore_m, 1.0f));
    std::ranges::stable_sort(shared, {}, [&](std::uint32_t i) {
        return glm::distance(Vec3(scene.instances()[i].world_from_local[3]), before_ws);
    });
    shared.resize(count);
    return shared;
}

Scene scene_at(const Scene& start, const std::vector<std::uint32_t>& moving, int frame) {
    const float turn_rad = static_cast<float>(frame) * kStep_m / kCircle_m;
    const Vec3 by(kCircle_m * std::cos(turn_rad), 0.0f, kCircle_m * std::sin(turn_rad));
    std::vector<InstancePose> poses;
    for (const std::uint32_t i : moving) {
        poses.push_back(
            {i, glm::translate(Mat4(1.0f), by) * start.instances()[i].world_from_local});
    }
    return start.moved(poses);
}

double ms_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
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

/// What goes on from frame to frame.
struct Path {
    Way way = Way::rest;
    int frames = 1;
    std::vector<std::uint32_t> moving;
};

void follow(Context& context, Frame frame, const Path& path, const std::string& spec) {
    const std::unique_ptr<Technique> technique = technique_of(context, spec);
    const Camera start = frame.camera;
    const Scene scene = frame.scene;
    Visibility visibility = technique->render(frame);
    std::vector<double> total_ms;
    std::map<std::string, std::vector<double>> passes_ms;
    for (int i = -kWarmUpFrames; i < path.frames; ++i) {
        frame.camera = camera_at(start, path.way, i);
        const auto moves = std::chrono::steady_clock::now();
        if (!path.moving.empty()) {
            frame.scene = scene_at(scene, path.moving, i);
            technique->prepare(frame.scene);
        }
        const double scene_ms = ms_since(moves);
        technique->render(frame, visibility);
        if (i < 0) continue;
        const RenderStats stats = technique->last_render();
        total_ms.push_back(scene_ms + stats.cpu_ms + stats.gpu_ms);
        passes_ms["scene"].push_back(scene_ms);
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
    constexpr std::string_view kMoving = "moving=";
    const std::map<std::string, Way> ways{
        {"turn", Way::turn}, {"walk", Way::walk}, {"rest", Way::rest}};
    const auto way = ways.find(argc > 2 ? argv[2] : "");
    Path path{.frames = argc > 3 ? std::atoi(argv[3]) : 0};
    const bool moves = argc > 4 && std::string_view(argv[4]).starts_with(kMoving);
    const int first_spec = moves ? 5 : 4;
    if (argc <= first_spec || way == ways.end() || path.frames < 1) {
        fail_input(
            "camera_path: SCENE turn|walk|rest FRAMES [moving=COUNT] \"TECHNIQUE "
            "[PARAMETER=VALUE...]\"..., FRAMES 1 or more");
    }
    path.way = way->second;
    Context context;
    const Frame frame = frame_of(load_scene(argv[1]));
    if (moves) {
        const int count = std::atoi(argv[4] + kMoving.size());
        if (count < 1) fail_input("camera_path: \"{}\": moving is 1 or more", argv[4]);
        path.moving = chosen_instances(frame.scene, frame.camera, static_cast<std::size_t>(count));
    }
    for (int i = first_spec; i < argc; ++i)
        follow(context, frame, path, argv[i]);
    return 0;
}

}  // namespace
}  // namespace gnomon

int main(int argc, char** argv) {
    return gnomon::bench_main(argc, argv, &gnomon::run);
}
