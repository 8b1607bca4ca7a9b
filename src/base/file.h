#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon {

/// The whole file. Throws Error{input} naming it when it is missing, a folder, unreadable, no
/// regular file, or larger than `max_bytes`.
std::vector<std::uint8_t> read_file(const std::filesystem::path& path, std::uint64_t max_bytes);

/// Calls write(temporary_path) and renames the result to `path`, so that `path` appears whole or
/// not at all. The temporary file is removed when `write` throws. Throws Error{machine} when the
/// file cannot be made or renamed.
void write_whole(const std::filesystem::path& path,
                 const std::function<void(const std::filesystem::path&)>& write);

/// What a file must outlive once it is written. A power cut costs a wait for the disk.
enum class Outlives { process, power_cut };

/// Writes `bytes` by write_whole.
void write_file(const std::filesystem::path& path, std::string_view bytes,
                Outlives outlives = Outlives::process);

}  // namespace gnomon
