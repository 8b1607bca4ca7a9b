#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace gnomon {

/// What a folder of ours is known by.
struct FolderKind {
    std::string_view noun;                                 ///< "report"
    std::string_view mark;                                 ///< the file that each of them has
    std::function<bool(std::string_view name)> has_entry;  ///< what else there can be in it, too
    std::function<bool(const std::filesystem::path& mark)> is_mark;  ///< of this kind, in truth
};

/// Calls fill(temporary_folder), then puts the result at `folder`, so that it appears whole or not
/// at all: an earlier one of its kind there is replaced whole, and stays as it was when `fill`
/// throws. Nothing else is ever removed.
/// Throws Error{input} as check_replaceable does, Error{machine} when it cannot be made.
void replace_folder(const std::filesystem::path& folder, const FolderKind& kind,
                    const std::function<void(const std::filesystem::path&)>& fill);

/// Throws Error{input} when `folder` is a file, the current folder, or holds anything but what is
/// of this kind.
void check_replaceable(const std::filesystem::path& folder, const FolderKind& kind);

}  // namespace gnomon
