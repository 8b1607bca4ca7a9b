#pragma once

#include <gnomon/bake.h>

#include "bake/exact_times.h"
#include "bake/interval_codes.h"
#include "bake/kept_blocks.h"
#include "interval/adaptive.h"
#include "interval/mask.h"
#include "interval/path.h"
#include "interval/tree.h"
#include "trace/receiver.h"
#include "trace/tracer.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace gnomon::bake {

/// One scene and one path of the light, ready to be asked when receivers see it.
class LightDay {
public:
    /// Keeps the scene alive. Throws Error{machine} when memory runs out, Error{cancelled}.
    LightDay(Scene scene, BakePath path, BakeOptions options, Progress& progress);

    const Scene& scene() const { return scene_; }
    const BakePath& path() const { return path_; }
    int codes() const { return path_.steps() * codes_per_step(options_.bits); }  ///< of the path

    /// When each receiver sees the light. Throws Error{cancelled}.
    std::vector<LitTimes> times(std::span<const trace::Receiver> receivers,
                                Progress& progress) const;

    /// The same, found in blocks. Those that are done go to the options' `resume_file`, if that has
    /// a name and there is room, every half minute, when the work is stopped or fails, and when all
    /// is done; a later call for the same begins with them. Throws Error{input} when the file is of
    /// another bake, Error{machine} before the work when the file would not fit on its disk,
    /// Error{cancelled}.
    std::vector<LitTimes> kept_times(std::span<const trace::Receiver> receivers,
                                     Progress& progress) const;

private:
    /// Finds the blocks that are not `done`.
    void find(std::span<const trace::Receiver> receivers, std::span<LitTimes> times,
              std::span<const std::uint8_t> done, KeptBlocks* kept, Progress& progress) const;
    /// On the calling thread.
    void find_some(std::span<const trace::Receiver> receivers, std::span<LitTimes> times,
                   interval::AdaptiveTracer* tracer) const;

    Scene scene_;
    BakePath path_;
    BakeOptions options_;
    interval::Frame frame_;
    interval::DayPath steps_;
    std::optional<interval::Tree> tree_;           ///< of interval traversal
    std::shared_ptr<const trace::Tracer> tracer_;  ///< of rays and of exact times
    std::optional<ExactTimes> exact_;
};

}  // namespace gnomon::bake
