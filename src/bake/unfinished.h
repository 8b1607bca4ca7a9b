#pragma once

#include <gnomon/bake.h>

#include "bake/interval_codes.h"
#include "trace/receiver.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace gnomon::bake {

/// The file of a bake that is not yet written: the times of its first texels, or of all.
class Unfinished {
public:
    /// Without a name there is no file. `fingerprint` and `texels` are of the whole bake. Throws
    /// Error{machine} when the disk has no room for it.
    Unfinished(std::filesystem::path file, std::uint64_t fingerprint, std::size_t texels);

    /// Nothing when there is no file. Throws Error{input} when it is of another bake or damaged.
    std::vector<LitTimes> load() const;

    /// Nothing is written for no texels. Throws Error{machine}.
    void save(std::span<const LitTimes> times) const;

private:
    /// The file, once it is sure that it is whole and of this bake. Throws Error{input}.
    std::vector<std::uint8_t> read_checked() const;
    [[noreturn]] void fail_damaged() const;

    std::filesystem::path file_;
    std::uint64_t fingerprint_;
    std::size_t texels_;
};

/// Of all that decides what a bake of these receivers becomes: FNV-1a, G. Fowler, L. Noll, K.-P.
/// Vo.
std::uint64_t fingerprint(const Scene& scene, const BakePath& path, const BakeOptions& options,
                          std::span<const trace::Receiver> receivers);

}  // namespace gnomon::bake
