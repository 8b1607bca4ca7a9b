#include "base/folder.h"

#include "base/check.h"

#include <unistd.h>

#include <string>
#include <system_error>
#include <utility>

namespace gnomon {

namespace {

namespace fs = std::filesystem;

/// A folder that is removed with all it holds when it goes out of scope, unless let go.
class TemporaryFolder {
public:
    explicit TemporaryFolder(fs::path path) : path_(std::move(path)) {
        std::error_code error;
        fs::remove_all(path_, error);  // of a process that had our id and was killed
        fs::create_directories(path_, error);
        if (error) fail_machine("{}: cannot be made: {}", path_.string(), error.message());
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        if (!path_.empty()) fs::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const fs::path& path() const { return path_; }
    void let_go() { path_.clear(); }

private:
    fs::path path_;
};

/// The folder's own path, links resolved and a trailing slash dropped, so that a suffix to it names
/// a folder beside it.
fs::path own_path(const fs::path& folder, const FolderKind& kind) {
    if (folder.empty()) fail_input("the {}'s folder has no name", kind.noun);
    std::error_code error;
    fs::path own = fs::weakly_canonical(folder, error);
    if (error) fail_input("{}: {}", folder.string(), error.message());
    return own.has_filename() ? own : own.parent_path();
}

/// Throws unless `folder` is missing, empty or of its kind and nothing more.
void check_own(const fs::path& folder, const FolderKind& kind) {
    std::error_code error;
    const fs::file_status status = fs::status(folder, error);
    if (!fs::exists(status)) return;
    if (!fs::is_directory(status)) fail_input("{}: is a file, not a folder", folder.string());
    if (fs::equivalent(folder, fs::current_path(error), error)) {
        fail_input("{}: is the current folder, which cannot be replaced: name a folder in it",
                   folder.string());
    }
    fs::directory_iterator entries(folder, error);
    if (error) fail_input("{}: cannot be read: {}", folder.string(), error.message());
    if (entries == fs::directory_iterator()) return;
    for (const fs::directory_entry& entry : entries) {
        const std::string name = entry.path().filename().string();
        if (name != kind.mark && !kind.has_entry(name)) {
            fail_input("{}: holds \"{}\", which is no part of a {}: name an empty folder",
                       folder.string(), name, kind.noun);
        }
    }
    if (!kind.is_mark(folder / kind.mark)) {
        fail_input("{}: holds files but no {} of a {}: name an empty folder", folder.string(),
                   kind.mark, kind.noun);
    }
}

fs::path with_suffix(fs::path folder, std::string_view suffix) {
    folder += std::string(suffix) + std::to_string(::getpid());
    return folder;
}

/// Renames `fresh` to `folder`; what was there is moved away first and comes back on failure.
void put_in_place(const fs::path& fresh, const fs::path& folder) {
    std::error_code error;
    const fs::path old = with_suffix(folder, ".old");
    const bool replaces = fs::exists(folder, error);
    if (replaces) fs::rename(folder, old, error);
    if (!error) {
        fs::rename(fresh, folder, error);
        std::error_code ignored;
        if (error && replaces) fs::rename(old, folder, ignored);
        if (!error && replaces) fs::remove_all(old, ignored);
    }
    if (error) {
        fail_machine("{}: cannot be {}: {}: name a new folder, for example one inside it",
                     folder.string(), replaces ? "replaced" : "made", error.message());
    }
}

}  // namespace

void replace_folder(const fs::path& folder, const FolderKind& kind,
                    const std::function<void(const fs::path&)>& fill) {
    const fs::path target = own_path(folder, kind);
    check_own(target, kind);
    TemporaryFolder temporary(with_suffix(target, ".part"));
    fill(temporary.path());
    check_own(target, kind);  // filling takes a while, and the folder may have got other files
    put_in_place(temporary.path(), target);
    temporary.let_go();
}

void check_replaceable(const fs::path& folder, const FolderKind& kind) {
    check_own(own_path(folder, kind), kind);
}

}  // namespace gnomon
