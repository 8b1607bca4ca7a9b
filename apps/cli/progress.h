#pragma once

#include <gnomon/progress.h>

#include <chrono>
#include <mutex>
#include <optional>
#include <string>

namespace gnomon::cli {

/// From now on the first SIGINT (Ctrl-C), SIGTERM or SIGHUP (its terminal is gone) only asks the
/// work to stop, so that nothing is left half-written; the second ends the process at once. SIGPIPE
/// is ignored: writing to a closed pipe fails instead. The only place of the project that handles
/// signals.
void install_signal_handlers();

/// The signal that asked the work to stop, 0 if none did.
int stop_signal();

/// "tracing truth  50 %  0:12 left". `left_s` below 0 = unknown, left out.
std::string progress_text(std::string_view task, double fraction, double left_s);

/// "tracing truth [#####-----]  50 %  0:12 left" in at most `columns`.
std::string progress_bar(std::string_view task, double fraction, double left_s, int columns);

/// Progress on standard error for what takes more than a second: a bar on a terminal, a line every
/// few seconds otherwise.
class ConsoleProgress : public Progress {
public:
    explicit ConsoleProgress(bool quiet);
    ~ConsoleProgress() override;

    void report(std::string_view task, double fraction) override;
    bool cancelled() const override { return stop_signal() != 0; }

    /// Throws Error{cancelled} when the work shall stop. For commands, between their steps.
    void check() const;

    /// Takes the bar off the terminal, before anything else is written to it.
    void clear();

private:
    using Clock = std::chrono::steady_clock;

    void show(double fraction, Clock::time_point now);

    enum class Style { silent, bar, lines };
    Style style_ = Style::silent;
    std::mutex mutex_;
    Clock::time_point begin_ = Clock::now();
    Clock::time_point task_begin_ = begin_;
    std::optional<Clock::time_point> shown_;  ///< when something last was
    std::string task_;
    double fraction_ = 0.0;
    bool drawn_ = false;  ///< a bar is on the terminal
};

}  // namespace gnomon::cli
