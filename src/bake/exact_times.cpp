#include "bake/exact_times.h"

#include "bake/fine_path.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <utility>

namespace gnomon::bake {

namespace {

/// Leaves out what has no length, and joins what touches.
void tidy(LitTimes& times) {
    LitTimes tidied;
    for (const CodedInterval& interval : times) {
        if (interval.fall <= interval.rise) continue;
        if (!tidied.empty() && tidied.back().fall >= interval.rise) {
            tidied.back().fall = interval.fall;
        } else {
            tidied.push_back(interval);
        }
    }
    times = std::move(tidied);
}

}  // namespace

/// A change, which is at one of the codes [low, high]: the first that is lit, if the light rises,
/// else the first that is dark.
struct ExactTimes::Search {
    std::uint32_t receiver;
    std::uint32_t low, high;
    bool rises;

    std::uint32_t middle() const { return (low + high) / 2; }
    bool found() const { return low == high; }
    void tell(bool lit) {
        if (lit == rises) {
            high = middle();
        } else {
            low = middle() + 1;
        }
    }
};

ExactTimes::ExactTimes(std::shared_ptr<const trace::Tracer> tracer,
                       std::span<const DVec3> to_light_ws)
    : tracer_(std::move(tracer)),
      to_light_ws_(fine_path(to_light_ws, kParts)),
      steps_(static_cast<int>(to_light_ws.size())),
      closed_(path_ends({.to_light_ws = {to_light_ws.begin(), to_light_ws.end()}}).closed) {}

std::vector<ExactTimes::Search> ExactTimes::searches_of(std::span<const LitTimes> times) const {
    const std::uint32_t end = static_cast<std::uint32_t>(steps_) * kParts;
    std::vector<Search> searches;
    for (std::uint32_t receiver = 0; receiver < times.size(); ++receiver) {
        // A change of a step's code lies between the middles of it and of the one before.
        const auto add = [&](std::uint32_t code, bool rises) {
            constexpr std::uint32_t kHalf = kParts / 2;
            searches.push_back(
                {receiver, code - std::min(code, kHalf), std::min(code + kHalf, end), rises});
        };
        for (const CodedInterval& interval : times[receiver]) {
            add(interval.rise, true);
            add(interval.fall, false);
        }
    }
    return searches;
}

void ExactTimes::search(std::span<const trace::Receiver> receivers,
                        std::span<Search> searches) const {
    // Rays that are alike one after the other: by time, and those of neighbours together.
    std::vector<Search*> open;
    for (Search& search : searches)
        open.push_back(&search);
    std::ranges::stable_sort(open, {}, &Search::low);
    std::vector<trace::ShadowRay> rays;
    std::vector<Search*> asked;
    std::vector<std::uint8_t> blocked;
    while (!open.empty()) {
        rays.clear();
        asked.clear();
        for (Search* const search : open) {
            const trace::Receiver& receiver = receivers[search->receiver];
            const DVec3 to_light = to_light_ws_[search->middle()];
            if (glm::dot(DVec3(receiver.normal_ws), to_light) > 0.0) {
                rays.push_back({&receiver, Vec3(to_light), true});
                asked.push_back(search);
            } else {
                search->tell(false);
            }
        }
        blocked.resize(rays.size());
        tracer_->blocked(rays, blocked);
        for (std::size_t i = 0; i < rays.size(); ++i)
            asked[i]->tell(blocked[i] == 0);
        std::erase_if(open, [](const Search* search) { return search->found(); });
    }
}

/// What is lit at one end of a closed path, from that end on, and not at the other, may change in
/// the other's half step, where nothing was found.
void ExactTimes::refine_over_ends(std::span<const trace::Receiver> receivers,
                                  std::span<LitTimes> times) const {
    constexpr std::uint32_t kHalf = kParts / 2;
    const std::uint32_t end = static_cast<std::uint32_t>(steps_) * kParts;
    std::vector<Search> searches;
    for (std::uint32_t receiver = 0; receiver < times.size(); ++receiver) {
        if (times[receiver].empty()) continue;
        const bool begins = times[receiver].front().rise == 0;
        const bool lasts = times[receiver].back().fall == end;
        if (begins && !lasts) searches.push_back({receiver, end - kHalf, end, true});
        if (lasts && !begins) searches.push_back({receiver, 0, kHalf, false});
    }
    search(receivers, searches);
    for (const Search& found : searches) {
        LitTimes& lit = times[found.receiver];
        const auto code = static_cast<std::uint16_t>(found.low);
        if (found.rises) {
            lit.push_back({code, static_cast<std::uint16_t>(end)});
        } else {
            lit.insert(lit.begin(), {0, code});
        }
        tidy(lit);
    }
}

void ExactTimes::refine(std::span<const trace::Receiver> receivers,
                        std::span<LitTimes> times) const {
    std::vector<Search> searches = searches_of(times);
    search(receivers, searches);
    auto found = searches.begin();
    for (LitTimes& of_receiver : times) {
        for (CodedInterval& interval : of_receiver) {
            interval.rise = static_cast<std::uint16_t>((found++)->low);
            interval.fall = static_cast<std::uint16_t>((found++)->low);
        }
        tidy(of_receiver);
    }
    if (closed_) refine_over_ends(receivers, times);
}

}  // namespace gnomon::bake
