#include "base/parallel.h"

#include <gnomon/error.h>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>

namespace gnomon {

void throw_if_cancelled(const Progress& progress, std::string_view task) {
    if (progress.cancelled()) {
        throw Error(ErrorKind::cancelled, fmt::format("cancelled while {}", task));
    }
}

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body, std::string_view task,
                  Progress* progress) {
    std::atomic<std::size_t> done = 0;
    const auto run = [&](const tbb::blocked_range<std::size_t>& range) {
        if (progress != nullptr) throw_if_cancelled(*progress, task);
        body(range.begin(), range.end());
        if (progress != nullptr) {
            const std::size_t now = done.fetch_add(range.size()) + range.size();
            progress->report(task, static_cast<double>(now) / static_cast<double>(count));
        }
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), run,
                      tbb::simple_partitioner());
}

}  // namespace gnomon
