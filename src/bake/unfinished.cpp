#include "bake/unfinished.h"

#include "base/check.h"
#include "base/file.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace gnomon::bake {

namespace {

namespace fs = std::filesystem;

/// What the file takes for a texel of some intervals, twice, as the one before is there until the
/// next is written: with less free the work is not begun.
constexpr std::uint64_t kTexel_bytes = 2 * 16;

/// What the files of all versions begin with.
constexpr std::string_view kMagic = "gnomon part ";

/// The beginning of the file. A byte for each block follows, 1 where it is done; then the number of
/// intervals of each texel of those blocks, then these intervals.
struct Header {
    std::array<char, 16> magic{"gnomon part 6\n"};
    std::uint64_t checksum = 0;  ///< of all that follows it: CRC-32
    std::uint64_t fingerprint = 0;
    std::uint64_t texels = 0;       ///< of the bake
    std::uint64_t done_texels = 0;  ///< of the blocks that are done
    std::uint64_t intervals = 0;    ///< of all of these
};

using Count = std::uint16_t;

std::uint64_t file_bytes(const Header& header) {
    return sizeof header + block_count(header.texels) + header.done_texels * sizeof(Count) +
           header.intervals * sizeof(CodedInterval);
}

std::uint64_t checksum_of(std::span<const std::uint8_t> file) {
    const auto rest = file.subspan(offsetof(Header, fingerprint));
    return ::crc32_z(0, rest.data(), rest.size());
}

template <typename T>
void append(std::string& bytes, std::span<const T> values) {
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

/// Calls act(texel) for those of the blocks that are done.
template <typename Act>
void for_done(std::span<const std::uint8_t> done, std::size_t texels, const Act& act) {
    for (std::size_t number = 0; number < done.size(); ++number) {
        if (done[number] == 0) continue;
        const Block block = block_of(number, texels);
        for (std::size_t i = 0; i < block.count; ++i)
            act(block.first + i);
    }
}

std::uint64_t done_texels(std::span<const std::uint8_t> done, std::size_t texels) {
    std::uint64_t count = 0;
    for_done(done, texels, [&](std::size_t) { ++count; });
    return count;
}

class Hash {
public:
    template <typename T>
    void add(std::span<const T> values) {
        for (const std::byte byte : std::as_bytes(values)) {
            value_ ^= static_cast<std::uint64_t>(byte);
            value_ *= 0x100000001b3;
        }
    }
    std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325;
};

/// Of where light passes through masked materials.
void add_holes(const Scene& scene, Hash& hash) {
    for (const Material& material : scene.materials()) {
        hash.add(std::span(&material.alpha_cutoff, 1));
        hash.add(std::span(&material.base_color, 1));
        hash.add(std::span(&material.base_color_texture, 1));
        hash.add(std::span(&material.uv_scale_rotation, 1));
        hash.add(std::span(&material.uv_offset, 1));
    }
    for (const Texture& texture : scene.textures()) {
        hash.add(std::span(&texture.size, 1));
        hash.add(std::span(&texture.wrap_u, 1));
        hash.add(std::span(&texture.wrap_v, 1));
        hash.add(std::span(texture.rgba));
    }
}

}  // namespace

Unfinished::Unfinished(fs::path file, std::uint64_t fingerprint, std::size_t texels)
    : file_(std::move(file)), fingerprint_(fingerprint), texels_(texels) {
    if (file_.empty()) return;
    std::error_code error;
    const fs::space_info space = fs::space(fs::absolute(file_).parent_path(), error);
    const std::uint64_t needed = kTexel_bytes * texels_;
    if (error || space.available >= needed || fs::exists(file_, error)) return;
    fail_machine(
        "{}: the disk has {} bytes free; this bake of {} texels needs {}: make room, or "
        "choose larger texels",
        file_.string(), space.available, texels_, needed);
}

FoundTimes Unfinished::load() const {
    FoundTimes found;
    found.times.resize(texels_);
    found.done.resize(block_count(texels_), 0);
    std::error_code error;
    if (file_.empty() || !fs::exists(file_, error)) return found;
    const std::vector<std::uint8_t> bytes = read_checked();
    Header header;
    std::memcpy(&header, bytes.data(), sizeof header);
    const std::uint8_t* at = bytes.data() + sizeof header;
    std::copy_n(at, found.done.size(), found.done.begin());
    at += found.done.size();
    if (done_texels(found.done, texels_) != header.done_texels) fail_damaged();
    const std::uint8_t* count_at = at;
    at += header.done_texels * sizeof(Count);
    std::uint64_t left = header.intervals;
    for_done(found.done, texels_, [&](std::size_t texel) {
        Count count = 0;
        std::memcpy(&count, count_at, sizeof count);
        count_at += sizeof count;
        if (count > left) fail_damaged();
        left -= count;
        LitTimes& of_texel = found.times[texel];
        of_texel.resize(count);
        std::memcpy(of_texel.data(), at, count * sizeof(CodedInterval));
        at += count * sizeof(CodedInterval);
    });
    if (left != 0) fail_damaged();
    return found;
}

std::vector<std::uint8_t> Unfinished::read_checked() const {
    if (!is_unfinished_bake(file_)) {
        fail_input("{}: is no unfinished bake: move it away, or choose another place for the bake",
                   file_.string());
    }
    Header header;
    header.magic = {};
    std::ifstream(file_, std::ios::binary).read(reinterpret_cast<char*>(&header), sizeof header);
    if (header.magic != Header().magic) {
        fail_input(
            "{}: is an unfinished bake of another version of Gnomon, or damaged: delete it and "
            "begin anew",
            file_.string());
    }
    // Before its length, which is the other bake's.
    if (header.fingerprint != fingerprint_) {
        fail_input(
            "{}: is the unfinished bake of another scene or of other parameters: go on with those "
            "that it was begun with, or delete it and begin anew",
            file_.string());
    }
    std::error_code error;
    // Of a texel: every other step.
    constexpr std::uint64_t kMostIntervals = (most_steps(BakeBits::sixteen) + 1) / 2;
    const bool is_likely = header.texels == texels_ && header.done_texels <= texels_ &&
                           header.intervals <= header.done_texels * kMostIntervals &&
                           fs::file_size(file_, error) == file_bytes(header);
    if (!is_likely) fail_damaged();
    std::vector<std::uint8_t> bytes = read_file(file_, file_bytes(header));
    if (bytes.size() != file_bytes(header) || checksum_of(bytes) != header.checksum) fail_damaged();
    return bytes;
}

void Unfinished::fail_damaged() const {
    fail_input("{}: is damaged, and what it kept is lost: delete it and begin anew",
               file_.string());
}

void Unfinished::save(std::span<const LitTimes> times, std::span<const std::uint8_t> done) const {
    Header header{.fingerprint = fingerprint_,
                  .texels = times.size(),
                  .done_texels = done_texels(done, times.size())};
    if (file_.empty() || header.done_texels == 0) return;
    for_done(done, times.size(),
             [&](std::size_t texel) { header.intervals += times[texel].size(); });
    std::string bytes;
    bytes.reserve(file_bytes(header));
    append(bytes, std::span<const Header>(&header, 1));
    append(bytes, done);
    for_done(done, times.size(), [&](std::size_t texel) {
        const auto count = static_cast<Count>(times[texel].size());
        append(bytes, std::span<const Count>(&count, 1));
    });
    for_done(done, times.size(), [&](std::size_t texel) {
        append(bytes, std::span<const CodedInterval>(times[texel]));
    });
    header.checksum =
        checksum_of({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    std::memcpy(bytes.data(), &header, sizeof header);
    write_file(file_, bytes, Outlives::power_cut);
}

std::uint64_t fingerprint(const Scene& scene, const BakePath& path, const BakeOptions& options,
                          std::span<const trace::Receiver> receivers) {
    Hash hash;
    for (const Mesh& mesh : scene.meshes()) {
        hash.add(std::span(mesh.positions));
        hash.add(std::span(mesh.triangles));
        hash.add(std::span(mesh.texcoords));
        hash.add(std::span(&mesh.material, 1));
    }
    for (const Instance& instance : scene.instances()) {
        hash.add(std::span(&instance.mesh, 1));
        hash.add(std::span(&instance.world_from_local, 1));
    }
    if (!options.ignore_alpha) add_holes(scene, hash);
    hash.add(std::span(path.to_light_ws));
    hash.add(std::span(&options.bits, 1));
    hash.add(std::span(&options.method, 1));
    for (const trace::Receiver& receiver : receivers) {
        hash.add(std::span(&receiver.position_ws, 1));
        hash.add(std::span(&receiver.normal_ws, 1));
    }
    return hash.value();
}

}  // namespace gnomon::bake

namespace gnomon {

bool is_unfinished_bake(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) return false;
    std::array<char, bake::kMagic.size()> start{};
    std::ifstream stream(file, std::ios::binary);
    stream.read(start.data(), start.size());
    return stream && std::string_view(start.data(), start.size()) == bake::kMagic;
}

}  // namespace gnomon
