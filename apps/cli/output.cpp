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

void print_line(std::string_view start, std::string_view message) {
    std::string line = fmt::format("{}: {}", start, message);
    const auto is_control = [](unsigned char c) { return c < ' ' || c == 0x7f; };
    std::replace_if(line.begin(), line.end(), is_control, '?');
    line += '\n';
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
