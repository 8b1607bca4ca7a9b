#include <gnomon/error.h>

#include "command.h"
#include "facts.h"
#include "flags.h"
#include "help.h"
#include "output.h"

#include <nlohmann/json.hpp>

#include <memory>

namespace gnomon::cli {

namespace {

constexpr const char* kExamples = R"(Examples:
  gnomon info
  gnomon info --json > machine.json
  gnomon info --scene city.obj --up z)";

struct InfoFlags {
    bool json = false;
    std::string scene;
};

void run_info(const InfoFlags& flags, const Session& session, ConsoleProgress& progress) {
    if (!flags.scene.empty()) {
        const Scene scene = load(flags.scene, session, progress);
        const FileFrame frame = file_frame(scene, flags.scene, session);
        print(flags.json ? dump(scene_json(scene, frame)) : scene_text(scene, frame));
        return;
    }
    std::vector<DeviceInfo> devices;
    std::string device_fault;
    try {
        devices = list_devices();
        if (devices.empty()) device_fault = "the Vulkan loader finds no device";
    } catch (const Error& error) {
        device_fault = error.what();  // the techniques can be told all the same
    }
    print(flags.json ? dump(machine_json(devices, device_fault))
                     : machine_text(devices, device_fault));
}

}  // namespace

Command add_info(CLI::App& program) {
    CLI::App* const app = add_command(
        program, "info", "Tell about devices, techniques and their parameters, or about a scene",
        "gnomon info [--json] [--scene SCENE]", kExamples);
    const auto flags = std::make_shared<InfoFlags>();
    app->add_flag("--json", flags->json, "as JSON");
    app->add_option("--scene", flags->scene,
                    "what is in this scene, and what its loader warns of, instead")
        ->type_name("SCENE");
    return {app, [flags](const Session& session, ConsoleProgress& progress) {
                run_info(*flags, session, progress);
            }};
}

}  // namespace gnomon::cli
