#pragma once

#include <gnomon/context.h>
#include <gnomon/scene.h>
#include <gnomon/technique.h>

#include "view.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

/// What `gnomon info` tells, as text and as JSON.
namespace gnomon::cli {

using Json = nlohmann::ordered_json;  ///< keeps the order in which keys are written

/// Devices, or why there are none (`device_fault`), and the techniques with their parameters.
std::string machine_text(const std::vector<DeviceInfo>& devices, const std::string& device_fault);
Json machine_json(const std::vector<DeviceInfo>& devices, const std::string& device_fault);

/// Points are in the coordinates of the scene's file.
std::string scene_text(const Scene& scene, const FileFrame& frame);
Json scene_json(const Scene& scene, const FileFrame& frame);

/// JSON as text with a line break at its end; what is not UTF-8 in names becomes U+FFFD.
std::string dump(const Json& json);

}  // namespace gnomon::cli
