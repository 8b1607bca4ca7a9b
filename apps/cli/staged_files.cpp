#include "staged_files.h"

#include <gnomon/error.h>

#include "output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <system_error>
#include <utility>

namespace gnomon::cli {

namespace fs = std::filesystem;

StagedFiles::StagedFiles(fs::path folder) : folder_(std::move(folder)) {
    std::error_code ignored;
    made_ = !fs::exists(folder_, ignored);
    // In the folder itself, so that renames stay within one file system.
    stage_ = folder_ / fmt::format(".part{}", getpid());
    replaced_ = stage_ / "replaced";
    fs::remove_all(stage_, ignored);  // of a process that had our id and was killed
    try {
        make_folder(replaced_);
    } catch (...) {
        if (made_) fs::remove(folder_, ignored);
        throw;
    }
}

StagedFiles::~StagedFiles() {
    std::error_code ignored;
    fs::remove_all(stage_, ignored);
    if (made_) fs::remove(folder_, ignored);  // which leaves it when there is anything in it
}

fs::path StagedFiles::add(const std::string& name) {
    names_.push_back(name);
    return stage_ / name;
}

std::vector<fs::path> StagedFiles::put_in_place() {
    std::vector<fs::path> paths;
    for (const std::string& name : names_) {
        const fs::path path = folder_ / name;
        const std::error_code error = put(name, path);
        if (!error) {
            paths.push_back(path);
            continue;
        }
        for (std::size_t i = 0; i < paths.size(); ++i) {
            std::error_code ignored;
            fs::remove(paths[i], ignored);
            fs::rename(replaced_ / names_[i], paths[i], ignored);
        }
        throw Error(ErrorKind::machine,
                    fmt::format("{}: cannot be written: {}", path.string(), error.message()));
    }
    return paths;
}

std::error_code StagedFiles::put(const std::string& name, const fs::path& path) const {
    std::error_code error;
    const fs::file_status status = fs::symlink_status(path, error);
    if (fs::is_directory(status)) return std::make_error_code(std::errc::is_a_directory);
    const bool replaces = fs::exists(status);
    error.clear();
    if (replaces) fs::rename(path, replaced_ / name, error);
    if (error) return error;
    fs::rename(stage_ / name, path, error);
    std::error_code ignored;
    if (error && replaces) fs::rename(replaced_ / name, path, ignored);
    return error;
}

}  // namespace gnomon::cli
