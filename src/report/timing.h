#pragma once

#include <gnomon/report.h>

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon::report {

/// What a technique took over some renders of one frame.
struct Timing {
    Spread total_ms;  ///< wall clock around render()
    Spread cpu_ms, gpu_ms;
    std::vector<std::pair<std::string, Spread>> passes;  ///< in the order of their first appearance
    std::uint64_t memory_bytes = 0;                      ///< the most of any render
};

/// Median, least and greatest of `values`; the median of an even number is the mean of its middle
/// two; all 0 for none.
Spread spread(std::vector<double> values);

/// `total_ms` holds the wall clock of each render, `stats` what the technique said of it. Passes of
/// one name are added within a render; a render without a pass spent 0 in it.
Timing summarize(std::vector<double> total_ms, std::span<const RenderStats> stats);

/// Renders `frame` `untimed` + `timed` times into `out`. Throws Error{cancelled}.
Timing time_renders(Technique& technique, const Frame& frame, int untimed, int timed,
                    std::string_view task, Progress& progress, Visibility& out);

/// Milliseconds that technique.prepare(scene) takes.
double time_prepare(Technique& technique, const Scene& scene, Progress& progress);

/// The options' techniques, or all there are. Throws Error{input} for an unknown technique or
/// parameter, before any work is done.
std::vector<TechniqueChoice> chosen_techniques(const CompareOptions& options);

/// Every parameter of the technique that counts: as chosen, else its default.
std::map<std::string, ParamValue> all_parameters(const TechniqueInfo& info,
                                                 const TechniqueChoice& chosen);

/// Whether it looks up a bake that is there.
bool looks_up_bake(const TechniqueChoice& choice);

/// Why the technique cannot shadow the light, naming those that it can; empty when it can.
std::string unsupported_note(const TechniqueInfo& info, const Light& light);

}  // namespace gnomon::report
