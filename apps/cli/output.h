#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace gnomon::cli {

/// Whoever read standard output has gone (`gnomon info | head`): there is no one left to tell.
struct ReaderGone : std::runtime_error {
    ReaderGone() : std::runtime_error("standard output: its reader has gone") {}
};

/// Writes to standard output and waits until it is written.
/// Throws Error{machine} when it cannot be (disk full), ReaderGone when it is a closed pipe.
void print(std::string_view text);

/// One line on standard error, "error: ..." or "warning: ...". Control characters and bytes that
/// are no UTF-8, in names from files, are shown as "?", so that a line stays a line of text.
void print_error(std::string_view message);
void print_warning(std::string_view message);

/// To be asked before the work starts: `path` can become a file ending in `extension` (".png").
/// An existing file will be replaced. Throws Error{input}.
void require_output_file(std::string_view flag, const std::filesystem::path& path,
                         std::string_view extension);

/// Likewise for a folder that will be made, or that `check` (check_report_folder, ..) allows to be
/// replaced whole. Returns it without a slash at its end. Throws what `check` throws, too.
std::filesystem::path require_replaced_folder(std::string_view flag,
                                              const std::filesystem::path& path,
                                              void (*check)(const std::filesystem::path&));

/// Likewise for a folder that will be made if it is missing, and keeps what else it holds.
void require_shared_folder(std::string_view flag, const std::filesystem::path& path);

/// Makes the folder if it is missing. Throws Error{machine}.
void make_folder(const std::filesystem::path& path);

/// Writes a text file whole or not at all. Throws Error{machine}.
void write_text(const std::filesystem::path& path, std::string_view text);

}  // namespace gnomon::cli
