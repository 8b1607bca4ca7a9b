#include "bake/lit_times.h"

#include <gnomon/error.h>

#include "bake/exact_times.h"
#include "bake/unfinished.h"
#include "base/part_progress.h"
#include "interval/bake.h"

#include <algorithm>
#include <optional>

namespace gnomon::bake {

namespace {

/// Texels between two looks at whether to stop: a second or so of work.
constexpr std::size_t kPartTexels = 1 << 16;

constexpr std::string_view kTask = "baking the sun";

/// What the steps of a part take of its time, the rest being exact times; for the progress alone.
constexpr double kStepsShare = 0.6;

/// One place's scene and one day, ready to be asked.
class Day {
public:
    Day(const Scene& scene, const BakePath& path, const BakeOptions& options, Progress& progress)
        : frame_(interval::frame_around(path.pole_ws)),
          path_(path.to_light_ws, frame_),
          tree_(scene, frame_, options.ignore_alpha, progress) {
        if (options.bits == BakeBits::sixteen) {
            exact_.emplace(scene, path_.to_sun_ws(), options.ignore_alpha, progress);
        }
    }

    /// `begin` and `share` of the progress, both in [0, 1].
    std::vector<LitTimes> times(std::span<const trace::Receiver> receivers, double begin,
                                double share, Progress& progress) const {
        const double steps_share = exact_ ? kStepsShare * share : share;
        PartProgress steps(progress, kTask, begin, steps_share);
        const interval::DayMasks masks = interval::bake(tree_, path_, receivers, steps);
        const int codes = exact_ ? ExactTimes::kParts : codes_per_step(BakeBits::eight);
        std::vector<LitTimes> times(receivers.size());
        for (std::size_t i = 0; i < receivers.size(); ++i) {
            for (const interval::Interval& lit : interval::intervals(masks.mask(i))) {
                times[i].push_back({static_cast<std::uint16_t>(lit.rise * codes),
                                    static_cast<std::uint16_t>(lit.fall * codes)});
            }
        }
        PartProgress exact(progress, kTask, begin + steps_share, share - steps_share);
        if (exact_) exact_->refine(receivers, times, exact);
        return times;
    }

private:
    interval::Frame frame_;
    interval::DayPath path_;
    interval::Tree tree_;
    std::optional<ExactTimes> exact_;
};

}  // namespace

std::vector<LitTimes> lit_times(const Scene& scene, const BakePath& path,
                                const BakeOptions& options,
                                std::span<const trace::Receiver> receivers, Progress& progress) {
    const bool is_kept = !options.resume_file.empty();
    const Unfinished unfinished(options.resume_file,
                                is_kept ? fingerprint(scene, path, options, receivers) : 0,
                                receivers.size());
    std::vector<LitTimes> times = unfinished.load();
    if (times.size() == receivers.size()) return times;
    const auto all = static_cast<double>(receivers.size());
    try {
        const Day day(scene, path, options, progress);
        while (times.size() < receivers.size()) {
            const std::size_t done = times.size();
            const std::size_t count = std::min(kPartTexels, receivers.size() - done);
            std::ranges::move(
                day.times(receivers.subspan(done, count), static_cast<double>(done) / all,
                          static_cast<double>(count) / all, progress),
                std::back_inserter(times));
        }
    } catch (const Error&) {
        unfinished.save(times);
        throw;
    }
    try {
        unfinished.save(times);
    } catch (const Error&) {
        // The bake may still fit, which is smaller; else that will be told.
    }
    return times;
}

}  // namespace gnomon::bake
