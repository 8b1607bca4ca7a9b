#include <gnomon/report.h>

#include "command.h"
#include "facts.h"
#include "flags.h"
#include "help.h"
#include "lit_scene.h"
#include "output.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>

namespace gnomon::cli {

namespace {

constexpr const char* kExamples = R"(Examples:
  gnomon bench field-large --size 1920x1080
  gnomon bench model.glb --techniques shadow_map --frames 100 --json times.json

Times the scene's first light (--lights chooses another, --light sets one), after two renders to
warm up. Every parameter of a technique is a flag; gnomon info lists them.)";

constexpr int kDefaultFrames = 20;
constexpr int kMaxFrames = 100000;
constexpr double kBytesPerMiB = 1024.0 * 1024.0;

struct BenchFlags {
    ViewFlags view;
    std::string techniques = "all";
    std::string json;
    int frames = kDefaultFrames;
};

std::string row(std::string_view name, const Spread& ms) {
    return fmt::format("  {:<24} {:>10.3f} {:>10.3f} {:>10.3f}\n", name, ms.median, ms.min, ms.max);
}

std::string bench_text(const std::vector<BenchResult>& results) {
    std::string text =
        fmt::format("{:<26} {:>10} {:>10} {:>10}\n", "milliseconds", "median", "min", "max");
    for (const BenchResult& result : results) {
        text += fmt::format("{} on {}", result.technique, result.light);
        if (!result.supported) {
            text += fmt::format(": {}\n", result.note);
            continue;
        }
        text += fmt::format("; prepared in {:.1f} ms, holds {:.1f} MiB\n", result.prepare_ms,
                            static_cast<double>(result.memory_bytes) / kBytesPerMiB);
        text += row("total", result.total_ms);
        text += row("cpu", result.cpu_ms);
        text += row("gpu", result.gpu_ms);
        for (const auto& [name, ms] : result.passes)
            text += row("gpu " + name, ms);
    }
    return text;
}

Json spread_json(const Spread& ms) {
    return {{"median", ms.median}, {"min", ms.min}, {"max", ms.max}};
}

Json result_json(const BenchResult& result) {
    Json passes = Json::object();
    for (const auto& [name, ms] : result.passes)
        passes[name] = spread_json(ms);
    return {{"technique", result.technique},
            {"light", result.light},
            {"supported", result.supported},
            {"note", result.note},
            {"memory_bytes", result.memory_bytes},
            {"time_ms",
             {{"prepare", result.prepare_ms},
              {"total", spread_json(result.total_ms)},
              {"cpu", spread_json(result.cpu_ms)},
              {"gpu", spread_json(result.gpu_ms)},
              {"passes", std::move(passes)}}}};
}

Json bench_json(const std::vector<BenchResult>& results, const BenchFlags& flags,
                const Scene& scene, const DeviceInfo& device) {
    Json rows = Json::array();
    for (const BenchResult& result : results)
        rows.push_back(result_json(result));
    return {{"gnomon", GNOMON_VERSION},
            {"device",
             {{"name", device.name},
              {"type", device_type_name(device.type)},
              {"driver", device.driver}}},
            {"scene",
             {{"file", scene.source()},
              {"triangles", scene.triangle_count()},
              {"instances", scene.instances().size()},
              {"lights", scene.lights().size()}}},
            {"size", {flags.view.size.width, flags.view.size.height}},
            {"frames", flags.frames},
            {"results", std::move(rows)}};
}

void run_bench(const BenchFlags& flags, const Session& session, ConsoleProgress& progress) {
    require_scene("bench", flags.view);
    check_time("bench", flags.view);
    if (!flags.json.empty()) require_output_file("--json", flags.json, ".json");
    CompareOptions options;
    options.techniques = choose_techniques(flags.techniques, session);
    options.size = flags.view.size;
    options.ignore_alpha = flags.view.ignore_alpha;

    const LitScene lit = load_lit(flags.view, session, progress);
    const Scene& scene = lit.scene;
    look_up(lit.bake, options.techniques);
    options.camera = choose_camera(scene, flags.view, session);
    options.lights = lit.lights;
    options.lights.resize(1, options.lights.front());

    Context context(context_options(session));
    const std::vector<BenchResult> results =
        bench_techniques(context, scene, options, flags.frames, progress);
    progress.check();
    progress.clear();
    for (const BenchResult& result : results) {
        if (result.supported && !result.note.empty())
            print_warning(fmt::format("{}, {}: {}", result.technique, result.light, result.note));
    }
    print(bench_text(results));
    check_validation(context);
    if (flags.json.empty()) return;
    write_text(flags.json, dump(bench_json(results, flags, scene, context.device())));
    print(fmt::format("json: {}\n", flags.json));
}

}  // namespace

Command add_bench(CLI::App& program) {
    CLI::App* const app =
        add_command(program, "bench", "Time techniques: median, min and max, each pass on the GPU",
                    "gnomon bench SCENE [--techniques A,B|all] [flags]", kExamples);
    const auto flags = std::make_shared<BenchFlags>();
    app->add_option("--techniques", flags->techniques, "which to time (default all)")
        ->type_name("A,B|all");
    add_integer(*app, "--frames", flags->frames, {1, kMaxFrames, "frames"},
                "renders to time (default 20)");
    app->add_option("--json", flags->json, "also write the times to this file")
        ->type_name("FILE.json");
    add_view(*app, flags->view);
    return {app,
            [flags](const Session& session, ConsoleProgress& progress) {
                run_bench(*flags, session, progress);
            },
            true};
}

}  // namespace gnomon::cli
