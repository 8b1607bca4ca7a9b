#pragma once

#include <gnomon/context.h>
#include <gnomon/lighting.h>
#include <gnomon/report.h>
#include <gnomon/scene.h>

#include "command.h"
#include "view.h"

#include <string>
#include <vector>

/// Flags that several commands share, and what they choose.
namespace gnomon::cli {

/// `group`: their heading in the help; empty = they are taken but not shown.
void add_globals(CLI::App& app, Globals& globals, const std::string& group);

/// A flag whose text is parsed while the command line is.
CLI::Option* add_parsed(CLI::App& app, const std::string& name, const std::string& type,
                        const std::string& meaning,
                        const std::function<void(const std::string&)>& parse);

/// A flag whose value is a whole number (or a number) in `range`.
CLI::Option* add_integer(CLI::App& app, const std::string& name, int& target, Range range,
                         const std::string& meaning);
CLI::Option* add_number(CLI::App& app, const std::string& name, double& target, Range range,
                        const std::string& meaning);

/// What is seen, under which lights, and how large.
struct ViewFlags {
    std::string scene;
    Extent size{1280, 720};
    std::string camera;               ///< empty: the scene's first
    std::vector<std::string> lights;  ///< "sun:elevation=.."; empty: the scene's own
    std::string chosen_lights;        ///< "all", or names or indices of the scene's own
    std::string time;                 ///< "10:30", of a bake's light
    bool ignore_alpha = false;
};
void add_view(CLI::App& app, ViewFlags& flags);
/// SCENE, --size and --camera alone, of add_view.
void add_camera(CLI::App& app, ViewFlags& flags);
void add_ignore_alpha(CLI::App& app, ViewFlags& flags);

void add_lighting(CLI::App& app, LightingOptions& options);

/// Throws Error{input} when there is no scene among the arguments.
void require_scene(const std::string& command, const ViewFlags& flags);

/// Loads the scene and prints its warnings.
Scene load(const std::string& file, const Session& session, ConsoleProgress& progress);

/// The coordinates of the file that `scene` was loaded from.
FileFrame file_frame(const Scene& scene, const std::string& file, const Session& session);

Camera choose_camera(const Scene& scene, const ViewFlags& flags, const Session& session);

/// At least one light, with names of their own.
std::vector<Light> choose_lights(const Scene& scene, const ViewFlags& flags,
                                 const Session& session);

/// The techniques of "a,b" or "all", with the parameters that flags give them.
std::vector<TechniqueChoice> choose_techniques(const std::string& names, const Session& session);

/// As take_param_flags wants it.
bool is_switch(const ParamFlag& flag);

ContextOptions context_options(const Session& session);

/// With --validation: prints what the layer said and throws Error{machine} if it said anything.
void check_validation(const Context& context);

}  // namespace gnomon::cli
