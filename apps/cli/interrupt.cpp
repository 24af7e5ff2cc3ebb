#include "apps/cli/interrupt.h"

#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <string>
#include <string_view>

#include "apps/cli/report_error.h"
#include "base/error.h"

namespace pertev {
namespace {

volatile std::sig_atomic_t g_interrupted = 0;

// Made before the signal, whose handler may do little but write() and _exit().
std::string g_last_line;
int g_last_line_goes_to = STDERR_FILENO;
bool g_has_reader = false; // whether standard error is a terminal

/// A second signal of either kind ends the process.
void ignore_second() {
    std::signal(SIGTERM, SIG_DFL);
    std::signal(SIGINT, SIG_DFL);
}

extern "C" void handle_interrupt(int) {
    g_interrupted = 1;
    ignore_second();
    constexpr std::string_view hint = "\nends after the current step; Ctrl-C again ends at once\n";
    if (!g_has_reader) return;
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, hint.data(), hint.size());
}

extern "C" void end_process(int) {
    ignore_second(); // whoever should read the line may not
    [[maybe_unused]] const ssize_t written = ::write(g_last_line_goes_to, g_last_line.data(), g_last_line.size());
    ::_exit(exit_status(ErrorCode::Interrupted));
}

} // namespace

void end_at_interrupt(bool json) {
    const std::string text = "interrupted before the first result";
    g_last_line = json ? error_object(ErrorCode::Interrupted, text) + '\n' : "pertev: " + text + '\n';
    g_last_line_goes_to = json ? STDOUT_FILENO : STDERR_FILENO;
    std::signal(SIGTERM, end_process);
    std::signal(SIGINT, end_process); // last, so that both are handled once SIGINT is
}

void listen_for_interrupt() {
    g_has_reader = g_last_line_goes_to == STDERR_FILENO && ::isatty(STDERR_FILENO) == 1;
    std::signal(SIGTERM, handle_interrupt);
    std::signal(SIGINT, handle_interrupt);
}

bool interrupted() { return g_interrupted != 0; }

void throw_if_interrupted() {
    if (interrupted()) throw Error(ErrorCode::Interrupted, "interrupted");
}

} // namespace pertev
