#include "bake/kept_blocks.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace gnomon::bake {

namespace {

/// A save of a large bake takes seconds: of one thread's time no more than this part.
constexpr int kSaveShare = 20;

}  // namespace

KeptBlocks::KeptBlocks(const Unfinished& file, std::span<const LitTimes> times,
                       std::vector<std::uint8_t> done, Clock::duration save_every)
    : file_(file),
      times_(times),
      save_every_(save_every),
      done_(std::move(done)),
      next_(Clock::now() + save_every) {}

void KeptBlocks::add(std::size_t block) {
    {
        const std::lock_guard lock(mutex_);
        done_[block] = 1;
        if (saves_ || Clock::now() < next_) return;
        saves_ = true;
    }
    const Clock::time_point begin = Clock::now();
    save();
    const Clock::duration took = Clock::now() - begin;
    const std::lock_guard lock(mutex_);
    saves_ = false;
    next_ = Clock::now() + std::max(save_every_, kSaveShare * took);
}

void KeptBlocks::save() {
    std::vector<std::uint8_t> done;
    {
        const std::lock_guard lock(mutex_);
        done = done_;
    }
    try {
        file_.save(times_, done);
    } catch (const std::exception&) {
    }
}

}  // namespace gnomon::bake
