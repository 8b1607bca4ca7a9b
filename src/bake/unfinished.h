#pragma once

#include <gnomon/bake.h>

#include "bake/interval_codes.h"
#include "trace/receiver.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace gnomon::bake {

/// Texels that are found together, and of which all or none are kept: some milliseconds of work.
inline constexpr std::size_t kBlockTexels = 512;

constexpr std::size_t block_count(std::size_t texels) {
    return (texels + kBlockTexels - 1) / kBlockTexels;
}

/// The block of so many texels.
struct Block {
    std::size_t first, count;
};
constexpr Block block_of(std::size_t number, std::size_t texels) {
    const std::size_t first = number * kBlockTexels;
    return {first, std::min(kBlockTexels, texels - first)};
}

/// The times of a bake's texels, and which of their blocks are done, if not 0.
struct FoundTimes {
    std::vector<LitTimes> times;
    std::vector<std::uint8_t> done;
};

/// The file of a bake that is not yet written: what is found of it.
class Unfinished {
public:
    /// Without a name there is no file. `fingerprint` and `texels` are of the whole bake. Throws
    /// Error{machine} when the disk has no room for it.
    Unfinished(std::filesystem::path file, std::uint64_t fingerprint, std::size_t texels);

    /// Nothing is done when there is no file. Throws Error{input} when it is of another bake or
    /// damaged.
    FoundTimes load() const;

    /// Of all texels, and of each block. Nothing is written when none is done. Once it returns, the
    /// file outlives a power cut. Throws Error{machine}.
    void save(std::span<const LitTimes> times, std::span<const std::uint8_t> done) const;

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
