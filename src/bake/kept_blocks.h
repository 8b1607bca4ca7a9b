#pragma once

#include "bake/interval_codes.h"
#include "bake/unfinished.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

namespace gnomon::bake {

/// Keeps what is done of a bake: now and then while it goes on, so that a power cut costs little,
/// and when it ends.
class KeptBlocks {
public:
    using Clock = std::chrono::steady_clock;

    /// `times` of all texels, into which blocks are found; the spans of those that are `done` do
    /// not change any more. Both arguments that are referred to must live as long.
    KeptBlocks(const Unfinished& file, std::span<const LitTimes> times,
               std::vector<std::uint8_t> done, Clock::duration save_every = kSaveEvery);

    /// The block is done: now, or once it is time, it is on the disk. From any thread.
    void add(std::size_t block);

    /// All that is done. A full disk is no reason to lose the error that stopped the work, or the
    /// bake itself, which is smaller and may still fit: it is not told.
    void save();

private:
    static constexpr Clock::duration kSaveEvery = std::chrono::seconds(30);

    const Unfinished& file_;
    std::span<const LitTimes> times_;
    Clock::duration save_every_;
    std::mutex mutex_;  ///< of what follows
    std::vector<std::uint8_t> done_;
    bool saves_ = false;  ///< some thread does
    Clock::time_point next_;
};

}  // namespace gnomon::bake
