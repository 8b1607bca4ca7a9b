#include "report/page.h"

#include "page_parts.h"
#include "report/format.h"
#include "report/mustache.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numeric>

namespace gnomon::report {

namespace {

using nlohmann::json;

std::string css_percent(double part, double whole) {
    return fmt::format("{:.3f}%", whole > 0.0 ? 100.0 * part / whole : 0.0);
}

/// What a column is sorted by, and shown as.
json cell(double value, const std::string& text) {
    return {{"value", fmt::format("{:.9g}", value)}, {"text", text}};
}

json bar_cell(double value, double greatest, const std::string& text) {
    json result = cell(value, text);
    result["bar"] = css_percent(value, greatest);
    return result;
}

/// Of the supported results, the greatest value that `get` reads.
template <typename Get>
double greatest(const ComparisonReport& report, Get get) {
    double most = 0.0;
    for (const TechniqueResult& result : report.results) {
        if (result.supported) most = std::max(most, get(result));
    }
    return most;
}

double artefact(const Comparison& error) {
    return error.artefact_lit + error.artefact_shadow;
}

json names(const TechniqueResult& result, std::size_t index) {
    return {{"id", index + 1},
            {"technique", result.technique},
            {"title", result.title.empty() ? result.technique : result.title},
            {"light", result.light},
            {"supported", result.supported},
            {"note", result.note}};
}

json summary_row(const ComparisonReport& report, std::size_t index) {
    const TechniqueResult& result = report.results[index];
    const Comparison& error = result.error;
    json row = names(result, index);
    if (!result.supported) return row;
    const double most_rmse =
        greatest(report, [](const TechniqueResult& other) { return other.error.rmse; });
    const double most_ms =
        greatest(report, [](const TechniqueResult& other) { return other.total_ms.median; });
    const double stray = error.stray_lit + error.stray_shadow;
    const double ms = result.total_ms.median;
    row["rmse"] = bar_cell(error.rmse, most_rmse, short_number(error.rmse));
    row["false_lit"] = cell(error.false_lit, short_percent(error.false_lit));
    row["false_shadow"] = cell(error.false_shadow, short_percent(error.false_shadow));
    row["stray"] = cell(stray, short_percent(stray));
    row["artefact"] = cell(artefact(error), short_percent(artefact(error)));
    row["has_artefacts"] = artefact(error) > 0.0;
    row["flip"] = cell(result.flip, short_number(result.flip));
    row["ms"] = bar_cell(ms, most_ms, short_number(ms));
    row["memory"] =
        cell(static_cast<double>(result.memory_bytes), short_bytes(result.memory_bytes));
    return row;
}

/// All results, the smallest error first, unsupported ones last.
json summary(const ComparisonReport& report) {
    std::vector<std::size_t> order(report.results.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        const TechniqueResult& first = report.results[a];
        const TechniqueResult& second = report.results[b];
        if (first.supported != second.supported) return first.supported;
        return first.supported && first.error.rmse < second.error.rmse;
    });
    json rows = json::array();
    for (const std::size_t index : order)
        rows.push_back(summary_row(report, index));
    return rows;
}

/// The parts of a render's wall-clock time: passes, host work, and what neither explains.
json time_parts(const TechniqueResult& result) {
    constexpr int kColors = 8;           // .pass-0 to .pass-7 in page.css
    constexpr double kLeastRest = 0.01;  // of the total: less is noise between medians
    const double total = result.total_ms.median;
    double known = result.cpu_ms.median;
    for (const PassTime& pass : result.passes)
        known += pass.ms;
    const double whole = std::max(total, known);

    json parts = json::array();
    const auto add = [&](const std::string& name, double ms, const std::string& color) {
        parts.push_back({{"name", name},
                         {"ms", short_number(ms)},
                         {"width", css_percent(ms, whole)},
                         {"color", color}});
    };
    int color = 0;
    for (const PassTime& pass : result.passes) {
        add(pass.name, pass.ms, fmt::format("pass-{}", color++ % kColors));
    }
    if (result.cpu_ms.median > 0.0) add("host", result.cpu_ms.median, "host");
    if (total - known > kLeastRest * total) add("waiting and copies", total - known, "rest");
    return parts;
}

json error_table(const Comparison& error) {
    return {{{"kind", "false"},
             {"meaning", "lit where T < 0.1, dark where T > 0.9"},
             {"lit", short_percent(error.false_lit)},
             {"shadow", short_percent(error.false_shadow)}},
            {{"kind", "stray"},
             {"meaning", "of false: away from any true edge"},
             {"lit", short_percent(error.stray_lit)},
             {"shadow", short_percent(error.stray_shadow)}},
            {{"kind", "artefact"},
             {"meaning", "of false: farther than its texels explain"},
             {"lit", short_percent(error.artefact_lit)},
             {"shadow", short_percent(error.artefact_shadow)}}};
}

json worst_crop(const Window& window, Extent size) {
    return {{"left", css_percent(window.x, size.width)},
            {"top", css_percent(window.y, size.height)},
            {"box_width", css_percent(window.width, size.width)},
            {"box_height", css_percent(window.height, size.height)},
            {"columns", window.width},
            {"rows", window.height},
            {"strip_width", 3 * window.width * kWorstScale + 2 * kWorstGap_px},
            {"strip_height", window.height * kWorstScale},
            {"at", fmt::format("x {}–{}, y {}–{}", window.x, window.x + window.width - 1, window.y,
                               window.y + window.height - 1)}};
}

json result_view(const ComparisonReport& report, const Layout& layout, std::size_t index) {
    const TechniqueResult& result = report.results[index];
    const ResultLayout& files = layout.results[index];
    json view = names(result, index);
    if (!result.supported) return view;
    const Comparison& error = result.error;
    view["picture"] = files.picture;
    view["visibility"] = files.visibility;
    view["difference"] = files.difference;
    view["worst"] = files.worst;
    view["worst_crop"] = worst_crop(files.worst_window, report.options.size);
    view["rmse"] = short_number(error.rmse);
    view["mae"] = short_number(error.mae);
    view["flip"] = short_number(result.flip);
    view["artefact"] = short_percent(artefact(error));
    view["has_artefacts"] = artefact(error) > 0.0;
    view["errors"] = error_table(error);
    view["judged"] = grouped(error.pixels);
    view["total"] = short_number(result.total_ms.median);
    view["total_min"] = short_number(result.total_ms.min);
    view["total_max"] = short_number(result.total_ms.max);
    view["gpu"] = short_number(result.gpu_ms.median);
    view["cpu"] = short_number(result.cpu_ms.median);
    view["prepare"] = short_number(result.prepare_ms);
    view["memory"] = short_bytes(result.memory_bytes);
    view["parts"] = time_parts(result);
    view["parameters"] = json::array();
    for (const auto& [name, value] : result.parameters) {
        view["parameters"].push_back({{"name", name}, {"value", to_string(value)}});
    }
    return view;
}

json light_view(const ComparisonReport& report, const Layout& layout, std::size_t light) {
    const TruthResult& truth = report.truths[light];
    json view = {{"number", light + 1},
                 {"light", truth.light},
                 {"kind", truth.light_kind},
                 {"seconds", short_number(truth.seconds)},
                 {"truth_picture", layout.truths[light].picture},
                 {"truth_visibility", layout.truths[light].visibility},
                 {"results", json::array()}};
    for (std::size_t i = 0; i < report.results.size(); ++i) {
        if (layout.results[i].light == light) {
            view["results"].push_back(result_view(report, layout, i));
        }
    }
    return view;
}

std::string device_text(const DeviceInfo& device) {
    std::string text(device_type_name(device.type));
    if (!device.api.empty()) text += ", Vulkan " + device.api;
    if (!device.driver.empty()) text += ", " + device.driver;
    return text;
}

std::string offset_text(DVec3 offset) {
    if (offset == DVec3(0.0)) return {};
    return fmt::format("{:.10g}, {:.10g}, {:.10g} m", offset.x, offset.y, offset.z);
}

/// What holds for the whole page.
json head_view(const ComparisonReport& report) {
    const CompareOptions& options = report.options;
    const std::string file_name = std::filesystem::path(report.scene).filename().string();
    const std::size_t lights = report.truths.size();
    return {{"css", kPageCss},
            {"js", kPageJs},
            {"gradient", difference_gradient_css()},
            {"version", report.version},
            {"scene", report.scene},
            {"scene_name", file_name.empty() ? report.scene : file_name},
            {"device", report.device.name},
            {"device_text", device_text(report.device)},
            {"width", options.size.width},
            {"height", options.size.height},
            {"samples", options.reference_samples},
            {"seed", options.seed},
            {"timing_frames", options.timing_frames},
            {"triangles", grouped(report.triangles)},
            {"instances", grouped(report.instances)},
            {"light_count", lights},
            {"one_light", lights == 1},
            {"one_technique", report.results.size() == lights},
            {"technique_count", report.results.size() / std::max<std::size_t>(lights, 1)},
            {"ignore_alpha", options.ignore_alpha},
            {"subtractive", options.lighting.compose == Compose::subtractive},
            {"origin_offset", offset_text(report.origin_offset_m)},
            {"warnings", report.warnings},
            {"has_warnings", !report.warnings.empty()},
            {"warning_count", report.warnings.size()},
            {"one_warning", report.warnings.size() == 1},
            {"worst_side", kWorstSide_px}};
}

}  // namespace

std::string page(const ComparisonReport& report, const Layout& layout) {
    json view = head_view(report);
    view["summary"] = summary(report);
    view["lights"] = json::array();
    for (std::size_t i = 0; i < report.truths.size(); ++i) {
        view["lights"].push_back(light_view(report, layout, i));
    }
    return fill_template(kPageHtml, view);
}

}  // namespace gnomon::report
