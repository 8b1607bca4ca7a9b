#pragma once

#include <gnomon/progress.h>

#include <cstddef>
#include <functional>
#include <string_view>

namespace gnomon {

/// Calls body(first, last) over disjoint ranges that cover [0, count), on all of TBB's threads.
/// Reports progress under `task`; throws Error{cancelled} between ranges when asked to stop.
/// `grain` is the greatest length of a range.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body,
                  std::string_view task = {}, Progress* progress = nullptr);

/// Throws Error{cancelled} naming the task when `progress` asks to stop.
void throw_if_cancelled(const Progress& progress, std::string_view task);

}  // namespace gnomon
