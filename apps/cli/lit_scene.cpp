#include "lit_scene.h"

#include "fail.h"
#include "output.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace gnomon::cli {

namespace {

namespace fs = std::filesystem;

constexpr double kDay_s = 86400.0;
/// A time that is told in milliseconds may be so far beyond the path's own.
constexpr double kRounding_s = 1e-3;

/// The time of --time in seconds of the path's clock, whose day may be the one before or after.
double clock_in(const BakePath& path, const std::string& time) {
    const double wanted_s = parse_clock("--time", time);
    for (const double clock_s : {wanted_s, wanted_s - kDay_s, wanted_s + kDay_s}) {
        if (clock_s >= path.begin_s - kRounding_s && clock_s <= path.end_s + kRounding_s)
            return std::clamp(clock_s, path.begin_s, path.end_s);
    }
    fail_usage("--time: {} is outside of the bake's path, which is from {} to {}", time,
               clock_text(path.begin_s), clock_text(path.end_s));
}

LitScene load_bake(const ViewFlags& flags, ConsoleProgress& progress) {
    std::error_code error;
    if (!fs::exists(fs::path(flags.scene) / "bake.json", error)) {
        fail_usage(
            "{}: is a folder without bake.json: name one of gnomon bake, or a .gltf, .glb or .obj "
            "file",
            flags.scene);
    }
    const auto bake = std::make_shared<const IntervalBake>(read_bake(flags.scene));
    progress.check();
    return {.scene = bake->scene,
            .lights = {light_at(bake->path, clock_in(bake->path, flags.time))},
            .bake = bake};
}

}  // namespace

bool names_bake(const ViewFlags& flags) {
    std::error_code error;
    return fs::is_directory(flags.scene, error);
}

void check_time(const std::string& command, const ViewFlags& flags) {
    if (!names_bake(flags)) {
        if (flags.time.empty()) return;
        fail_usage("--time: is of a bake's light; {} is no folder of gnomon bake", flags.scene);
    }
    if (!flags.lights.empty() || !flags.chosen_lights.empty()) {
        fail_usage("{}: {} has its own light: {} is not for bakes, --time is", command, flags.scene,
                   flags.lights.empty() ? "--lights" : "--light");
    }
    if (flags.time.empty())
        fail_usage("{}: --time is missing, as in --time 10:30: {} is a bake", command, flags.scene);
}

LitScene load_lit(const ViewFlags& flags, const Session& session, ConsoleProgress& progress) {
    if (names_bake(flags)) {
        LitScene lit = load_bake(flags, progress);
        for (const std::string& warning : lit.scene.warnings())
            print_warning(warning);
        return lit;
    }
    LitScene lit{.scene = load(flags.scene, session, progress), .lights = {}, .bake = nullptr};
    lit.lights = choose_lights(lit.scene, flags, session);
    return lit;
}

void look_up(const std::shared_ptr<const IntervalBake>& bake,
             std::vector<TechniqueChoice>& techniques) {
    for (TechniqueChoice& choice : techniques) {
        if (choice.name == bake_technique().name) choice.bake = bake;
    }
}

}  // namespace gnomon::cli
