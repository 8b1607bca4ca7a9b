#include "base/memory.h"

#include <limits>

#if __has_include(<unistd.h>)
#include <unistd.h>
#endif

namespace gnomon {

std::uint64_t physical_memory_bytes() {
#if defined(_SC_PHYS_PAGES) && defined(_SC_PAGESIZE)
    const long pages = ::sysconf(_SC_PHYS_PAGES);
    const long page_bytes = ::sysconf(_SC_PAGESIZE);
    if (pages > 0 && page_bytes > 0) {
        return static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page_bytes);
    }
#endif
    return std::numeric_limits<std::uint64_t>::max();
}

}  // namespace gnomon
