#pragma once

#include "interval/bake.h"

#include <filesystem>

namespace gnomon::bake {

/// interval::bake() in parts. When it is stopped, the parts that are done go to `resume_file`, if
/// that has a name, and a later call with the same `fingerprint` begins with them; the file is
/// removed when all is done. Throws Error{input} when the file is of another bake.
interval::DayMasks day_masks(const interval::Tree& tree, const interval::DayPath& path,
                             std::span<const trace::Receiver> receivers,
                             const std::filesystem::path& resume_file, std::uint64_t fingerprint,
                             Progress& progress);

/// Of all that decides what a bake of these receivers becomes: FNV-1a, G. Fowler, L. Noll, K.-P.
/// Vo.
std::uint64_t fingerprint(const Scene& scene, const interval::DayPath& path, bool ignore_alpha,
                          std::span<const trace::Receiver> receivers);

}  // namespace gnomon::bake
