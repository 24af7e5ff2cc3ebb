#include "base/heartbeat.h"

#include <system_error>
#include <utility>

namespace pertev {

Heartbeat::Heartbeat(std::chrono::milliseconds interval, std::function<void(double, const std::string&)> report)
    : interval_(interval), report_(std::move(report)) {
    try {
        thread_ = std::thread([this] { beat(); });
    } catch (const std::system_error&) { // no thread is left; the work matters more
    }
}

Heartbeat::~Heartbeat() {
    {
        const std::lock_guard lock(mutex_);
        is_over_ = true;
    }
    over_.notify_one();
    if (thread_.joinable()) thread_.join();
}

void Heartbeat::set_work(std::string work) {
    const std::lock_guard lock(mutex_);
    work_ = std::move(work);
}

void Heartbeat::beat() {
    const auto start = std::chrono::steady_clock::now();
    std::unique_lock lock(mutex_);
    for (auto next = start + interval_; !over_.wait_until(lock, next, [this] { return is_over_; }); next += interval_) {
        if (work_.empty()) continue;
        const std::string work = work_;
        lock.unlock(); // a slow reader of the log must not delay anything else
        report_(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), work);
        lock.lock();
    }
}

} // namespace pertev
