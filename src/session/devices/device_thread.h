#pragma once

// A thread that does one device's part of frame after frame, near the device.

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace pertev {

class DeviceThread {
public:
    /// Starts the thread, which calls `first` once.
    explicit DeviceThread(std::function<void()> first) : task_(std::move(first)), thread_([this] { work(); }) {}
    ~DeviceThread() {
        {
            const std::lock_guard lock(mutex_);
            ends_ = true;
            changed_.notify_all();
        }
        thread_.join();
    }
    DeviceThread(const DeviceThread&) = delete;
    DeviceThread& operator=(const DeviceThread&) = delete;

    /// Lets the thread call `task`, which throws nothing, once it has done the last one.
    void start(std::function<void()> task) {
        wait();
        const std::lock_guard lock(mutex_);
        task_ = std::move(task);
        changed_.notify_all();
    }
    /// Waits until the thread has done the last task.
    void wait() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return !task_; });
    }

private:
    void work() {
        std::unique_lock lock(mutex_);
        for (;;) {
            changed_.wait(lock, [&] { return ends_ || task_; });
            if (!task_) return;
            lock.unlock();
            task_();
            lock.lock();
            task_ = nullptr;
            changed_.notify_all();
        }
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::function<void()> task_;
    bool ends_ = false;
    std::thread thread_;
};

} // namespace pertev
