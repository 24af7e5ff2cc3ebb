#pragma once

// Reports at a regular interval that work continues, and which, for logs that cannot show a progress bar. It has its
// own thread, so that steps of several minutes are reported too.

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace pertev {

class Heartbeat {
public:
    /// `report` gets the seconds since this object was made and the name of the current work. It is called from another
    /// thread, never concurrently, and not after the destructor has returned. If no thread can be created, it is
    /// never called.
    Heartbeat(std::chrono::milliseconds interval, std::function<void(double seconds, const std::string& work)> report);
    ~Heartbeat();
    Heartbeat(const Heartbeat&) = delete;
    Heartbeat& operator=(const Heartbeat&) = delete;

    /// Names the current work. Nothing is reported before the first call.
    void set_work(std::string work);

private:
    void beat();

    std::chrono::milliseconds interval_;
    std::function<void(double, const std::string&)> report_;
    std::mutex mutex_; // guards the two members below
    std::string work_;
    bool is_over_ = false;
    std::condition_variable over_;
    std::thread thread_;
};

} // namespace pertev
