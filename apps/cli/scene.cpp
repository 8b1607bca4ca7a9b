#include <gnomon/scene.h>

#include "command.h"
#include "fail.h"
#include "flags.h"
#include "help.h"
#include "output.h"

#include <algorithm>
#include <memory>

namespace gnomon::cli {

namespace {

constexpr const char* kExamples = R"(Examples:
  gnomon scene --list
  gnomon scene courtyard -o courtyard.glb)";

struct SceneFlags {
    std::string name, output;
    bool list = false;
};

std::string list_text() {
    std::size_t columns = 0;
    for (const BuiltinSceneInfo& info : builtin_scenes()) {
        columns = std::max(columns, info.name.size());
    }
    std::string text;
    for (const BuiltinSceneInfo& info : builtin_scenes()) {
        text += fmt::format("{:<{}}  {}\n", info.name, columns, info.summary);
    }
    return text;
}

void run_scene(const SceneFlags& flags, ConsoleProgress& progress) {
    if (flags.list) {
        print(list_text());
        return;
    }
    if (flags.name.empty()) fail_usage("scene: NAME is missing (gnomon scene --list tells them)");
    if (flags.output.empty()) fail_usage("scene: -o is missing, as in -o {}.glb", flags.name);
    require_output_file("-o", flags.output, ".glb");
    const Scene scene = make_builtin_scene(flags.name);
    progress.check();
    write_glb(flags.output, scene);
    print(fmt::format("{}: {} triangles, {} instances\n", flags.output, scene.triangle_count(),
                      scene.instances().size()));
}

}  // namespace

Command add_scene(CLI::App& program) {
    CLI::App* const app =
        add_command(program, "scene", "Write a built-in scene as a .glb file",
                    "gnomon scene NAME -o FILE.glb\n       gnomon scene --list", kExamples);
    const auto flags = std::make_shared<SceneFlags>();
    app->add_option("NAME", flags->name, "the built-in scene");
    app->add_option("-o,--output", flags->output, "the file to write")->type_name("FILE.glb");
    app->add_flag("--list", flags->list, "list the built-in scenes");
    return {app,
            [flags](const Session&, ConsoleProgress& progress) { run_scene(*flags, progress); },
            false, false};
}

}  // namespace gnomon::cli
