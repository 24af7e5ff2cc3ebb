#pragma once

// Work of a call without the interpreter's lock, so that other threads of Python continue. The caller has the lock,
// before and after.

#include <chrono>
#include <exception>
#include <mutex>
#include <optional>
#include <utility>

#include <nanobind/nanobind.h>
#include <unistd.h>

#include "python/python_sink.h"

namespace pertev {

/// Calls `take`, which gets the interpreter's lock. An interpreter that is ending unwinds any thread but its own that
/// asks for the lock, and what calls here must not be unwound, so such a thread waits for the end of the process.
template <class Take>
auto take_lock(const Take& take) {
    try {
        return take();
    } catch (...) {
        while (true) ::pause();
    }
}

/// Releases the interpreter's lock while it lives.
class Unlocked {
public:
    Unlocked() : state_(PyEval_SaveThread()) {}
    ~Unlocked() {
        take_lock([&] { PyEval_RestoreThread(state_); });
    }
    Unlocked(const Unlocked&) = delete;
    Unlocked& operator=(const Unlocked&) = delete;

private:
    PyThreadState* state_;
};

/// Calls `work` without the interpreter's lock, and then logs its messages. Throws what it throws, or what a signal's
/// handler raised.
template <class Work>
void run_unlocked(Work work) {
    PythonSink sink;
    std::exception_ptr failure;
    {
        const Unlocked unlocked;
        try {
            work(sink);
        } catch (...) {
            failure = std::current_exception();
        }
    }
    if (sink.has_raised()) throw nanobind::python_error();
    try {
        log_messages(sink.messages());
    } catch (nanobind::python_error& raised) { // a handler of the caller's; the picture or the failure counts
        raised.discard_as_unraisable("pertev");
    }
    if (failure) std::rethrow_exception(failure);
}

template <class Work>
auto result_of(Work work) {
    std::optional<decltype(work(std::declval<PythonSink&>()))> made;
    run_unlocked([&](PythonSink& sink) { made.emplace(work(sink)); });
    return std::move(*made);
}

/// Returns the lock of a turn. Throws Error(Interrupted) if the sink stops. Call it without the interpreter's lock,
/// which the thread whose turn it is may need.
inline std::unique_lock<std::timed_mutex> wait_for(std::timed_mutex& turn, Sink& sink) {
    std::unique_lock lock(turn, std::defer_lock);
    while (!lock.try_lock_for(std::chrono::milliseconds(20))) sink.check();
    return lock;
}

} // namespace pertev
