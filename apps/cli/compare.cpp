#include <gnomon/report.h>

#include "command.h"
#include "fail.h"
#include "flags.h"
#include "help.h"
#include "lit_scene.h"
#include "output.h"

#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <memory>

namespace gnomon::cli {

namespace {

constexpr const char* kExamples = R"(Examples:
  gnomon compare courtyard -o report
  gnomon compare model.glb -o report --size 640x360 --reference-samples 64
  gnomon compare model.glb -o report --techniques shadow_map,shadow_volumes \
      --shadow_map.map_size 4096 --light sun:elevation=35,azimuth=120
  gnomon compare day -o report --time 10:30

Open report/index.html in a browser; report/results.json holds the numbers. Every parameter of a
technique is a flag; gnomon info lists them.)";

constexpr int kMaxSamples = 65536;       // TraceOptions::samples
constexpr int kMaxTimingFrames = 10000;  // enough for any median

struct CompareFlags {
    ViewFlags view;
    CompareOptions options;
    std::string output;
    std::string techniques = "all";
    bool explain = false;
};

/// What the reader must know of each result, and why `auto` chose what it did.
std::string explanation(const ComparisonReport& report) {
    std::string text;
    for (const TechniqueResult& result : report.results) {
        const std::string& note = result.note;
        text += fmt::format("{} on {}: {}\n", result.technique, result.light,
                            note.empty() ? "as its parameters say" : note);
    }
    return text;
}

void run_compare(const CompareFlags& flags, const Session& session, ConsoleProgress& progress) {
    require_scene("compare", flags.view);
    check_time("compare", flags.view);
    if (flags.output.empty()) fail_usage("compare: -o is missing, as in -o report");
    const std::filesystem::path folder =
        require_replaced_folder("-o", flags.output, check_report_folder);
    CompareOptions options = flags.options;
    options.techniques = choose_techniques(flags.techniques, session);
    options.size = flags.view.size;
    options.ignore_alpha = flags.view.ignore_alpha;

    const LitScene lit = load_lit(flags.view, session, progress);
    const Scene& scene = lit.scene;
    look_up(lit.bake, options.techniques);
    options.camera = choose_camera(scene, flags.view, session);
    options.lights = lit.lights;

    Context context(context_options(session));
    const ComparisonReport report = compare_techniques(context, scene, options, progress);
    progress.check();
    write_report(folder, report, progress);
    progress.clear();
    print(table(report));
    if (flags.explain) print(explanation(report));
    check_validation(context);
    print(fmt::format("report: {}\n", (folder / "index.html").string()));
}

}  // namespace

Command add_compare(CLI::App& program) {
    CLI::App* const app = add_command(
        program, "compare", "Measure techniques against the ray-traced truth and write a report",
        "gnomon compare SCENE -o DIR [--techniques A,B|all] [flags]", kExamples);
    const auto flags = std::make_shared<CompareFlags>();
    app->add_option("-o,--output", flags->output,
                    "the folder to make for the report; an earlier report is replaced")
        ->type_name("DIR");
    app->add_option("--techniques", flags->techniques, "which to compare (default all)")
        ->type_name("A,B|all");
    app->add_flag("--explain", flags->explain, "say what each technique chose by itself, and why");
    add_integer(*app, "--reference-samples", flags->options.reference_samples,
                {1, kMaxSamples, "rays"}, "rays per pixel and light of the truth (default 256)");
    app->add_option_function<std::string>(
           "--seed",
           [flags](const std::string& text) {
               const Range seeds{0, std::numeric_limits<unsigned>::max(), ""};
               flags->options.seed = static_cast<unsigned>(parse_integer("--seed", text, seeds));
           },
           "of the truth's rays (default 1); same seed, same numbers")
        ->type_name("N");
    add_integer(*app, "--frames", flags->options.timing_frames, {1, kMaxTimingFrames, "frames"},
                "renders of which times are medians (default 5)");
    add_view(*app, flags->view);
    add_lighting(*app, flags->options.lighting);
    return {app,
            [flags](const Session& session, ConsoleProgress& progress) {
                run_compare(*flags, session, progress);
            },
            true};
}

}  // namespace gnomon::cli
