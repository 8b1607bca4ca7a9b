#pragma once

#include <gnomon/scene.h>

#include "parse.h"
#include "progress.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <string>
#include <vector>

namespace gnomon::cli {

/// Flags that every command takes.
struct Globals {
    std::string device;
    bool validation = false;
    int threads = 0;
    bool quiet = false;
    LoadOptions load;
};

/// What main knows when a command runs.
struct Session {
    Globals globals;
    std::vector<ParamFlag> param_flags;
};

/// A subcommand and what it does once its flags are parsed.
struct Command {
    CLI::App* app = nullptr;
    std::function<void(const Session&, ConsoleProgress&)> run;
    bool takes_params = false;  ///< of techniques: --shadow_map.map_size 1024
    bool shows_globals = true;  ///< in its help
};

/// Each adds its command with its flags to the program.
Command add_info(CLI::App& program);
Command add_scene(CLI::App& program);
Command add_render(CLI::App& program);
Command add_compare(CLI::App& program);
Command add_bench(CLI::App& program);
Command add_bake(CLI::App& program);
Command add_sun(CLI::App& program);
Command add_web(CLI::App& program);

}  // namespace gnomon::cli
