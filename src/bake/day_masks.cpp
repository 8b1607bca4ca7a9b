#include "bake/day_masks.h"

#include "base/check.h"
#include "base/file.h"
#include "base/part_progress.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::bake {

namespace {

using interval::DayMasks;

/// Texels between two looks at whether to stop: a second or so of work.
constexpr std::size_t kPartTexels = 1 << 16;

/// The beginning of a file of finished parts.
struct PartHeader {
    std::array<char, 16> magic{"gnomon part 1\n"};
    std::uint64_t fingerprint = 0;
    std::uint64_t receivers = 0;  ///< that are done
    std::uint64_t words = 0;      ///< of a mask
};

void save(const std::filesystem::path& file, PartHeader header, const DayMasks& masks) {
    if (file.empty() || header.receivers == 0) return;
    std::string bytes(sizeof header + header.receivers * header.words * sizeof(std::uint64_t),
                      '\0');
    std::memcpy(bytes.data(), &header, sizeof header);
    std::memcpy(bytes.data() + sizeof header, masks.words.data(), bytes.size() - sizeof header);
    write_file(file, bytes);
}

/// Receivers that are done, whose masks are now in `masks`.
std::size_t load(const std::filesystem::path& file, const PartHeader& expected, DayMasks& masks) {
    std::error_code error;
    if (file.empty() || !std::filesystem::exists(file, error)) return 0;
    const std::uint64_t most = sizeof expected + masks.words.size() * sizeof(std::uint64_t);
    const std::vector<std::uint8_t> bytes = read_file(file, most);
    PartHeader header;
    if (bytes.size() >= sizeof header) std::memcpy(&header, bytes.data(), sizeof header);
    const bool is_ours =
        bytes.size() >= sizeof header && header.magic == expected.magic &&
        header.fingerprint == expected.fingerprint && header.words == expected.words &&
        bytes.size() == sizeof header + header.receivers * header.words * sizeof(std::uint64_t);
    if (!is_ours) {
        fail_input(
            "{}: holds parts of another bake, or is damaged: remove it, or go on with the "
            "scene and the flags that it was begun with",
            file.string());
    }
    std::memcpy(masks.words.data(), bytes.data() + sizeof header, bytes.size() - sizeof header);
    return header.receivers;
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

}  // namespace

DayMasks day_masks(const interval::Tree& tree, const interval::DayPath& path,
                   std::span<const trace::Receiver> receivers,
                   const std::filesystem::path& resume_file, std::uint64_t fingerprint,
                   Progress& progress) {
    DayMasks masks;
    masks.steps = path.steps();
    const std::size_t words = masks.words_per_mask();
    masks.words.resize(receivers.size() * words);
    PartHeader header{.fingerprint = fingerprint, .words = words};
    std::size_t done = load(resume_file, header, masks);
    try {
        while (done < receivers.size()) {
            const std::size_t count = std::min(kPartTexels, receivers.size() - done);
            const auto all = static_cast<double>(receivers.size());
            PartProgress part(progress, "baking the sun", static_cast<double>(done) / all,
                              static_cast<double>(count) / all);
            const DayMasks found = interval::bake(tree, path, receivers.subspan(done, count), part);
            std::ranges::copy(found.words,
                              masks.words.begin() + static_cast<std::ptrdiff_t>(done * words));
            done += count;
        }
    } catch (const Error& error) {
        header.receivers = done;
        if (error.kind() == ErrorKind::cancelled) save(resume_file, header, masks);
        throw;
    }
    std::error_code ignored;
    if (!resume_file.empty()) std::filesystem::remove(resume_file, ignored);
    return masks;
}

std::uint64_t fingerprint(const Scene& scene, const interval::DayPath& path, bool ignore_alpha,
                          std::span<const trace::Receiver> receivers) {
    Hash hash;
    for (const Mesh& mesh : scene.meshes()) {
        hash.add(std::span(mesh.positions));
        hash.add(std::span(mesh.triangles));
        hash.add(std::span(mesh.texcoords));
    }
    for (const Instance& instance : scene.instances())
        hash.add(std::span(&instance.world_from_local, 1));
    if (!ignore_alpha) {
        for (const Texture& texture : scene.textures())
            hash.add(std::span(texture.rgba));
    }
    hash.add(path.to_sun_ws());
    for (const trace::Receiver& receiver : receivers)
        hash.add(std::span(&receiver.position_ws, 1));
    return hash.value();
}

}  // namespace gnomon::bake
