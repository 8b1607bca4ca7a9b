#include "interval/mask.h"

#include <bit>

namespace gnomon::interval {

std::vector<Interval> intervals(Mask mask) {
    std::vector<Interval> runs;
    bool lit = false;
    for (std::size_t word = 0; word < mask.size(); ++word) {
        // Bits that differ from the step before.
        std::uint64_t edges = mask[word] ^ (mask[word] << 1 | std::uint64_t{lit});
        for (; edges != 0; edges &= edges - 1) {
            const int step = static_cast<int>(64 * word) + std::countr_zero(edges);
            if (!lit) {
                runs.push_back({step, step});
            } else {
                runs.back().fall = step;
            }
            lit = !lit;
        }
    }
    if (lit) runs.back().fall = static_cast<int>(64 * mask.size());
    return runs;
}

int lit_steps(Mask mask) {
    int count = 0;
    for (const std::uint64_t word : mask)
        count += std::popcount(word);
    return count;
}

}  // namespace gnomon::interval
