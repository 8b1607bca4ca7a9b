#include "bake/light_day.h"

#include <gnomon/error.h>

#include "bake/ray_steps.h"
#include "bake/unfinished.h"
#include "base/parallel.h"
#include "base/part_progress.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace gnomon::bake {

namespace {

/// Texels between two looks at whether to stop: a second or so of work.
constexpr std::size_t kPartTexels = 1 << 16;

/// Receivers whose rays one task traces: those of a step fill some batches.
constexpr std::size_t kRayReceivers = 512;

constexpr std::string_view kTask = "baking the sun";

/// What the steps of a part take of its time, the rest being exact times; for the progress alone.
constexpr double kStepsShare = 0.6;

/// A full disk is no reason to lose the error that stopped the work, or the bake itself, which is
/// smaller and may still fit.
void save_if_possible(const Unfinished& unfinished, std::span<const LitTimes> times) {
    try {
        unfinished.save(times);
    } catch (const Error&) {
    }
}

}  // namespace

LightDay::LightDay(Scene scene, BakePath path, BakeOptions options, Progress& progress)
    : scene_(std::move(scene)),
      path_(std::move(path)),
      options_(std::move(options)),
      frame_(interval::frame_around(path_.pole_ws)),
      steps_(path_.to_light_ws, frame_) {
    const bool by_rays = options_.method == BakeMethod::rays;
    const bool is_exact = options_.bits == BakeBits::sixteen;
    if (!by_rays) tree_.emplace(scene_, frame_, options_.ignore_alpha, progress);
    if (by_rays || is_exact) {
        tracer_ = std::make_shared<const trace::Tracer>(scene_, options_.ignore_alpha, progress);
    }
    if (is_exact) exact_.emplace(tracer_, path_.to_light_ws);
}

interval::DayMasks LightDay::masks(std::span<const trace::Receiver> receivers,
                                   Progress& progress) const {
    if (tree_) return interval::bake(*tree_, steps_, receivers, progress);
    interval::DayMasks masks;
    masks.steps = steps_.steps();
    const std::size_t words = masks.words_per_mask();
    masks.words.resize(receivers.size() * words);
    parallel_for(
        receivers.size(), kRayReceivers,
        [&](std::size_t first, std::size_t last) {
            ray_masks(*tracer_, steps_.to_sun_ws(), receivers.subspan(first, last - first),
                      std::span(masks.words).subspan(first * words, (last - first) * words));
        },
        kTask, &progress);
    return masks;
}

std::vector<LitTimes> LightDay::times(std::span<const trace::Receiver> receivers,
                                      Progress& progress) const {
    const double steps_share = exact_ ? kStepsShare : 1.0;
    PartProgress steps(progress, kTask, 0.0, steps_share);
    const interval::DayMasks masks = this->masks(receivers, steps);
    const int codes = codes_per_step(options_.bits);
    std::vector<LitTimes> times(receivers.size());
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        for (const interval::Interval& lit : interval::intervals(masks.mask(i))) {
            times[i].push_back({static_cast<std::uint16_t>(lit.rise * codes),
                                static_cast<std::uint16_t>(lit.fall * codes)});
        }
    }
    PartProgress exact(progress, kTask, steps_share, 1.0 - steps_share);
    if (exact_) exact_->refine(receivers, times, exact);
    return times;
}

std::vector<LitTimes> LightDay::kept_times(std::span<const trace::Receiver> receivers,
                                           Progress& progress) const {
    const bool is_kept = !options_.resume_file.empty();
    const Unfinished unfinished(options_.resume_file,
                                is_kept ? fingerprint(scene_, path_, options_, receivers) : 0,
                                receivers.size());
    std::vector<LitTimes> done = unfinished.load();
    done.reserve(receivers.size());  // growing it would take three times as much
    const auto all = static_cast<double>(receivers.size());
    try {
        while (done.size() < receivers.size()) {
            const std::size_t count = std::min(kPartTexels, receivers.size() - done.size());
            PartProgress part(progress, kTask, static_cast<double>(done.size()) / all,
                              static_cast<double>(count) / all);
            std::ranges::move(times(receivers.subspan(done.size(), count), part),
                              std::back_inserter(done));
        }
    } catch (...) {
        save_if_possible(unfinished, done);
        throw;
    }
    save_if_possible(unfinished, done);
    return done;
}

}  // namespace gnomon::bake
