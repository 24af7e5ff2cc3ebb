#pragma once

// Prints the name of work that does not finish. A hanging kernel leaves no other trace, because the test is killed
// from outside.

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

namespace pertev::test {

/// Prints `name` on stderr, once, when it still exists after `seconds`.
class HangGuard {
public:
    HangGuard(std::string name, double seconds)
        : thread_([this, name = std::move(name), seconds](const std::stop_token& stop) {
              std::unique_lock lock(mutex_);
              const auto most = std::chrono::duration<double>(seconds);
              if (ended_.wait_for(lock, stop, most, [&] { return stop.stop_requested(); })) return;
              std::fprintf(stderr, "after %g s not at its end: %s\n", seconds, name.c_str());
          }) {}

private:
    std::mutex mutex_;
    std::condition_variable_any ended_;
    std::jthread thread_; // last, so that the thread ends before its members
};

} // namespace pertev::test
