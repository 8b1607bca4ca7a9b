#pragma once

#include <gnomon/bake.h>

#include "flags.h"

#include <memory>
#include <string>
#include <vector>

/// SCENE with what lights it: its own lights or those of --light, or a bake's at the time of
/// --time.
namespace gnomon::cli {

struct LitScene {
    Scene scene;
    std::vector<Light> lights;                 ///< at least one, with names of their own
    std::shared_ptr<const IntervalBake> bake;  ///< null when SCENE is none
};

/// Whether SCENE is a folder, which can only be a bake's.
bool names_bake(const ViewFlags& flags);

/// Throws Error{input} when --time is missing for a bake or given for another scene.
void check_time(const std::string& command, const ViewFlags& flags);

/// Loads the scene or the bake and prints its warnings.
LitScene load_lit(const ViewFlags& flags, const Session& session, ConsoleProgress& progress);

/// The technique that looks bakes up takes this one.
void look_up(const std::shared_ptr<const IntervalBake>& bake,
             std::vector<TechniqueChoice>& techniques);

}  // namespace gnomon::cli
