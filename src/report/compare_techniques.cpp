#include <gnomon/bake.h>
#include <gnomon/report.h>

#include "base/check.h"
#include "base/parallel.h"
#include "report/timing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>

namespace gnomon {

namespace {

using namespace report;

/// A light with what is shared by all techniques that are judged on it.
struct Case {
    Frame frame;
    Visibility truth;
};

void check(const CompareOptions& options) {
    if (options.lights.empty()) fail_input("compare: the scene has no light: name one");
    if (options.timing_frames < 1) {
        fail_input("compare: timing_frames is {}, must be at least 1", options.timing_frames);
    }
}

Frame frame_of(const Scene& scene, const CompareOptions& options, const Light& light) {
    Frame frame{scene, options.camera, light, options.size, options.ignore_alpha};
    frame.validate();
    return frame;
}

Image lit_picture(Context& context, const Frame& frame, const Visibility& visibility,
                  const LightingOptions& lighting) {
    const std::array<LitBy, 1> lights = {LitBy{frame.light, &visibility}};
    return light_picture(context, frame, lights, lighting);
}

TruthResult trace_truth(Context& context, const CompareOptions& options, Case& judged,
                        Progress& progress) {
    using Clock = std::chrono::steady_clock;
    TruthResult result;
    result.light = light_name(judged.frame.light);
    result.light_kind = light_kind(judged.frame.light);
    const Clock::time_point start = Clock::now();
    judged.truth = trace_visibility(context, judged.frame,
                                    {options.reference_samples, options.seed}, progress);
    result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    result.mask = comparison_mask(context, judged.frame);
    result.visibility = judged.truth.image();
    result.picture_srgb = lit_picture(context, judged.frame, judged.truth, options.lighting);
    return result;
}

void add_sentence(std::string& text, std::string_view sentence) {
    if (!text.empty() && !sentence.empty()) text += ' ';
    text += sentence;
}

/// What a reader must know to judge the technique fairly on this light.
std::string supported_note(const TechniqueInfo& info, const Frame& frame) {
    const auto& materials = frame.scene.materials();
    const bool masked = std::any_of(materials.begin(), materials.end(),
                                    [](const Material& material) { return material.masked(); });
    std::string note;
    if (masked && !frame.ignore_alpha && !info.honors_alpha)
        add_sentence(note, "Alpha masks count as solid here but not in the truth.");
    if (!info.self_shadows)
        add_sentence(note, "No object casts a shadow on itself here, as in the truth they do.");
    if (has_extent(frame.light) && info.penumbra == Penumbra::none) {
        add_sentence(note,
                     "Shadows are hard; the light has an extent, so the truth has penumbrae.");
    }
    return note;
}

TechniqueResult blank_result(const TechniqueInfo& info, const TechniqueChoice& choice,
                             const TruthResult& truth) {
    TechniqueResult result;
    result.technique = info.name;
    result.title = info.title;
    result.light = truth.light;
    result.light_kind = truth.light_kind;
    result.parameters = all_parameters(info, choice);
    return result;
}

void judge(Context& context, const CompareOptions& options, const Case& judged,
           const TruthResult& truth, Technique& technique, Progress& progress,
           TechniqueResult& result) {
    constexpr int kUntimedFrames = 1;  // allocations, shader compilation, cold caches
    const std::string task = fmt::format("timing {} on {}", result.technique, result.light);
    Visibility visibility;
    const Timing timing = time_renders(technique, judged.frame, kUntimedFrames,
                                       options.timing_frames, task, progress, visibility);
    result.total_ms = timing.total_ms;
    result.cpu_ms = timing.cpu_ms;
    result.gpu_ms = timing.gpu_ms;
    for (const auto& [name, ms] : timing.passes)
        result.passes.push_back({name, ms.median});
    result.memory_bytes = timing.memory_bytes;
    throw_if_cancelled(progress, task);

    result.error = compare(visibility, judged.truth, truth.mask);
    result.visibility = visibility.image();
    result.picture_srgb = lit_picture(context, judged.frame, visibility, options.lighting);
    throw_if_cancelled(progress, task);
    result.flip = flip(truth.picture_srgb, result.picture_srgb);
}

/// Results of one technique on every light. The technique, and what it holds, is gone afterwards.
void run_technique(Context& context, const TechniqueChoice& choice, std::span<const Case> cases,
                   Progress& progress, ComparisonReport& report) {
    const TechniqueInfo& info = find_technique(choice.name);
    std::unique_ptr<Technique> technique;
    double prepare_ms = 0.0;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        TechniqueResult result = blank_result(info, choice, report.truths[i]);
        result.note = unsupported_note(info, cases[i].frame.light);
        result.supported = result.note.empty();
        if (result.supported) {
            if (!technique) {
                technique = make_technique(context, choice);
                prepare_ms = time_prepare(*technique, cases[i].frame.scene, progress);
            }
            result.note = supported_note(info, cases[i].frame);
            result.prepare_ms = prepare_ms;
            judge(context, report.options, cases[i], report.truths[i], *technique, progress,
                  result);
            const RenderStats stats = technique->last_render();
            add_sentence(result.note, looks_up_bake(choice) ? fmt::format("Looks up the bake: {}.",
                                                                          choice.bake->path.summary)
                                                            : stats.note);
            add_sentence(result.note, stats.warning);
            result.warning = stats.warning;
        }
        report.results.push_back(std::move(result));
    }
}

}  // namespace

ComparisonReport compare_techniques(Context& context, const Scene& scene,
                                    const CompareOptions& options, Progress& progress) {
    check(options);
    ComparisonReport report;
    report.version = GNOMON_VERSION;
    report.device = context.device();
    report.scene = scene.source();
    report.triangles = scene.triangle_count();
    report.instances = scene.instances().size();
    report.origin_offset_m = scene.origin_offset_m();
    report.warnings = scene.warnings();
    report.options = options;
    report.options.techniques = chosen_techniques(options);

    std::vector<Case> cases;
    for (const Light& light : options.lights) {
        throw_if_cancelled(progress, "comparing");
        Case& judged = cases.emplace_back(Case{frame_of(scene, options, light), {}});
        report.truths.push_back(trace_truth(context, options, judged, progress));
    }
    for (const TechniqueChoice& choice : report.options.techniques) {
        throw_if_cancelled(progress, "comparing");
        run_technique(context, choice, cases, progress, report);
    }
    return report;
}

}  // namespace gnomon
