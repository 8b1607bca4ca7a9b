#include "flags.h"

#include <gnomon/technique.h>

#include "fail.h"
#include "output.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

namespace gnomon::cli {

namespace {

constexpr const char* kViewGroup = "View";
constexpr Range kThreads{0, 1024, ""};
constexpr Range kAnimationTime{0.0, 1e6, "seconds"};
constexpr Range kAnimation{0, 1e6, ""};
constexpr Range kExposure{1e-6, 1e6, ""};
constexpr Range kAmbient{0.0, 1e9, ""};

std::string long_name(const std::string& names) {
    return names.substr(names.find("--"));
}

std::vector<std::string_view> technique_names() {
    std::vector<std::string_view> names;
    for (const TechniqueInfo& info : techniques())
        names.push_back(info.name);
    return names;
}

/// `0 "sun", 1 "lamp"`: what an error tells of the things that can be chosen.
template <typename Things, typename NameOf>
std::string listing(const Things& things, NameOf name_of) {
    constexpr std::size_t kMaxListed = 12;
    std::string text;
    for (std::size_t i = 0; i < std::min(things.size(), kMaxListed); ++i) {
        text += fmt::format("{}{} \"{}\"", i == 0 ? "" : ", ", i, name_of(things[i]));
    }
    if (things.size() > kMaxListed) {
        text += fmt::format(" and {} more", things.size() - kMaxListed);
    }
    return text;
}

/// The index of the thing that `text` names, or whose index it is.
template <typename Things, typename NameOf>
std::size_t choose(std::string_view flag, std::string_view text, const Things& things,
                   NameOf name_of) {
    std::vector<std::string_view> names;
    for (const auto& thing : things)
        names.push_back(name_of(thing));
    const auto found = std::find(names.begin(), names.end(), text);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    const bool digits = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
        return std::isdigit(c) != 0;
    });
    if (!digits) {
        fail_usage("{}: the scene has no \"{}\"{}; it has {}", flag, text, suggestion(text, names),
                   names.empty() ? "none" : listing(things, name_of));
    }
    if (things.empty()) fail_usage("{}: the scene has none", flag);
    const Range indices{0, static_cast<double>(things.size() - 1), ""};
    return static_cast<std::size_t>(parse_integer(flag, text, indices));
}

/// Reports tell lights apart by name: the second "point" becomes "point_2".
void make_names_unique(std::vector<Light>& lights) {
    std::set<std::string> taken;
    for (Light& light : lights) {
        const std::string name = light_name(light);
        std::string unique = name;
        for (int i = 2; !taken.insert(unique).second; ++i) {
            unique = fmt::format("{}_{}", name, i);
        }
        std::visit([&](auto& member) { member.name = unique; }, light);
    }
}

void set_params(TechniqueChoice& choice, const Session& session) {
    const TechniqueInfo& info = find_technique(choice.name);
    for (const ParamFlag& flag : session.param_flags) {
        if (flag.technique != choice.name) continue;
        const ParamInfo& param = find_param(info.name, info.params(), flag.param);
        if (choice.params.values().contains(param.name)) {
            fail_usage("{}: is given twice", flag.written);
        }
        choice.params.set(param.name, parse_param(info.name, param, flag.value.value_or("true")));
    }
}

}  // namespace

void add_globals(CLI::App& app, Globals& globals, const std::string& group) {
    app.add_option("--device", globals.device, "Vulkan device: its index or part of its name")
        ->type_name("N|NAME")
        ->group(group);
    add_integer(app, "--threads", globals.threads, kThreads, "CPU threads; 0 = all cores (default)")
        ->group(group);
    add_parsed(app, "--up", "y|z", "axis that points up in an .obj file (default y)",
               [&globals](const std::string& text) {
                   constexpr std::string_view kAxes[] = {"y", "z"};
                   globals.load.up = parse_word("--up", text, kAxes) == "z" ? UpAxis::z : UpAxis::y;
               })
        ->group(group);
    add_number(app, "--animation-time", globals.load.animation_time_s, kAnimationTime,
               "pose of an animated scene, in seconds (default 0)")
        ->group(group);
    add_integer(app, "--animation", globals.load.animation, kAnimation,
                "which animation poses the scene (default 0)")
        ->group(group);
    app.add_flag("--validation", globals.validation,
                 "run under the Vulkan validation layer; fail if it reports anything")
        ->group(group);
    app.add_flag("--quiet", globals.quiet, "no progress on standard error")->group(group);
}

CLI::Option* add_parsed(CLI::App& app, const std::string& name, const std::string& type,
                        const std::string& meaning,
                        const std::function<void(const std::string&)>& parse) {
    return app.add_option_function<std::string>(name, parse, meaning)->type_name(type);
}

CLI::Option* add_integer(CLI::App& app, const std::string& name, int& target, Range range,
                         const std::string& meaning) {
    return add_parsed(app, name, "N", meaning, [&target, name, range](const std::string& text) {
        target = static_cast<int>(parse_integer(long_name(name), text, range));
    });
}

CLI::Option* add_number(CLI::App& app, const std::string& name, double& target, Range range,
                        const std::string& meaning) {
    return add_parsed(app, name, "X", meaning, [&target, name, range](const std::string& text) {
        target = parse_number(long_name(name), text, range);
    });
}

void add_camera(CLI::App& app, ViewFlags& flags) {
    app.add_option("SCENE", flags.scene,
                   "a .glb, .gltf or .obj file, or a built-in scene (gnomon scene --list)");
    add_parsed(app, "--size", "WxH", "pixels (default 1280x720)",
               [&flags](const std::string& text) { flags.size = parse_size("--size", text); })
        ->group(kViewGroup);
    add_parsed(app, "--camera", "CAMERA",
               "eye=x,y,z,target=x,y,z[,fov=degrees][,near=metres], in the file's coordinates; or "
               "the index or name of a camera of the scene (default: its first)",
               [&flags](const std::string& text) {
                   if (is_camera_pose(text)) parse_camera(text);  // wrong ones fail before loading
                   flags.camera = text;
               })
        ->group(kViewGroup);
}

void add_ignore_alpha(CLI::App& app, ViewFlags& flags) {
    app.add_flag("--ignore-alpha", flags.ignore_alpha,
                 "alpha masks count as solid, for the eye and for light")
        ->group(kViewGroup);
}

void add_view(CLI::App& app, ViewFlags& flags) {
    add_camera(app, flags);
    app.add_option_function<std::vector<std::string>>(
           "--light",
           [&flags](const std::vector<std::string>& texts) {
               for (const std::string& text : texts)
                   parse_light(text);
               flags.lights = texts;
           },
           "a light instead of the scene's own, such as sun:elevation=35,azimuth=120 or "
           "point:position=0,3,0; may be given several times. "
           "Kinds: sun, point, spot, sphere, disc, rect")
        ->type_name("LIGHT")
        ->allow_extra_args(false)
        ->group(kViewGroup);
    app.add_option("--lights", flags.chosen_lights,
                   "which of the scene's own lights, by name or index: 0,2 (default all)")
        ->type_name("A,B|all")
        ->group(kViewGroup);
    add_parsed(app, "--time", "HH:MM",
               "of a bake, whose folder SCENE may be: the light is the bake's at that time of its "
               "clock (HH:MM:SS.sss too)",
               [&flags](const std::string& text) {
                   parse_clock("--time", text);
                   flags.time = text;
               })
        ->group(kViewGroup);
    add_ignore_alpha(app, flags);
}

void add_lighting(CLI::App& app, LightingOptions& options) {
    const std::string group = "Picture";
    add_parsed(app, "--exposure", "X", "factor on radiance (default: bright parts become white)",
               [&options](const std::string& text) {
                   options.exposure =
                       static_cast<float>(parse_number("--exposure", text, kExposure));
               })
        ->group(group);
    add_parsed(app, "--ambient", "X|R,G,B",
               "radiance from everywhere (default: a tenth of the lights' mean effect)",
               [&options](const std::string& text) {
                   options.ambient = parse_color("--ambient", text, kAmbient);
               })
        ->group(group);
    add_parsed(app, "--compose", "additive|subtractive",
               "additive sums the lights that arrive (default); subtractive darkens the fully lit "
               "picture, as the classical methods did",
               [&options](const std::string& text) {
                   constexpr std::string_view kWays[] = {"additive", "subtractive"};
                   options.compose = parse_word("--compose", text, kWays) == "subtractive"
                                         ? Compose::subtractive
                                         : Compose::additive;
               })
        ->group(group);
}

void require_scene(const std::string& command, const ViewFlags& flags) {
    if (!flags.scene.empty()) return;
    fail_usage(
        "{0}: SCENE is missing: a file, or a name of gnomon scene --list (gnomon {0} --help)",
        command);
}

Scene load(const std::string& file, const Session& session, ConsoleProgress& progress) {
    Scene scene = load_scene(file, session.globals.load, progress);
    progress.clear();
    for (const std::string& warning : scene.warnings())
        print_warning(warning);
    progress.check();
    return scene;
}

FileFrame file_frame(const Scene& scene, const std::string& file, const Session& session) {
    std::string extension = std::filesystem::path(file).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const bool z_up = extension == ".obj" && session.globals.load.up == UpAxis::z;
    return {scene.origin_offset_m(), z_up};
}

Camera choose_camera(const Scene& scene, const ViewFlags& flags, const Session& session) {
    if (is_camera_pose(flags.camera)) {
        return parse_camera(flags.camera, file_frame(scene, flags.scene, session));
    }
    if (scene.cameras().empty()) {
        fail_usage("{}: has no camera; give one with --camera eye=x,y,z,target=x,y,z",
                   scene.source());
    }
    if (flags.camera.empty()) return scene.cameras().front();
    const auto name_of = [](const Camera& camera) -> std::string_view { return camera.name; };
    return scene.cameras()[choose("--camera", flags.camera, scene.cameras(), name_of)];
}

std::vector<Light> choose_lights(const Scene& scene, const ViewFlags& flags,
                                 const Session& session) {
    std::vector<Light> lights;
    if (!flags.lights.empty()) {
        if (!flags.chosen_lights.empty()) {
            fail_usage("--lights chooses among the scene's lights, which --light replaces");
        }
        const FileFrame frame = file_frame(scene, flags.scene, session);
        for (const std::string& text : flags.lights)
            lights.push_back(parse_light(text, frame));
    } else if (flags.chosen_lights.empty() || flags.chosen_lights == "all") {
        lights = scene.lights();
    } else {
        const auto name_of = [](const Light& light) -> std::string_view {
            return light_name(light);
        };
        for (const std::string& text : parse_list("--lights", flags.chosen_lights)) {
            lights.push_back(scene.lights()[choose("--lights", text, scene.lights(), name_of)]);
        }
    }
    if (lights.empty()) {
        fail_usage("{}: has no light; give one with --light sun:elevation=35,azimuth=120",
                   scene.source());
    }
    make_names_unique(lights);
    return lights;
}

std::vector<TechniqueChoice> choose_techniques(const std::string& names, const Session& session) {
    std::vector<TechniqueChoice> choices;
    if (names == "all") {
        for (const TechniqueInfo& info : techniques()) {
            choices.push_back({std::string(info.name), {}});
        }
    } else {
        for (const std::string& name : parse_list("--techniques", names)) {
            choices.push_back({std::string(find_technique(name).name), {}});
        }
    }
    for (TechniqueChoice& choice : choices)
        set_params(choice, session);
    for (const ParamFlag& flag : session.param_flags) {
        const bool chosen = std::any_of(choices.begin(), choices.end(), [&](const auto& choice) {
            return choice.name == flag.technique;
        });
        if (!chosen) {
            fail_usage("{}: {} is not among the techniques that are to run: {}", flag.written,
                       flag.technique, names.empty() ? "none" : names);
        }
    }
    return choices;
}

bool is_switch(const ParamFlag& flag) {
    const std::vector<std::string_view> names = technique_names();
    if (std::find(names.begin(), names.end(), flag.technique) == names.end()) {
        fail_usage("{}: there is no technique \"{}\"{}; techniques: {}", flag.written,
                   flag.technique, suggestion(flag.technique, names), join(names));
    }
    const TechniqueInfo& info = find_technique(flag.technique);
    return find_param(info.name, info.params(), flag.param).type == ParamType::boolean;
}

ContextOptions context_options(const Session& session) {
    return {.device = session.globals.device,
            .validation = session.globals.validation,
            .threads = session.globals.threads};
}

void check_validation(const Context& context) {
    const std::vector<std::string> messages = context.validation_messages();
    if (messages.empty()) return;
    constexpr std::size_t kMaxShown = 10;  // one fault is reported at each draw
    const std::size_t shown = std::min(messages.size(), kMaxShown);
    for (std::size_t i = 0; i < shown; ++i)
        print_warning(messages[i]);
    throw Error(ErrorKind::machine,
                fmt::format("the validation layer reported {} faults; the first {} are above",
                            messages.size(), shown));
}

}  // namespace gnomon::cli
