#include "base/thread_time.h"

#include <gtest/gtest.h>

#include <chrono>
#include <ctime>
#include <thread>

namespace gnomon {
namespace {

TEST(ThreadTime, PassesWhileTheThreadWorks) {
    const double start = thread_seconds();
    volatile double sum = 0.0;
    for (int i = 0; i < 10'000'000; ++i)
        sum = sum + 1.0;
    EXPECT_GT(thread_seconds(), start);
}

#ifdef CLOCK_THREAD_CPUTIME_ID
TEST(ThreadTime, StandsStillWhileTheThreadWaits) {
    constexpr double kWait_s = 0.05;
    const double start = thread_seconds();
    std::this_thread::sleep_for(std::chrono::duration<double>(kWait_s));
    // Falling asleep and waking take microseconds.
    EXPECT_LT(thread_seconds() - start, 0.5 * kWait_s);
}
#endif

}  // namespace
}  // namespace gnomon
