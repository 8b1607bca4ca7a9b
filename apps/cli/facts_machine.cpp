#include <gnomon/light.h>

#include "facts.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gnomon::cli {

namespace {

std::string_view penumbra_name(Penumbra penumbra) {
    switch (penumbra) {
        case Penumbra::none:
            return "none";
        case Penumbra::fixed_width:
            return "fixed width";
        case Penumbra::physical:
            return "physical";
    }
    return "none";
}

std::string_view param_type_name(ParamType type) {
    switch (type) {
        case ParamType::boolean:
            return "boolean";
        case ParamType::integer:
            return "integer";
        case ParamType::number:
            return "number";
        case ParamType::choice:
            return "choice";
    }
    return "number";
}

bool is_numeric(const ParamInfo& param) {
    return param.type == ParamType::integer || param.type == ParamType::number;
}

/// "16 to 8192 texels", "nearest, hardware or box".
std::string allowed_text(const ParamInfo& param) {
    if (param.type == ParamType::boolean) return "true, false";
    if (param.type == ParamType::choice) return fmt::format("{}", fmt::join(param.choices, ", "));
    const std::string unit =
        param.unit.empty() || param.unit == "1" ? std::string() : " " + param.unit;
    return fmt::format("{} to {}{}", param.min, param.max, unit);
}

std::string device_text(const DeviceInfo& device) {
    std::string text = fmt::format("  {}  {}\n     {}, Vulkan {}, {}\n", device.index, device.name,
                                   device_type_name(device.type), device.api, device.driver);
    if (!device.usable) text += fmt::format("     cannot be used: {}\n", device.missing);
    std::vector<std::string_view> has, lacks;
    for (const auto& [name, present] : device.optional_features) {
        (present ? has : lacks).push_back(name);
    }
    if (!has.empty()) text += fmt::format("     has {}\n", fmt::join(has, ", "));
    if (!lacks.empty()) text += fmt::format("     lacks {}\n", fmt::join(lacks, ", "));
    return text;
}

std::string technique_text(const TechniqueInfo& info) {
    std::string text =
        fmt::format("  {}  {}\n     lights: {}; penumbra: {}; alpha masks: {}\n", info.name,
                    info.title, fmt::join(light_kinds(info.lights), ", "),
                    penumbra_name(info.penumbra), info.honors_alpha ? "honoured" : "solid");
    for (const ParamInfo& param : info.params()) {
        text += fmt::format("     --{}.{} {}\n         {}; {}\n", info.name, param.name,
                            to_string(param.default_value), param.meaning, allowed_text(param));
    }
    return text;
}

Json value_json(const ParamValue& value) {
    return std::visit([](const auto& member) { return Json(member); }, value);
}

Json param_json(const ParamInfo& param) {
    Json json = {{"name", param.name},
                 {"type", param_type_name(param.type)},
                 {"default", value_json(param.default_value)},
                 {"meaning", param.meaning}};
    if (is_numeric(param)) {
        json["min"] = param.min;
        json["max"] = param.max;
        json["unit"] = param.unit;
    }
    if (param.type == ParamType::choice) json["choices"] = param.choices;
    return json;
}

Json technique_json(const TechniqueInfo& info) {
    Json params = Json::array();
    for (const ParamInfo& param : info.params())
        params.push_back(param_json(param));
    return {{"name", info.name},
            {"title", info.title},
            {"source", info.source},
            {"lights", light_kinds(info.lights)},
            {"penumbra", penumbra_name(info.penumbra)},
            {"honors_alpha", info.honors_alpha},
            {"self_shadows", info.self_shadows},
            {"parameters", std::move(params)}};
}

Json device_json(const DeviceInfo& device) {
    Json features = Json::object();
    for (const auto& [name, present] : device.optional_features)
        features[name] = present;
    return {{"index", device.index},
            {"name", device.name},
            {"type", device_type_name(device.type)},
            {"driver", device.driver},
            {"api", device.api},
            {"usable", device.usable},
            {"missing", device.missing},
            {"optional_features", std::move(features)}};
}

}  // namespace

std::string machine_text(const std::vector<DeviceInfo>& devices, const std::string& device_fault) {
    std::string text = fmt::format("gnomon {}\n\nDevices\n", GNOMON_VERSION);
    for (const DeviceInfo& device : devices)
        text += device_text(device);
    if (!device_fault.empty()) text += fmt::format("  none: {}\n", device_fault);
    text += "\nTechniques, and their parameters as flags with their defaults\n";
    for (const TechniqueInfo& info : techniques())
        text += technique_text(info);
    return text;
}

Json machine_json(const std::vector<DeviceInfo>& devices, const std::string& device_fault) {
    Json device_list = Json::array();
    for (const DeviceInfo& device : devices)
        device_list.push_back(device_json(device));
    Json technique_list = Json::array();
    for (const TechniqueInfo& info : techniques())
        technique_list.push_back(technique_json(info));
    return {{"gnomon", GNOMON_VERSION},
            {"devices", std::move(device_list)},
            {"device_fault", device_fault},
            {"techniques", std::move(technique_list)}};
}

std::string dump(const Json& json) {
    constexpr int kIndent = 2;
    return json.dump(kIndent, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace gnomon::cli
