#include "base/thread_time.h"

#include <chrono>
#include <ctime>

namespace gnomon {

double thread_seconds() {
#ifdef CLOCK_THREAD_CPUTIME_ID
    std::timespec time{};
    if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time) == 0)
        return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
#endif
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double>(now).count();
}

}  // namespace gnomon
