#pragma once

#include <cstdint>

namespace gnomon {

/// The machine's memory in bytes, used or not; the largest number when the system does not tell.
std::uint64_t physical_memory_bytes();

}  // namespace gnomon
