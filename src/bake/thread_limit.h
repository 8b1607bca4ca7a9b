#pragma once

#include "base/check.h"

#include <tbb/global_control.h>

#include <optional>

namespace gnomon::bake {

/// Keeps work to so many threads while it lives; 0 = all cores.
class ThreadLimit {
public:
    explicit ThreadLimit(int threads) {
        if (threads < 0) {
            fail_input("sun hours: threads is {}; it must be 0 (all cores) or above", threads);
        }
        if (threads == 0) return;
        limit_.emplace(tbb::global_control::max_allowed_parallelism,
                       static_cast<std::size_t>(threads));
    }

private:
    std::optional<tbb::global_control> limit_;
};

}  // namespace gnomon::bake
