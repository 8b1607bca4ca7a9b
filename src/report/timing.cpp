#include "report/timing.h"

#include "base/parallel.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>

namespace gnomon::report {

namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double pass_ms(const RenderStats& stats, std::string_view name) {
    double ms = 0.0;
    for (const PassTime& pass : stats.passes) {
        if (pass.name == name) ms += pass.ms;
    }
    return ms;
}

std::vector<std::string> pass_names(std::span<const RenderStats> stats) {
    std::vector<std::string> names;
    for (const RenderStats& render : stats) {
        for (const PassTime& pass : render.passes) {
            if (std::find(names.begin(), names.end(), pass.name) == names.end()) {
                names.push_back(pass.name);
            }
        }
    }
    return names;
}

/// spread() of what `get` reads from each render.
template <typename Get>
Spread spread_of(std::span<const RenderStats> stats, Get get) {
    std::vector<double> values;
    for (const RenderStats& render : stats)
        values.push_back(get(render));
    return spread(std::move(values));
}

/// Hears of nothing, but passes on that the caller wants the work to end.
class OnlyCancels final : public Progress {
public:
    explicit OnlyCancels(const Progress& progress) : progress_(progress) {}
    bool cancelled() const override { return progress_.cancelled(); }

private:
    const Progress& progress_;
};

}  // namespace

Spread spread(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const std::size_t upper = values.size() / 2;
    const std::size_t lower = (values.size() - 1) / 2;
    return {0.5 * (values[lower] + values[upper]), values.front(), values.back()};
}

Timing summarize(std::vector<double> total_ms, std::span<const RenderStats> stats) {
    Timing timing;
    timing.total_ms = spread(std::move(total_ms));
    timing.cpu_ms = spread_of(stats, [](const RenderStats& render) { return render.cpu_ms; });
    timing.gpu_ms = spread_of(stats, [](const RenderStats& render) { return render.gpu_ms; });
    for (const std::string& name : pass_names(stats)) {
        timing.passes.emplace_back(name, spread_of(stats, [&](const RenderStats& render) {
                                       return pass_ms(render, name);
                                   }));
    }
    for (const RenderStats& render : stats) {
        timing.memory_bytes = std::max(timing.memory_bytes, render.memory_bytes);
    }
    return timing;
}

Timing time_renders(Technique& technique, const Frame& frame, int untimed, int timed,
                    std::string_view task, Progress& progress, Visibility& out) {
    std::vector<double> total_ms;
    std::vector<RenderStats> stats;
    OnlyCancels within(progress);
    for (int i = 0; i < untimed + timed; ++i) {
        throw_if_cancelled(progress, task);
        progress.report(task, static_cast<double>(i) / (untimed + timed));
        const Clock::time_point start = Clock::now();
        technique.render(frame, out, within);
        if (i < untimed) continue;
        total_ms.push_back(ms_since(start));
        stats.push_back(technique.last_render());
    }
    progress.report(task, 1.0);
    return summarize(std::move(total_ms), stats);
}

double time_prepare(Technique& technique, const Scene& scene, Progress& progress) {
    const Clock::time_point start = Clock::now();
    technique.prepare(scene, progress);
    return ms_since(start);
}

std::vector<TechniqueChoice> chosen_techniques(const CompareOptions& options) {
    std::vector<TechniqueChoice> chosen = options.techniques;
    if (chosen.empty()) {
        for (const TechniqueInfo& info : techniques())
            chosen.push_back({std::string(info.name), {}});
    }
    for (const TechniqueChoice& choice : chosen) {
        const TechniqueInfo& info = find_technique(choice.name);
        for (const auto& [name, value] : choice.params.values()) {
            find_param(info.name, info.params(), name);
        }
    }
    return chosen;
}

bool looks_up_bake(const TechniqueChoice& choice) {
    return choice.bake && !find_technique(choice.name).lookup_params.empty();
}

std::map<std::string, ParamValue> all_parameters(const TechniqueInfo& info,
                                                 const TechniqueChoice& chosen) {
    std::map<std::string, ParamValue> all;
    for (const ParamInfo& param : info.params()) {
        if (looks_up_bake(chosen) && std::ranges::count(info.lookup_params, param.name) == 0)
            continue;
        all[param.name] = param.default_value;
    }
    for (const auto& [name, value] : chosen.params.values()) {
        all[find_param(info.name, info.params(), name).name] = value;
    }
    return all;
}

std::string unsupported_note(const TechniqueInfo& info, const Light& light) {
    if (supports(info.lights, light)) return {};
    return fmt::format("no shadows of {} lights (it shadows: {})", light_kind(light),
                       info.lights == LightKinds::none
                           ? "none"
                           : fmt::to_string(fmt::join(light_kinds(info.lights), ", ")));
}

}  // namespace gnomon::report

namespace gnomon {

std::unique_ptr<Technique> make_technique(Context& context, const TechniqueChoice& choice) {
    if (report::looks_up_bake(choice)) return make_technique(context, *choice.bake, choice.params);
    return make_technique(context, choice.name, choice.params);
}

}  // namespace gnomon
