#include "base/parallel.h"

#include <gnomon/error.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <stdexcept>
#include <vector>

namespace gnomon {
namespace {

TEST(ParallelFor, VisitsEachIndexOnce) {
    for (const std::size_t count : {0u, 1u, 2u, 7u, 64u, 1000u}) {
        for (const std::size_t grain : {1u, 3u, 64u, 5000u}) {
            std::vector<std::atomic<int>> visits(count);
            std::atomic<std::size_t> longest = 0;
            parallel_for(count, grain, [&](std::size_t first, std::size_t last) {
                std::size_t seen = longest;
                while (last - first > seen && !longest.compare_exchange_weak(seen, last - first)) {
                }
                for (std::size_t i = first; i < last; ++i)
                    ++visits[i];
            });
            for (const std::atomic<int>& visit : visits)
                EXPECT_EQ(visit, 1) << count << " by " << grain;
            EXPECT_LE(longest, grain);
        }
    }
}

/// Remembers what it was told; asks to stop after some calls.
class Recorder : public Progress {
public:
    explicit Recorder(int reports_until_cancelled = 1 << 30) : left_(reports_until_cancelled) {}
    void report(std::string_view task, double fraction) override {
        const std::lock_guard lock(mutex_);
        task_ = task;
        fractions_.push_back(fraction);
        --left_;
    }
    bool cancelled() const override { return left_ <= 0; }

    std::string task_;
    std::vector<double> fractions_;

private:
    std::mutex mutex_;
    std::atomic<int> left_;
};

TEST(ParallelFor, ReportsEachPartOnceUpToTheWhole) {
    Recorder progress;
    parallel_for(
        100, 10, [](std::size_t, std::size_t) {}, "counting", &progress);
    EXPECT_EQ(progress.task_, "counting");
    ASSERT_GE(progress.fractions_.size(), 10u);
    // Threads may report out of order, but no two the same fraction.
    std::sort(progress.fractions_.begin(), progress.fractions_.end());
    EXPECT_EQ(std::adjacent_find(progress.fractions_.begin(), progress.fractions_.end()),
              progress.fractions_.end());
    EXPECT_GT(progress.fractions_.front(), 0.0);
    EXPECT_EQ(progress.fractions_.back(), 1.0);
}

TEST(ParallelFor, StopsWhenAskedTo) {
    constexpr std::size_t kCount = 100'000;
    Recorder progress(3);
    std::atomic<std::size_t> visited = 0;
    try {
        parallel_for(
            kCount, 1, [&](std::size_t first, std::size_t last) { visited += last - first; },
            "counting", &progress);
        FAIL() << "went on to the end";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::cancelled);
        EXPECT_EQ(std::string(error.what()), "cancelled while counting");
    }
    // Every thread finishes the range that it is in, and no more.
    EXPECT_LT(visited, kCount);
}

TEST(ParallelFor, PassesOnWhatTheBodyThrows) {
    const auto body = [](std::size_t first, std::size_t) {
        if (first == 5) throw std::runtime_error("five");
    };
    EXPECT_THROW(parallel_for(10, 1, body), std::runtime_error);
}

TEST(ThrowIfCancelled, IsSilentUntilAskedToStop) {
    EXPECT_NO_THROW(throw_if_cancelled(Progress(), "work"));
    EXPECT_THROW(throw_if_cancelled(Recorder(0), "work"), Error);
}

}  // namespace
}  // namespace gnomon
