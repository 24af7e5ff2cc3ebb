#pragma once

// Says at an even interval that work goes on, and which: for logs, where no progress bar can be drawn. A thread of its
// own does, so a step that takes minutes is told of too.

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace pertev {

class Heartbeat {
public:
    /// `say` gets the seconds since this object was made and the work that was last named. It is called from another
    /// thread, never twice at a time, and not once the destructor has returned. Where no thread can be had, never.
    Heartbeat(std::chrono::milliseconds interval, std::function<void(double seconds, const std::string& work)> say);
    ~Heartbeat();
    Heartbeat(const Heartbeat&) = delete;
    Heartbeat& operator=(const Heartbeat&) = delete;

    /// Names the work from now on. Nothing is said before the first.
    void set_work(std::string work);

private:
    void beat();

    std::chrono::milliseconds interval_;
    std::function<void(double, const std::string&)> say_;
    std::mutex mutex_; // of the two below
    std::string work_;
    bool is_over_ = false;
    std::condition_variable over_;
    std::thread thread_;
};

} // namespace pertev
