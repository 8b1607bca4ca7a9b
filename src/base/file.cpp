#include "base/file.h"

#include "base/check.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// Waits until the file is on the disk: else a power cut after its renaming could leave it empty.
bool sync(const fs::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return false;
    const bool is_synced = ::fsync(descriptor) == 0;
    ::close(descriptor);
    return is_synced;
}

}  // namespace

std::vector<std::uint8_t> read_file(const fs::path& path, std::uint64_t max_bytes) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) fail_input("{}: no such file", path.string());
    if (fs::is_directory(status)) fail_input("{}: is a folder, not a file", path.string());
    if (!fs::is_regular_file(status)) fail_input("{}: is not a regular file", path.string());
    const std::uint64_t size = fs::file_size(path, error);
    if (error) fail_input("{}: {}", path.string(), error.message());
    if (size > max_bytes) {
        fail_input("{}: has {} bytes, more than the {} that can be read", path.string(), size,
                   max_bytes);
    }
    std::ifstream stream(path, std::ios::binary);
    if (!stream) fail_input("{}: cannot be opened: {}", path.string(), std::strerror(errno));
    std::vector<std::uint8_t> bytes(size);
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (static_cast<std::uint64_t>(stream.gcount()) != size) {
        fail_input("{}: ended after {} of {} bytes", path.string(), stream.gcount(), size);
    }
    return bytes;
}

void write_whole(const fs::path& path, const std::function<void(const fs::path&)>& write) {
    // Beside the target, so that the rename stays within one file system.
    fs::path temporary = path;
    temporary += ".part" + std::to_string(::getpid());
    std::error_code error;
    try {
        write(temporary);
    } catch (...) {
        fs::remove(temporary, error);
        throw;
    }
    fs::rename(temporary, path, error);
    if (error) {
        std::error_code ignored;
        fs::remove(temporary, ignored);
        fail_machine("{}: cannot be written: {}", path.string(), error.message());
    }
}

void write_file(const fs::path& path, std::string_view bytes, Outlives outlives) {
    write_whole(path, [&](const fs::path& temporary) {
        errno = 0;
        std::ofstream stream(temporary, std::ios::binary);
        stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        stream.close();
        const bool is_written = stream && (outlives == Outlives::process || sync(temporary));
        if (!is_written) {
            fail_machine("{}: cannot be written: {}", path.string(), std::strerror(errno));
        }
    });
}

}  // namespace gnomon
