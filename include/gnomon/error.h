#pragma once

#include <stdexcept>
#include <string>

namespace gnomon {

/// Who can mend an Error: decides a program's exit code and what its user is told.
enum class ErrorKind {
    input,      ///< a file, a parameter or a call is wrong; the caller can mend it
    machine,    ///< the machine could not: no device, out of memory, disk full
    cancelled,  ///< Progress::cancelled() asked to stop
};

/// The one exception type that gnomon throws. what() is one line: what is wrong, where, and how to
/// mend it.
class Error : public std::runtime_error {
public:
    Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
    ErrorKind kind() const noexcept { return kind_; }

private:
    ErrorKind kind_;
};

}  // namespace gnomon
