#include "report/results_json.h"

#include <gnomon/error.h>

#include "base/file.h"

#include <nlohmann/json.hpp>

#include <cstdint>

namespace gnomon::report {

namespace {

using nlohmann::ordered_json;

ordered_json to_json(const ParamValue& value) {
    return std::visit([](const auto& v) { return ordered_json(v); }, value);
}

ordered_json to_json(const Spread& spread) {
    return {{"median", spread.median}, {"min", spread.min}, {"max", spread.max}};
}

ordered_json to_json(const Camera& camera) {
    ordered_json view = ordered_json::array();  // column-major
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row)
            view.push_back(camera.view_from_world[column][row]);
    }
    return {{"name", camera.name},
            {"view_from_world", view},
            {"fov_y_rad", camera.fov_y_rad},
            {"near_m", camera.near_m},
            {"ortho_height_m", camera.ortho_height_m},
            {"ortho_depth_m", camera.ortho_depth_m}};
}

ordered_json error_json(const TechniqueResult& result) {
    const Comparison& error = result.error;
    return {{"mae", error.mae},
            {"rmse", error.rmse},
            {"false_lit", error.false_lit},
            {"false_shadow", error.false_shadow},
            {"stray_lit", error.stray_lit},
            {"stray_shadow", error.stray_shadow},
            {"artefact_lit", error.artefact_lit},
            {"artefact_shadow", error.artefact_shadow},
            {"flip", result.flip},
            {"pixels", error.pixels}};
}

ordered_json time_json(const TechniqueResult& result) {
    ordered_json passes = ordered_json::object();
    for (const PassTime& pass : result.passes)
        passes[pass.name] = pass.ms;
    return {{"prepare", result.prepare_ms},
            {"cpu", result.cpu_ms.median},
            {"gpu", result.gpu_ms.median},
            {"total", to_json(result.total_ms)},
            {"passes", passes}};
}

ordered_json images_json(const ResultLayout& files) {
    ordered_json images = {{"picture", files.picture},
                           {"visibility", files.visibility},
                           {"difference", files.difference}};
    if (!files.worst.empty()) {
        const Window& window = files.worst_window;
        images["worst"] = files.worst;
        images["worst_px"] = {window.x, window.y, window.width, window.height};
    }
    return images;
}

ordered_json result_json(const TechniqueResult& result, const ResultLayout& files) {
    ordered_json parameters = ordered_json::object();
    for (const auto& [name, value] : result.parameters)
        parameters[name] = to_json(value);
    const bool known = result.supported;
    return {{"technique", result.technique},
            {"light", result.light},
            {"light_kind", result.light_kind},
            {"parameters", parameters},
            {"error", known ? error_json(result) : ordered_json()},
            {"time_ms", known ? time_json(result) : ordered_json()},
            {"memory_bytes", known ? ordered_json(result.memory_bytes) : ordered_json()},
            {"supported", result.supported},
            {"note", result.note},
            {"images", known ? images_json(files) : ordered_json()}};
}

ordered_json head_json(const ComparisonReport& report) {
    const CompareOptions& options = report.options;
    const DVec3 offset = report.origin_offset_m;
    double seconds = 0.0;
    for (const TruthResult& truth : report.truths)
        seconds += truth.seconds;
    return {
        {"gnomon", report.version},
        {"device",
         {{"name", report.device.name},
          {"type", device_type_name(report.device.type)},
          {"driver", report.device.driver},
          {"api", report.device.api}}},
        {"scene",
         {{"file", report.scene},
          {"triangles", report.triangles},
          {"instances", report.instances},
          {"lights", report.truths.size()},
          {"origin_offset_m", {offset.x, offset.y, offset.z}},
          {"warnings", report.warnings}}},
        {"camera", to_json(options.camera)},
        {"size", {options.size.width, options.size.height}},
        {"ignore_alpha", options.ignore_alpha},
        {"compose", options.lighting.compose == Compose::additive ? "additive" : "subtractive"},
        {"timing_frames", options.timing_frames},
        {"reference",
         {{"samples", options.reference_samples}, {"seed", options.seed}, {"seconds", seconds}}}};
}

}  // namespace

std::string results_json(const ComparisonReport& report, const Layout& layout) {
    ordered_json json = head_json(report);
    json["truths"] = ordered_json::array();
    for (std::size_t i = 0; i < report.truths.size(); ++i) {
        const TruthResult& truth = report.truths[i];
        json["truths"].push_back({{"light", truth.light},
                                  {"light_kind", truth.light_kind},
                                  {"seconds", truth.seconds},
                                  {"images",
                                   {{"picture", layout.truths[i].picture},
                                    {"visibility", layout.truths[i].visibility}}}});
    }
    json["results"] = ordered_json::array();
    for (std::size_t i = 0; i < report.results.size(); ++i) {
        json["results"].push_back(result_json(report.results[i], layout.results[i]));
    }
    constexpr int kIndent = 2;
    // Names come from files, so bytes that are no UTF-8 become U+FFFD rather than an exception.
    return json.dump(kIndent, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

bool is_results_json(const std::filesystem::path& path) {
    constexpr std::uint64_t kMaxBytes = std::uint64_t{64} << 20;
    try {
        const std::vector<std::uint8_t> bytes = read_file(path, kMaxBytes);
        const ordered_json json = ordered_json::parse(bytes, nullptr, false);
        return json.is_object() && json.contains("gnomon") && json["gnomon"].is_string() &&
               json.contains("results");
    } catch (const Error&) {
        return false;  // missing, a folder, unreadable: not ours
    }
}

}  // namespace gnomon::report
