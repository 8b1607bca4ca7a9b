#pragma once

#include <gnomon/bake.h>

#include "bake/interval_codes.h"
#include "trace/receiver.h"
#include "trace/tracer.h"

#include <memory>
#include <span>
#include <vector>

namespace gnomon::bake {

/// Finds when between two steps the light rises or falls at a receiver: to the 64th of a step.
class ExactTimes {
public:
    static constexpr int kParts = codes_per_step(BakeBits::sixteen);

    ExactTimes(std::shared_ptr<const trace::Tracer> tracer, std::span<const DVec3> to_light_ws);

    /// `times` of each receiver: in, intervals in codes that are whole steps, as the directions in
    /// the middle of steps find them; out, of which each change has moved by up to half a step to
    /// where rays find it, after a bisection. What is seen nowhere but in the middle of a step is
    /// left out, and where there is more than one change between two middles one of them is told.
    /// Over the ends of a closed path it is sought as between two other middles.
    /// Depends on a receiver and its times alone. Some hundred receivers have enough rays that are
    /// alike. Runs on the calling thread.
    void refine(std::span<const trace::Receiver> receivers, std::span<LitTimes> times) const;

private:
    struct Search;
    std::vector<Search> searches_of(std::span<const LitTimes> times) const;
    void search(std::span<const trace::Receiver> receivers, std::span<Search> searches) const;
    void refine_over_ends(std::span<const trace::Receiver> receivers,
                          std::span<LitTimes> times) const;

    std::shared_ptr<const trace::Tracer> tracer_;
    std::vector<DVec3> to_light_ws_;  ///< of each part of each step
    int steps_;
    bool closed_;
};

}  // namespace gnomon::bake
