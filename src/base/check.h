#pragma once

#include <gnomon/error.h>

#include <fmt/format.h>

#include <utility>

namespace gnomon {

/// Throws Error{input} with the formatted message.
template <typename... Args>
[[noreturn]] void fail_input(fmt::format_string<Args...> format, Args&&... args) {
    throw Error(ErrorKind::input, fmt::format(format, std::forward<Args>(args)...));
}

/// Throws Error{machine} with the formatted message.
template <typename... Args>
[[noreturn]] void fail_machine(fmt::format_string<Args...> format, Args&&... args) {
    throw Error(ErrorKind::machine, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace gnomon
