#include "bake/light_day.h"

#include "bake/ray_steps.h"
#include "bake/unfinished.h"
#include "base/parallel.h"
#include "base/part_progress.h"

#include <tbb/enumerable_thread_specific.h>

#include <utility>

namespace gnomon::bake {

namespace {

constexpr std::string_view kTask = "baking the sun";

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

void LightDay::find_some(std::span<const trace::Receiver> receivers, std::span<LitTimes> times,
                         interval::AdaptiveTracer* tracer) const {
    const auto words = static_cast<std::size_t>(steps_.words());
    std::vector<std::uint64_t> masks(receivers.size() * words);
    if (tracer != nullptr) {
        tracer->trace(receivers, masks);
    } else {
        ray_masks(*tracer_, steps_.to_sun_ws(), receivers, masks);
    }
    const int codes = codes_per_step(options_.bits);
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const interval::Mask mask = interval::Mask(masks).subspan(i * words, words);
        for (const interval::Interval& lit : interval::intervals(mask)) {
            times[i].push_back({static_cast<std::uint16_t>(lit.rise * codes),
                                static_cast<std::uint16_t>(lit.fall * codes)});
        }
    }
    if (exact_) exact_->refine(receivers, times);
}

void LightDay::find(std::span<const trace::Receiver> receivers, std::span<LitTimes> times,
                    std::span<const std::uint8_t> done, KeptBlocks* kept,
                    Progress& progress) const {
    std::vector<std::size_t> open;
    for (std::size_t number = 0; number < done.size(); ++number) {
        if (done[number] == 0) open.push_back(number);
    }
    tbb::enumerable_thread_specific<interval::AdaptiveTracer> tracers(
        [&] { return interval::AdaptiveTracer(*tree_, steps_); });
    const double open_share = static_cast<double>(open.size()) / static_cast<double>(done.size());
    PartProgress part(progress, kTask, 1.0 - open_share, open_share);
    parallel_for(
        open.size(), 1,
        [&](std::size_t i, std::size_t) {
            const Block block = block_of(open[i], receivers.size());
            find_some(receivers.subspan(block.first, block.count),
                      times.subspan(block.first, block.count), tree_ ? &tracers.local() : nullptr);
            if (kept != nullptr) kept->add(open[i]);
        },
        kTask, &part);
}

std::vector<LitTimes> LightDay::times(std::span<const trace::Receiver> receivers,
                                      Progress& progress) const {
    std::vector<LitTimes> times(receivers.size());
    const std::vector<std::uint8_t> none(block_count(receivers.size()), 0);
    find(receivers, times, none, nullptr, progress);
    return times;
}

std::vector<LitTimes> LightDay::kept_times(std::span<const trace::Receiver> receivers,
                                           Progress& progress) const {
    if (options_.resume_file.empty()) return times(receivers, progress);
    const Unfinished unfinished(options_.resume_file,
                                fingerprint(scene_, path_, options_, receivers), receivers.size());
    FoundTimes found = unfinished.load();
    KeptBlocks kept(unfinished, found.times, found.done);
    try {
        find(receivers, found.times, found.done, &kept, progress);
    } catch (...) {
        kept.save();
        throw;
    }
    kept.save();
    return std::move(found.times);
}

}  // namespace gnomon::bake
