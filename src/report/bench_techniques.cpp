#include <gnomon/report.h>

#include "base/check.h"
#include "report/timing.h"

namespace gnomon {

namespace {

using namespace report;

BenchResult bench(Context& context, const Frame& frame, const TechniqueChoice& choice, int frames,
                  Progress& progress) {
    constexpr int kWarmUpFrames = 2;  // one allocates, one runs with warm caches
    const TechniqueInfo& info = find_technique(choice.name);
    BenchResult result;
    result.technique = info.name;
    result.light = light_name(frame.light);
    result.note = unsupported_note(info, frame.light);
    result.supported = result.note.empty();
    if (!result.supported) return result;

    const auto technique = make_technique(context, choice);
    result.prepare_ms = time_prepare(*technique, frame.scene, progress);
    Visibility visibility;
    Timing timing = time_renders(*technique, frame, kWarmUpFrames, frames, "timing " + choice.name,
                                 progress, visibility);
    result.total_ms = timing.total_ms;
    result.cpu_ms = timing.cpu_ms;
    result.gpu_ms = timing.gpu_ms;
    result.passes = std::move(timing.passes);
    result.memory_bytes = timing.memory_bytes;
    result.note = technique->last_render().warning;
    return result;
}

}  // namespace

std::vector<BenchResult> bench_techniques(Context& context, const Scene& scene,
                                          const CompareOptions& options, int frames,
                                          Progress& progress) {
    if (options.lights.empty()) fail_input("bench: the scene has no light: name one");
    if (frames < 1) fail_input("bench: {} frames, must be at least 1", frames);
    const Frame frame{scene, options.camera, options.lights.front(), options.size,
                      options.ignore_alpha};
    frame.validate();
    std::vector<BenchResult> results;
    for (const TechniqueChoice& choice : chosen_techniques(options)) {
        results.push_back(bench(context, frame, choice, frames, progress));
    }
    return results;
}

}  // namespace gnomon
