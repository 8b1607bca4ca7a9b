#include "progress.h"

#include <gnomon/error.h>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace gnomon::cli {

namespace {

using std::chrono::duration;
constexpr duration<double> kQuietAtFirst{1.0};
constexpr duration<double> kBarInterval{0.1};
constexpr duration<double> kLineInterval{5.0};
// A task that has done less, or has run for less, has no remaining time to tell.
constexpr double kMinFractionForTime = 0.02;
constexpr double kMinSecondsForTime = 1.0;
constexpr int kDefaultColumns = 80;
constexpr int kMinBarColumns = 8;
constexpr int kMaxBarColumns = 40;

// Signal handlers can reach nothing else.
std::atomic<int> g_stop_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);

/// Ctrl-C, a polite end, and a terminal that is closed.
constexpr std::array<int, 3> kStopSignals = {SIGINT, SIGTERM, SIGHUP};

void on_stop_signal(int number) {
    g_stop_signal.store(number);
    for (const int each : kStopSignals)
        std::signal(each, SIG_DFL);  // the next one of any kind ends the process
}

void handle_stop_signal(int number) {
    struct sigaction action {};
    // Who starts us with a signal ignored (a shell's background job) wants it ignored.
    if (sigaction(number, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) return;
    action.sa_handler = on_stop_signal;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    sigaction(number, &action, nullptr);
}

bool is_terminal() {
    const char* const kind = std::getenv("TERM");
    return isatty(STDERR_FILENO) != 0 && kind != nullptr && std::string_view(kind) != "dumb";
}

int terminal_columns() {
    winsize size{};
    const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return known ? size.ws_col : kDefaultColumns;
}

std::string time_text(double seconds) {
    constexpr long kMinute = 60;
    constexpr long kHour = 60 * kMinute;
    const long s = std::lround(seconds);
    if (s >= kHour)
        return fmt::format("{}:{:02}:{:02}", s / kHour, s % kHour / kMinute, s % kMinute);
    return fmt::format("{}:{:02}", s / kMinute, s % kMinute);
}

std::string status_text(double fraction, double left_s) {
    const std::string left = left_s < 0.0 ? "" : fmt::format("  {} left", time_text(left_s));
    return fmt::format(" {:3.0f} %{}", 100.0 * fraction, left);
}

void write_stderr(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

}  // namespace

void install_signal_handlers() {
    for (const int number : kStopSignals)
        handle_stop_signal(number);
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);  // a file beyond its limit then fails as on a full disk
}

int stop_signal() {
    return g_stop_signal.load();
}

std::string progress_text(std::string_view task, double fraction, double left_s) {
    return std::string(task) + status_text(fraction, left_s);
}

std::string progress_bar(std::string_view task, double fraction, double left_s, int columns) {
    constexpr int kFrameColumns = 3;  // " [" and "]"
    const std::string status = status_text(fraction, left_s);
    const int room = columns - static_cast<int>(task.size() + status.size()) - kFrameColumns;
    std::string line(task);
    if (room >= kMinBarColumns) {
        const int length = std::min(room, kMaxBarColumns);
        const int filled = static_cast<int>(fraction * length);
        line += fmt::format(" [{:#<{}}{:-<{}}]", "", filled, "", length - filled);
    }
    return (line + status).substr(0, static_cast<std::size_t>(std::max(columns, 0)));
}

ConsoleProgress::ConsoleProgress(bool quiet) {
    if (!quiet) style_ = is_terminal() ? Style::bar : Style::lines;
}

ConsoleProgress::~ConsoleProgress() {
    clear();
}

void ConsoleProgress::check() const {
    if (cancelled()) throw Error(ErrorKind::cancelled, "cancelled");
}

void ConsoleProgress::report(std::string_view task, double fraction) {
    if (style_ == Style::silent) return;
    // Workers do not wait for a terminal; what one of them leaves out the next one shows.
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return;
    const Clock::time_point now = Clock::now();
    fraction = std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0;
    if (task != task_ || (fraction == 0.0 && fraction_ > 0.0)) {
        task_ = task;
        task_begin_ = now;
        fraction_ = 0.0;
    }
    fraction_ = std::max(fraction_, fraction);  // threads may report out of order
    if (now - begin_ < kQuietAtFirst) return;
    if (shown_ && now - *shown_ < (style_ == Style::bar ? kBarInterval : kLineInterval)) return;
    show(fraction_, now);
    shown_ = now;
}

void ConsoleProgress::show(double fraction, Clock::time_point now) {
    const double elapsed_s = duration<double>(now - task_begin_).count();
    const bool known = fraction >= kMinFractionForTime && elapsed_s >= kMinSecondsForTime;
    const double left_s = known ? elapsed_s * (1.0 - fraction) / fraction : -1.0;
    if (style_ == Style::bar) {
        const int columns = terminal_columns() - 1;  // the last one would wrap
        write_stderr(fmt::format("\r{}\x1b[K", progress_bar(task_, fraction, left_s, columns)));
        drawn_ = true;
    } else {
        write_stderr(progress_text(task_, fraction, left_s) + "\n");
    }
}

void ConsoleProgress::clear() {
    const std::lock_guard lock(mutex_);
    if (drawn_) write_stderr("\r\x1b[K");
    drawn_ = false;
}

}  // namespace gnomon::cli
