#pragma once

#include <gnomon/error.h>

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

namespace gnomon::cli {

/// The command line is wrong: throws Error{input} with the formatted message, one line.
template <typename... Args>
[[noreturn]] void fail_usage(fmt::format_string<Args...> format, Args&&... args) {
    throw Error(ErrorKind::input, fmt::format(format, std::forward<Args>(args)...));
}

/// work(), whose errors about the light map name the flag that its user sets.
template <typename Work>
auto naming_texel_flag(const Work& work) {
    try {
        return work();
    } catch (const Error& error) {
        constexpr std::string_view kMember = "texel_size_m";
        std::string message = error.what();
        for (auto at = message.find(kMember); at != message.npos; at = message.find(kMember))
            message.replace(at, kMember.size(), "--texel");
        throw Error(error.kind(), message);
    }
}

}  // namespace gnomon::cli
