#pragma once

#include <gnomon/lighting.h>
#include <gnomon/metrics.h>
#include <gnomon/technique.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace gnomon {

struct TechniqueChoice {
    std::string name;
    Params params;
    /// What bake_technique() looks up instead of baking; others ignore it.
    std::shared_ptr<const IntervalBake> bake = nullptr;
};

/// Throws as those of <gnomon/technique.h> do.
std::unique_ptr<Technique> make_technique(Context& context, const TechniqueChoice& choice);

struct CompareOptions {
    std::vector<TechniqueChoice> techniques;  ///< empty = all with their defaults
    Camera camera;
    std::vector<Light> lights;  ///< each is judged by itself
    Extent size{1280, 720};
    int reference_samples = 256;
    unsigned seed = 1;
    bool ignore_alpha = false;
    LightingOptions lighting;
    int timing_frames = 5;  ///< renders per result that are timed, after one that is not
};

struct Spread {
    double median = 0.0, min = 0.0, max = 0.0;
};

/// One technique on one light.
struct TechniqueResult {
    std::string technique, title, light, light_kind;
    std::map<std::string, ParamValue> parameters;  ///< all of them, defaults included
    Comparison error;
    double flip = 0.0;
    double prepare_ms = 0.0;
    Spread cpu_ms, gpu_ms, total_ms;
    std::vector<PassTime> passes;  ///< medians, device time
    std::uint64_t memory_bytes = 0;
    bool supported = true;
    std::string note;     ///< why it is not supported, or what the reader must know
    std::string warning;  ///< RenderStats::warning, which `note` has too

    Image visibility;    ///< 1 channel
    Image picture_srgb;  ///< 3 channels, this light alone
};

/// One light's truth.
struct TruthResult {
    std::string light, light_kind;
    double seconds = 0.0;
    Image visibility, picture_srgb;
    ComparisonMask mask;
};

struct ComparisonReport {
    std::string version;
    DeviceInfo device;
    std::string scene;
    std::uint64_t triangles = 0, instances = 0;
    DVec3 origin_offset_m{0.0};
    std::vector<std::string> warnings;
    CompareOptions options;
    std::vector<TruthResult> truths;       ///< one per light
    std::vector<TechniqueResult> results;  ///< technique-major, then light
};

/// Every chosen technique on every light of the options, against ray-traced truth. A light that a
/// technique cannot shadow is a result with supported = false.
ComparisonReport compare_techniques(Context& context, const Scene& scene,
                                    const CompareOptions& options, Progress& progress);

/// results.json, images and index.html: a self-contained folder that opens from disk. The folder is
/// made, or, if it holds an earlier report, replaced whole.
/// Throws Error{machine} when it cannot be written, Error{input} when it holds something else.
void write_report(const std::filesystem::path& folder, const ComparisonReport& report,
                  Progress& progress);

/// Throws Error{input} when write_report would refuse `folder`: to be called before the hours of
/// work that a report can take.
void check_report_folder(const std::filesystem::path& folder);

/// A fixed-width table of the results, one line each, as `gnomon compare` prints it.
std::string table(const ComparisonReport& report);

/// One technique timed on one light.
struct BenchResult {
    std::string technique, light;
    Spread total_ms, cpu_ms, gpu_ms;
    std::vector<std::pair<std::string, Spread>> passes;
    double prepare_ms = 0.0;
    std::uint64_t memory_bytes = 0;
    bool supported = true;
    std::string note;  ///< why it is not supported, or RenderStats::warning
};

/// Times each chosen technique on the first light, `frames` renders after a warm-up of two.
std::vector<BenchResult> bench_techniques(Context& context, const Scene& scene,
                                          const CompareOptions& options, int frames,
                                          Progress& progress);

}  // namespace gnomon
