#pragma once

#include <gnomon/error.h>

#include <fmt/format.h>

#include <utility>

namespace gnomon::cli {

/// The command line is wrong: throws Error{input} with the formatted message, one line.
template <typename... Args>
[[noreturn]] void fail_usage(fmt::format_string<Args...> format, Args&&... args) {
    throw Error(ErrorKind::input, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace gnomon::cli
