// Occlusion interval maps over a day: their error to the traced disc of the sun, a line for each of
// a list of settings, and where the error comes from.
//
//     interval_day SCENE [-m MINUTES] [-s SAMPLES] [-o DIR] [-z] ["PARAMETER=VALUE..."]...
//
// The day is that of the scene's own sun, at 48 degrees north, from sunrise to sunset, a frame
// every MINUTES (30), 640 x 360. The truth is SAMPLES (256) rays over a disc of 0.53 degrees. Each
// setting is told with its mean and its greatest RMSE over the frames, its share of the first one's
// mean, what it keeps in device memory, and how long its look-up of a frame takes. Rows in brackets
// have no texels: each pixel's own intervals, in 255 and 1023 steps, show what remains when texels
// are as small as can be. With -o, DIR gets a picture of the differences of each frame: red is too
// light, blue too dark. With -z, +Z of an OBJ file points up.

#include <gnomon/error.h>
#include <gnomon/gnomon.h>

#include "bake/circle_path.h"
#include "bake/interval_codes.h"
#include "base/check.h"
#include "base/parallel.h"
#include "bench_main.h"
#include "engine_view.h"
#include "interval/bake.h"
#include "visibility/context_impl.h"
#include "visibility/visibility_impl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gnomon {
namespace {

constexpr Extent kSize{640, 360};
constexpr double kLatitude_deg = 48.0;
constexpr float kSun_rad = 0.53f * kPi / 180.0f;
constexpr double kMinutesPerTurn = 24.0 * 60.0;

struct Arguments {
    std::string scene;
    std::filesystem::path folder;
    UpAxis up = UpAxis::y;
    double minutes = 30.0;
    int samples = 256;
    std::vector<std::string> specs;
};

Arguments parse(int argc, char** argv) {
    Arguments result;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const bool takes_value = word == "-m" || word == "-s" || word == "-o";
        if (takes_value && i + 1 == argc) fail_input("interval_day: {} needs a value", word);
        if (word == "-m") {
            result.minutes = std::stod(argv[++i]);
        } else if (word == "-s") {
            result.samples = std::stoi(argv[++i]);
        } else if (word == "-o") {
            result.folder = argv[++i];
        } else if (word == "-z") {
            result.up = UpAxis::z;
        } else if (result.scene.empty()) {
            result.scene = word;
        } else {
            result.specs.push_back(word);
        }
    }
    if (result.scene.empty()) fail_input("interval_day: SCENE [\"PARAMETER=VALUE...\"]...");
    return result;
}

struct Moment {
    Frame frame;
    Visibility truth;
    ComparisonMask mask;
};

DVec3 pole_ws() {
    return sky_direction_ws(0.0, kLatitude_deg, {.up = UpAxis::y, .north_deg = 0.0});
}

bake::PathThrough path_of(const Scene& scene, int steps) {
    for (const Light& light : scene.lights()) {
        if (const auto* sun = std::get_if<DirectionalLight>(&light))
            return bake::circle_through(DVec3(sun->to_light_ws), pole_ws(), DVec3(0, 1, 0), steps);
    }
    fail_input("{}: has no sun, whose day could be taken", scene.source());
}

std::vector<Moment> day_of(Context& context, const Scene& scene, const Arguments& arguments) {
    const bake::PathThrough whole = path_of(scene, 1);
    const double radius = glm::length(glm::cross(whole.path.to_light_ws.front(), pole_ws()));
    const double arc_rad = 1.0 / (whole.steps_per_rad * radius);  // about the pole
    const double up_minutes = arc_rad / (2.0 * kPi) * kMinutesPerTurn;
    const int count = std::max(1, static_cast<int>(std::lround(up_minutes / arguments.minutes)));
    std::vector<Moment> moments;
    for (const DVec3& to_light_ws : path_of(scene, count).path.to_light_ws) {
        Frame frame{.scene = scene,
                    .camera = scene.cameras().at(0),
                    .light = DirectionalLight{.to_light_ws = Vec3(to_light_ws),
                                              .angular_diameter_rad = kSun_rad},
                    .size = kSize};
        Visibility truth = trace_visibility(context, frame, {.samples = arguments.samples});
        ComparisonMask mask = comparison_mask(context, frame);
        moments.push_back({std::move(frame), std::move(truth), std::move(mask)});
    }
    fmt::print("{}: {} frames in {:.1f} hours of sun\n", arguments.scene, count, up_minutes / 60.0);
    return moments;
}

void write_difference(const std::filesystem::path& file, const Image& found, const Moment& moment) {
    Image picture(kSize, 3);
    for (unsigned y = 0; y < kSize.height; ++y) {
        for (unsigned x = 0; x < kSize.width; ++x) {
            const float shade = 0.25f * moment.truth.image().at(x, y) + 0.15f;
            const float d = moment.mask.facing.at(x, y) == 0.0f
                                ? 0.0f
                                : found.at(x, y) - moment.truth.image().at(x, y);
            picture.at(x, y, 0) = shade + std::max(d, 0.0f);
            picture.at(x, y, 1) = shade;
            picture.at(x, y, 2) = shade + std::max(-d, 0.0f);
        }
    }
    write_png(file, picture);
}

class Table {
public:
    explicit Table(const Arguments& arguments) : arguments_(arguments) {}

    /// `found` gives the visibility of a moment.
    template <typename Found>
    void add(const std::string& label, const std::vector<Moment>& moments, const Found& found) {
        double sum = 0.0;
        double greatest = 0.0;
        RenderStats stats;
        double least_ms = std::numeric_limits<double>::max();
        for (std::size_t i = 0; i < moments.size(); ++i) {
            const Visibility visibility = found(moments[i], stats);
            least_ms = std::min(least_ms, stats.cpu_ms + stats.gpu_ms);
            const double rmse = compare(visibility, moments[i].truth, moments[i].mask).rmse;
            sum += rmse;
            greatest = std::max(greatest, rmse);
            if (!arguments_.folder.empty()) {
                write_difference(arguments_.folder / fmt::format("{}_{:02}.png", rows_, i),
                                 visibility.image(), moments[i]);
            }
        }
        const double mean = sum / static_cast<double>(moments.size());
        if (rows_++ == 0) first_ = mean;
        const double mib = static_cast<double>(stats.memory_bytes) / (1 << 20);
        fmt::print("{:60} mean RMSE {:.4f} ({:.2f})  greatest {:.4f}  {:6.1f} MiB {:6.1f} ms\n",
                   label, mean, mean / first_, greatest, mib, least_ms);
        std::fflush(stdout);
    }

private:
    const Arguments& arguments_;
    int rows_ = 0;
    double first_ = 1.0;
};

void without_texels(Context& context, const Scene& scene, const std::vector<Moment>& moments,
                    Table& table) {
    Progress silent;
    const std::shared_ptr<FrameReceivers> receivers =
        context.impl().receiver_points(moments.front().frame, silent);
    for (const int steps : {255, 1023}) {
        const bake::PathThrough path = path_of(scene, steps);
        const interval::Frame frame = interval::frame_around(path.path.pole_ws);
        const interval::Tree tree(scene, frame, false, silent);
        const interval::DayPath day(path.path.to_light_ws, frame);
        const interval::DayMasks masks = interval::bake(tree, day, receivers->points, silent);
        for (const bool even : {true, false}) {
            const auto found = [&](const Moment& moment, RenderStats&) {
                const auto& sun = std::get<DirectionalLight>(moment.frame.light);
                const double at = bake::step_on(path, DVec3(sun.to_light_ws), 1e-3);
                const double width = static_cast<double>(kSun_rad) * path.steps_per_rad;
                Visibility result;
                Image& seen = result.impl().host_target(context.impl(), kSize);
                for (std::size_t i = 0; i < receivers->points.size(); ++i) {
                    double sum = receivers->points[i].exists() ? 0.0 : 1.0;
                    if (receivers->points[i].exists()) {
                        for (const interval::Interval& lit : interval::intervals(masks.mask(i)))
                            sum += bake::seen_part(lit.rise, lit.fall, at, width, even);
                    }
                    seen.pixels()[i] = static_cast<float>(std::min(sum, 1.0));
                }
                return result;
            };
            table.add(fmt::format("[no texels, {} steps, {}]", steps, even ? "even" : "disc"),
                      moments, found);
        }
    }
}

int run(int argc, char** argv) {
    const Arguments arguments = parse(argc, argv);
    if (!arguments.folder.empty()) std::filesystem::create_directories(arguments.folder);
    Context context;
    const Scene scene = load_scene(arguments.scene, {.up = arguments.up});
    const std::vector<Moment> moments = day_of(context, scene, arguments);
    Table table(arguments);
    for (const std::string& spec : arguments.specs) {
        const std::unique_ptr<Technique> technique =
            technique_of(context, "occlusion_interval_maps " + spec);
        table.add(spec, moments, [&](const Moment& moment, RenderStats& stats) {
            Visibility visibility = technique->render(moment.frame);
            stats = technique->last_render();
            return visibility;
        });
    }
    without_texels(context, scene, moments, table);
    return 0;
}

}  // namespace
}  // namespace gnomon

int main(int argc, char** argv) {
    return gnomon::bench_main(argc, argv, &gnomon::run);
}
