#pragma once

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace gnomon::cli {

/// Files that appear in a folder together or not at all, beside what else it holds. The folder is
/// made if it is missing, and goes again when nothing came of it.
class StagedFiles {
public:
    /// Throws Error{machine} when the folder cannot be made.
    explicit StagedFiles(std::filesystem::path folder);
    ~StagedFiles();
    StagedFiles(const StagedFiles&) = delete;
    StagedFiles& operator=(const StagedFiles&) = delete;

    /// Where the file of this name is to be written until it is put in place.
    std::filesystem::path add(const std::string& name);

    /// Puts all files in place, where they replace others of their names, and returns their paths.
    /// Throws Error{machine}; earlier files of these names are then there again.
    std::vector<std::filesystem::path> put_in_place();

private:
    /// Puts one file in place; what it replaces goes to `replaced_`.
    std::error_code put(const std::string& name, const std::filesystem::path& path) const;

    std::filesystem::path folder_, stage_, replaced_;
    std::vector<std::string> names_;
    bool made_ = false;  ///< the folder, by this
};

}  // namespace gnomon::cli
