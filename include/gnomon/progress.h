#pragma once

#include <string_view>

namespace gnomon {

/// How long-running calls tell how far they are, and learn that they are no longer wanted.
/// The base class is silent and never cancels. Both functions may be called from any thread.
class Progress {
public:
    virtual ~Progress() = default;

    /// `fraction` of the `task` is done, in [0, 1]. `task` is a short noun phrase ("tracing
    /// truth").
    virtual void report(std::string_view task, double fraction) {
        (void)task;
        (void)fraction;
    }

    /// True when the caller wants the work to end: the call in progress then throws an Error of
    /// kind `cancelled` soon, and leaves nothing half-written.
    virtual bool cancelled() const { return false; }
};

}  // namespace gnomon
