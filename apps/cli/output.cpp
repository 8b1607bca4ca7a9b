#include "output.h"

#include <gnomon/error.h>

#include "fail.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <system_error>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

/// How many bytes of UTF-8 the text's first character takes; 0 when it begins with none.
std::size_t character_bytes(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    if (byte(0) < 0x80) return 1;
    const std::size_t bytes = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
    // What would be longer than it need be (0xc0, 0xc1), or above the last character.
    if (byte(0) < 0xc2 || byte(0) > 0xf4 || text.size() < bytes) return 0;
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return 0;
    }
    return bytes;
}

/// The text with "?" for control characters and for bytes that are no text.
std::string printable(std::string_view text) {
    std::string printable;
    while (!text.empty()) {
        const std::size_t bytes = character_bytes(text);
        const auto first = static_cast<unsigned char>(text.front());
        const bool is_control = first < ' ' || first == 0x7f;
        printable += bytes == 0 || is_control ? std::string_view("?") : text.substr(0, bytes);
        text.remove_prefix(std::max<std::size_t>(bytes, 1));
    }
    return printable;
}

void print_line(std::string_view start, std::string_view message) {
    const std::string line = fmt::format("{}: {}\n", start, printable(message));
    std::fwrite(line.data(), 1, line.size(), stderr);
}

/// Something can be made in the folder of `path`.
void require_folder_of(std::string_view flag, const fs::path& path) {
    const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
    std::error_code error;
    if (!fs::exists(parent, error)) {
        fail_usage("{} {}: the folder {} does not exist; make it first", flag, path.string(),
                   parent.string());
    }
    if (!fs::is_directory(parent, error)) {
        fail_usage("{} {}: {} is not a folder", flag, path.string(), parent.string());
    }
    if (access(parent.c_str(), W_OK | X_OK) != 0) {
        fail_usage("{} {}: the folder {} cannot be written to: {}", flag, path.string(),
                   parent.string(), std::strerror(errno));
    }
}

/// The folder, as "out/" or "out/." name it, too: with a name, to which a suffix can be put.
fs::path named_folder(fs::path path) {
    while (path.has_relative_path() && path.has_parent_path() &&
           (!path.has_filename() || path.filename() == ".")) {
        path = path.parent_path();
    }
    return path;
}

void refuse_dangling_link(std::string_view flag, const fs::path& path) {
    std::error_code error;
    if (!fs::is_symlink(fs::symlink_status(path, error)) || fs::exists(path, error)) return;
    fail_usage("{} {}: is a link to {}, which does not exist; make it, or remove the link", flag,
               path.string(), fs::read_symlink(path, error).string());
}

}  // namespace

void print(std::string_view text) {
    const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
    if (written && std::fflush(stdout) == 0) return;
    if (errno == EPIPE) throw ReaderGone();
    throw Error(ErrorKind::machine,
                fmt::format("standard output: cannot be written: {}", std::strerror(errno)));
}

void print_error(std::string_view message) {
    print_line("error", message);
}

void print_warning(std::string_view message) {
    print_line("warning", message);
}

void require_output_file(std::string_view flag, const fs::path& path, std::string_view extension) {
    std::error_code error;
    if (fs::is_directory(path, error)) {
        fail_usage("{} {}: is a folder; give the name of a file in it", flag, path.string());
    }
    if (path.extension() != extension) {
        fail_usage("{} {}: the file is a {}; end its name in {}", flag, path.string(),
                   extension.substr(1), extension);
    }
    require_folder_of(flag, path);
}

fs::path require_replaced_folder(std::string_view flag, const fs::path& path,
                                 void (*check)(const fs::path&)) {
    fs::path folder = named_folder(path);
    refuse_dangling_link(flag, folder);
    require_folder_of(flag, folder);
    check(folder);
    std::error_code error;
    if (fs::is_symlink(folder, error)) require_folder_of(flag, fs::canonical(folder, error));
    return folder;
}

void require_shared_folder(std::string_view flag, const fs::path& path) {
    const fs::path folder = named_folder(path);
    refuse_dangling_link(flag, folder);
    std::error_code error;
    if (!fs::exists(folder, error)) {
        require_folder_of(flag, folder);
    } else {
        require_folder_of(flag, folder / "file");
    }
}

void make_folder(const fs::path& path) {
    std::error_code error;
    fs::create_directories(path, error);
    if (error) {
        throw Error(ErrorKind::machine,
                    fmt::format("{}: cannot be made: {}", path.string(), error.message()));
    }
}

void write_text(const fs::path& path, std::string_view text) {
    // Beside the target, so that the rename stays within one file system.
    fs::path temporary = path;
    temporary += fmt::format(".part{}", getpid());
    errno = 0;
    std::ofstream stream(temporary, std::ios::binary);
    stream.write(text.data(), static_cast<std::streamsize>(text.size()));
    stream.close();
    std::error_code error;
    if (stream) {
        fs::rename(temporary, path, error);
        if (!error) return;
    } else {
        error.assign(errno, std::generic_category());
    }
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw Error(ErrorKind::machine,
                fmt::format("{}: cannot be written: {}", path.string(), error.message()));
}

}  // namespace gnomon::cli
