#include <gnomon/bake.h>

#include "command.h"
#include "fail.h"
#include "flags.h"
#include "help.h"
#include "output.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <numbers>

namespace gnomon::cli {

namespace {

namespace fs = std::filesystem;

constexpr const char* kExamples = R"(Examples:
  gnomon bake courtyard --sun place=48.137,11.575,date=2026-06-21 --texel 0.1 -o day
  gnomon bake city.glb --sun place=52,4.36,date=2026-12-21,utc=Europe/Amsterdam --bits 16 -o winter
  gnomon bake city.glb --sun place=52.0,4.36,date=2026-12-21 --texel 0.25 -o winter --resume
  gnomon bake stage.glb --light path=sweep.json,diameter=2 --texel 0.05 -o sweep

--sun takes place=LATITUDE,LONGITUDE[,HEIGHT] and date=YEAR-MONTH-DAY, and may take utc=OFFSET or
utc=ZONE (the clock: +02:00, or Europe/Berlin; else the whole hour nearest to the sun's own time),
north=DEGREES (the azimuth of true north in the scene) and steps=N. --light takes path=FILE.json,
key frames of directions as docs/sun.md tells, and may take diameter=DEGREES (of the disc, default
0) and steps=N. gnomon web makes a page of a bake.)";

struct BakeFlags {
    std::string scene, sun, light, output;
    double texel_m = 0.1;
    int bits = 8;
    int pairs = 4;
    BakeMethod method = BakeMethod::interval_traversal;
    bool resume = false;
    bool ignore_alpha = false;
};

BakeMethod parse_method(std::string_view flag, std::string_view text) {
    constexpr std::array<std::string_view, 2> kWords = {"interval_traversal", "rays"};
    const bool by_rays = parse_word(flag, text, kWords) == kWords[1];
    return by_rays ? BakeMethod::rays : BakeMethod::interval_traversal;
}

/// As many as the bits allow, unless told.
int steps_of(const KeyValues& values, int bits) {
    const int most = most_steps(static_cast<BakeBits>(bits));
    if (!values.has("steps")) return most;
    return static_cast<int>(parse_integer(values.label("steps"), values.text("steps", ""),
                                          {1, static_cast<double>(most)}));
}

struct PathAndNote {
    BakePath path;
    std::string note;  ///< what was assumed, in lines
};

PathAndNote sun_path_of(const BakeFlags& flags) {
    constexpr std::array<Key, 5> kKeys{
        {{"place", true}, {"date", true}, {"utc"}, {"north"}, {"steps"}}};
    const KeyValues sun("--sun", flags.sun, kKeys, "place=48.137,11.575,date=2026-06-21");
    const Place place = parse_place(sun.label("place"), sun.text("place", ""));
    const auto date = parse_date(sun.label("date"), sun.text("date", ""));
    SunPathOptions options;
    options.steps = steps_of(sun, flags.bits);
    options.frame.north_deg = sun.number("north", {-360.0, 360.0, "degrees"}, 0.0);
    const std::chrono::minutes offset =
        sun.has("utc") ? clock_utc_offset(sun.label("utc"), sun.text("utc", ""), date)
                       : nearest_utc_offset(place);
    const std::string clock = sun.text("utc", "");
    std::string note;
    if (!sun.has("utc")) {
        note = fmt::format("clocks at UTC{}, the sun's own nearest hour (utc=)\n",
                           utc_offset_text(offset));
    } else if (!is_utc_offset(clock)) {
        note = fmt::format("clocks at UTC{}, of {} on that day\n", utc_offset_text(offset), clock);
    }
    return {bake_path(sun_path(place, date, offset, options), sun.text("place", ""),
                      sun.text("date", "")),
            note};
}

PathAndNote light_path_of(const BakeFlags& flags) {
    constexpr std::array<Key, 3> kKeys{{{"path", true}, {"diameter"}, {"steps"}}};
    const KeyValues light("--light", flags.light, kKeys, "path=sweep.json");
    const double diameter_deg = light.number("diameter", {0.0, 180.0, "degrees"}, 0.0);
    const int steps = steps_of(light, flags.bits);
    const std::string file = light.text("path", "");
    const LightPath path = read_light_path(file);
    try {
        return {bake_path(path, steps, std::numbers::pi / 180.0 * diameter_deg), ""};
    } catch (const Error& error) {
        fail_usage("{}: {}", file, error.what());
    }
}

std::string summary(const IntervalBake& bake, const std::string& folder) {
    const BakeReport& report = bake.report;
    std::string text = fmt::format("{}\n", bake.path.summary);
    text += fmt::format("{} texels on {} page{}, {} with sun, up to {} intervals\n", report.texels,
                        bake.pages.size(), bake.pages.size() == 1 ? "" : "s", report.lit_texels,
                        report.most_intervals);
    if (report.closed_gaps > 0) text += closed_gaps_text(report) + "\n";
    return text + fmt::format("bake: {}\n", folder);
}

/// Where a bake keeps its work until its folder is written: beside it.
fs::path unfinished_file(const fs::path& folder) {
    fs::path file = folder;
    return file += ".unfinished";
}

/// Work of hours, or a file that is not ours, would be lost.
void require_unfinished_file(const fs::path& file, bool resumes) {
    std::error_code error;
    if (!fs::exists(fs::symlink_status(file, error))) return;
    if (!is_unfinished_bake(file)) {
        fail_usage(
            "{}: is no unfinished bake, and a bake keeps its work under that name: move it away, "
            "or choose another -o",
            file.string());
    }
    if (!resumes) {
        fail_usage(
            "{}: an unfinished bake is there: go on with it by --resume, or delete it to begin "
            "anew",
            file.string());
    }
}

void run_bake(const BakeFlags& flags, const Session& session, ConsoleProgress& progress) {
    if (flags.scene.empty()) fail_usage("bake: SCENE is missing");
    if (flags.sun.empty() && flags.light.empty()) {
        fail_usage(
            "bake: --sun is missing, as in --sun place=48.137,11.575,date=2026-06-21, or --light "
            "path=FILE.json");
    }
    if (!flags.sun.empty() && !flags.light.empty())
        fail_usage("bake: --sun and --light are both given; a bake has one light");
    if (flags.output.empty()) fail_usage("bake: -o is missing, as in -o day");
    if (flags.bits != 8 && flags.bits != 16)
        fail_usage("--bits: {}; it must be 8 or 16", flags.bits);
    const fs::path folder = require_replaced_folder("-o", flags.output, check_bake_folder);
    const fs::path part = unfinished_file(folder);
    require_unfinished_file(part, flags.resume);
    const PathAndNote chosen = flags.light.empty() ? sun_path_of(flags) : light_path_of(flags);
    const BakePath& path = chosen.path;
    if (path.steps() == 0) {
        print(fmt::format("{}{}\nno sun, no bake\n", chosen.note, path.summary));
        return;
    }
    BakeOptions options{.texel_size_m = flags.texel_m,
                        .bits = static_cast<BakeBits>(flags.bits),
                        .method = flags.method,
                        .most_pairs = flags.pairs,
                        .ignore_alpha = flags.ignore_alpha};
    const Scene scene = load(flags.scene, session, progress);
    options.texel_option = "--texel";
    options.resume_file = part;
    std::error_code ignored;
    try {
        const IntervalBake bake = bake_intervals(scene, path, options, progress);
        progress.clear();
        for (const std::string& warning : bake.report.warnings)
            print_warning(warning);
        write_bake(folder, bake);
        if (is_unfinished_bake(part)) fs::remove(part, ignored);
        print(chosen.note + summary(bake, folder.string()));
    } catch (const Error& error) {
        const bool is_kept = fs::exists(part, ignored);
        if (error.kind() == ErrorKind::input || !is_kept) throw;
        throw Error(error.kind(),
                    fmt::format("{}; what is done is kept in {}: --resume goes on with it",
                                error.what(), part.string()));
    }
}

}  // namespace

Command add_bake(CLI::App& program) {
    CLI::App* const app =
        add_command(program, "bake", "Bake when each texel of a static scene sees the sun of a day",
                    "gnomon bake SCENE --sun place=..,date=.. [--texel M] -o DIR", kExamples);
    const auto flags = std::make_shared<BakeFlags>();
    app->add_option("SCENE", flags->scene, "a .gltf, .glb or .obj file, or a built-in scene");
    app->add_option("--sun", flags->sun, "place=..,date=..[,utc=..][,north=..][,steps=..]")
        ->type_name("WHERE,WHEN");
    app->add_option("--light", flags->light,
                    "path=FILE.json[,diameter=..][,steps=..]: another light, by key frames")
        ->type_name("PATH");
    add_number(*app, "--texel", flags->texel_m, {1e-6, 1e6},
               "side of a texel, metres (default 0.1)");
    add_integer(*app, "--bits", flags->bits, {8, 16}, "of a time: 8, or 16 (default 8)");
    add_integer(*app, "--pairs", flags->pairs, {1, 16},
                "most pairs of textures, four intervals each (default 4)");
    add_parsed(
        *app, "--method", "NAME",
        "interval_traversal, or rays: one for each texel and step, slower (default "
        "interval_traversal)",
        [flags](const std::string& text) { flags->method = parse_method("--method", text); });
    app->add_flag("--ignore-alpha", flags->ignore_alpha, "take masked materials for solid");
    app->add_flag("--resume", flags->resume, "go on with an interrupted bake");
    app->add_option("-o,--output", flags->output, "the folder to write")->type_name("DIR");
    return {app, [flags](const Session& session, ConsoleProgress& progress) {
                run_bake(*flags, session, progress);
            }};
}

}  // namespace gnomon::cli
