#include <gnomon/lighting.h>
#include <gnomon/vertex_lighting.h>

#include "command.h"
#include "fail.h"
#include "flags.h"
#include "help.h"
#include "lit_scene.h"
#include "output.h"

#include <filesystem>
#include <memory>

namespace gnomon::cli {

namespace {

constexpr const char* kExamples = R"(Examples:
  gnomon render courtyard -o courtyard.png
  gnomon render model.glb -o frame.png --technique shadow_map --shadow_map.map_size 4096
  gnomon render model.glb -o frame.png --size 1920x1080 --samples 1024 \
      --camera eye=8,5,8,target=0,1,0,fov=45 --light sun:elevation=35,azimuth=120
  gnomon render torches -o frame.png --lights 0,3 --visibility visibility.exr
  gnomon render day -o morning.png --time 10:30

SCENE may be a folder of gnomon bake: the light is the bake's at --time, and its shadows are looked
up in the bake (occlusion_interval_maps). Else one technique is chosen for the device, the light and
the view (auto), unless --technique names it; with --samples the picture shows the ray-traced truth.
Every parameter of a technique is a flag; gnomon info lists them.)";

constexpr int kMaxSamples = 65536;  // TraceOptions::samples

struct RenderFlags {
    ViewFlags view;
    LightingOptions lighting;
    std::string output, visibility, technique;
    int samples = 0;  ///< 0 = not given
    std::string shading = "pixel";
};

constexpr std::string_view kShadings[] = {"pixel", "vertex", "vertex_flat"};
/// Whose parameters say how vertices are traced.
constexpr const char* kVertexTechnique = "vertex_occlusion";

/// visibility.exr for one light; visibility.0.exr, visibility.1.exr for several.
std::filesystem::path visibility_path(const RenderFlags& flags, std::size_t light,
                                      std::size_t light_count) {
    std::filesystem::path path = flags.visibility;
    if (light_count > 1) path.replace_extension(fmt::format(".{}.exr", light));
    return path;
}

void check_flags(const RenderFlags& flags) {
    require_scene("render", flags.view);
    check_time("render", flags.view);
    if (flags.output.empty()) fail_usage("render: -o is missing, as in -o frame.png");
    require_output_file("-o", flags.output, ".png");
    if (!flags.visibility.empty()) require_output_file("--visibility", flags.visibility, ".exr");
    if (!flags.technique.empty() && flags.samples != 0) {
        fail_usage(
            "--samples is for the ray-traced truth; with --technique ray_traced use "
            "--ray_traced.samples");
    }
}

/// Of --lighting vertex: how the technique's parameters would have it.
VertexLightingOptions vertex_options(const RenderFlags& flags, const Session& session) {
    constexpr std::uint64_t kThousand = 1000;
    const auto fail = [&](std::string_view flag) {
        fail_usage("{}: is not for --lighting {}, which has light for vertices, not visibility",
                   flag, flags.shading);
    };
    if (!flags.technique.empty()) fail("--technique");
    if (!flags.visibility.empty()) fail("--visibility");
    if (flags.samples != 0) fail("--samples");
    if (flags.lighting.compose == Compose::subtractive) fail("--compose subtractive");
    VertexLightingOptions options{.ignore_alpha = flags.view.ignore_alpha};
    const TechniqueChoice choice = choose_techniques(kVertexTechnique, session).front();
    for (const auto& [name, value] : choice.params.values()) {
        if (name == "tessellate") options.edge_m = std::get<double>(value);
        if (name == "samples") options.samples = std::get<int>(value);
        if (name == "vertices")
            options.most_vertices = kThousand * static_cast<std::uint64_t>(std::get<int>(value));
        if (name == "walls") options.walls = std::get<bool>(value);
    }
    return options;
}

/// The technique of --technique, or auto; for the truth none.
std::vector<TechniqueChoice> choose_technique(const RenderFlags& flags, const Session& session) {
    const std::string otherwise(names_bake(flags.view) ? bake_technique().name : "auto");
    const std::string name = flags.technique.empty() ? otherwise : flags.technique;
    find_technique(name);  // one, not a list or "all"
    const bool is_truth = flags.samples != 0;
    for (const ParamFlag& flag : session.param_flags) {
        if (flags.technique.empty() && (is_truth || flag.technique != name)) {
            const std::string chosen = otherwise == "auto" ? "what auto chooses" : otherwise;
            fail_usage("{}: needs --technique {}; without it {} is rendered", flag.written,
                       flag.technique, is_truth ? "the ray-traced truth" : chosen);
        }
    }
    return is_truth ? std::vector<TechniqueChoice>() : choose_techniques(name, session);
}

std::vector<Visibility> see_lights(Context& context, Frame& frame, const std::vector<Light>& lights,
                                   const std::vector<TechniqueChoice>& choice, int samples,
                                   ConsoleProgress& progress) {
    std::unique_ptr<Technique> technique;
    if (!choice.empty()) {
        technique = make_technique(context, choice.front());
        technique->prepare(frame.scene, progress);
    }
    std::vector<Visibility> visibilities;
    for (const Light& light : lights) {
        progress.check();
        frame.light = light;
        if (technique) {
            technique->render(frame, visibilities.emplace_back(), progress);
            const std::string warning = technique->last_render().warning;
            if (!warning.empty()) {
                progress.clear();
                print_warning(
                    fmt::format("{}, {}: {}", choice.front().name, light_name(light), warning));
            }
        } else {
            visibilities.push_back(
                trace_visibility(context, frame, {.samples = samples}, progress));
        }
    }
    return visibilities;
}

void write_visibilities(const RenderFlags& flags, const std::vector<Light>& lights,
                        const std::vector<Visibility>& visibilities) {
    for (std::size_t i = 0; i < lights.size() && !flags.visibility.empty(); ++i) {
        const std::filesystem::path path = visibility_path(flags, i, lights.size());
        write_exr(path, visibilities[i].image());
        print(fmt::format("visibility of {}: {}\n", light_name(lights[i]), path.string()));
    }
}

Image vertex_picture(Context& context, const Frame& frame, const std::vector<Light>& lights,
                     const RenderFlags& flags, const VertexLightingOptions& options,
                     ConsoleProgress& progress) {
    const VertexLighting vertices(frame.scene, lights, options, progress);
    Image picture = vertex_lit_picture(
        context, frame, vertices, lights, flags.lighting,
        flags.shading == "vertex_flat" ? VertexShading::flat : VertexShading::averaged);
    progress.clear();
    print(fmt::format("{} vertices, cut edges of {:.2g} m or less\n", vertices.vertices(),
                      vertices.edge_m()));
    return picture;
}

void run_render(const RenderFlags& flags, const Session& session, ConsoleProgress& progress) {
    check_flags(flags);
    const bool by_pixel = flags.shading == kShadings[0];
    VertexLightingOptions vertices;
    std::vector<TechniqueChoice> choice;
    if (by_pixel) {
        choice = choose_technique(flags, session);
    } else {
        vertices = vertex_options(flags, session);
    }
    LitScene lit = load_lit(flags.view, session, progress);
    look_up(lit.bake, choice);
    Frame frame;
    frame.scene = lit.scene;
    frame.size = flags.view.size;
    frame.ignore_alpha = flags.view.ignore_alpha;
    frame.camera = choose_camera(frame.scene, flags.view, session);

    Context context(context_options(session));
    std::vector<Visibility> visibilities;
    Image picture;
    if (by_pixel) {
        visibilities = see_lights(context, frame, lit.lights, choice, flags.samples, progress);
        std::vector<LitBy> lit_by;
        for (std::size_t i = 0; i < lit.lights.size(); ++i)
            lit_by.push_back({lit.lights[i], &visibilities[i]});
        picture = light_picture(context, frame, lit_by, flags.lighting);
    } else {
        picture = vertex_picture(context, frame, lit.lights, flags, vertices, progress);
    }
    progress.check();
    progress.clear();
    check_validation(context);

    write_png(flags.output, picture);
    print(fmt::format("picture: {}\n", flags.output));
    write_visibilities(flags, lit.lights, visibilities);
}

}  // namespace

Command add_render(CLI::App& program) {
    CLI::App* const app =
        add_command(program, "render", "Render a scene with the shadows of one technique",
                    "gnomon render SCENE -o FRAME.png [--technique NAME] [flags]", kExamples);
    const auto flags = std::make_shared<RenderFlags>();
    app->add_option("-o,--output", flags->output, "the picture to write")->type_name("FRAME.png");
    app->add_option("--visibility", flags->visibility,
                    "also write the visibility of the light, in [0, 1]; of several lights as "
                    "V.0.exr, V.1.exr")
        ->type_name("V.exr");
    app->add_option("--technique", flags->technique,
                    "how to find the shadows (default auto, which chooses one; of a bake "
                    "occlusion_interval_maps)")
        ->type_name("NAME");
    add_integer(*app, "--samples", flags->samples, {1, kMaxSamples, "rays"},
                "render the ray-traced truth, with so many rays per pixel and light (one if the "
                "light has no extent)");
    add_parsed(*app, "--lighting", "pixel|vertex|vertex_flat",
               "pixel: each pixel's light by the visibility there (default); vertex: light traced "
               "at vertices, with averaged L for normals between them; vertex_flat: without that. "
               "The parameters of vertex_occlusion say which vertices",
               [flags](const std::string& text) {
                   flags->shading = parse_word("--lighting", text, kShadings);
               })
        ->group("Picture");
    add_view(*app, flags->view);
    add_lighting(*app, flags->lighting);
    return {app,
            [flags](const Session& session, ConsoleProgress& progress) {
                run_render(*flags, session, progress);
            },
            true};
}

}  // namespace gnomon::cli
