#pragma once

// The sink of a call from Python. The call's work runs without the interpreter's lock and ends by Ctrl-C, and its
// messages go to Python's `logging` once the call has the lock again.

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "base/sink.h"

namespace pertev {

class PythonSink final : public Messages {
public:
    /// Returns whether a signal's handler has raised an exception, which is then the calling thread's. Only that
    /// thread asks the interpreter, at most every 20 ms, and only if it is the main one, which alone gets signals.
    bool should_stop() override;
    /// Returns whether a handler has raised an exception, which is to be thrown on.
    bool has_raised() const { return has_raised_; }

private:
    using Clock = std::chrono::steady_clock;

    const std::thread::id caller_ = std::this_thread::get_id();
    const bool is_main_ = ::gettid() == ::getpid();
    Clock::time_point asked_ = Clock::now();
    std::atomic<bool> has_raised_ = false;
};

/// Logs all messages to the logger `pertev`: warnings at its level WARNING, notices at INFO. Needs the interpreter's
/// lock.
void log_messages(const Messages& messages);

/// Returns a text of the library with the names of settings as Python's keyword arguments.
std::string python_text(const std::string& marked);

} // namespace pertev
