#pragma once

// Seconds that a stretch of a queue's work takes on the device: CUDA's events, so that neither the launch's way there
// nor the wait for its end counts; the clock on the wall on the CPU.

#include <algorithm>
#include <memory>
#include <vector>

#include "base/error.h"
#include "device/queue.h"

namespace pertev {

class DeviceTimer {
public:
    explicit DeviceTimer(Queue& queue) : start_(queue.make_time_mark()), stop_(queue.make_time_mark()) {}

    void start() { start_->record(); }
    void stop() { stop_->record(); }
    /// Between start() and stop(), both called before. Waits for the work. Throws Error(DeviceFault).
    double seconds() const { return stop_->seconds_since(*start_); }

private:
    std::unique_ptr<TimeMark> start_, stop_;
};

/// Of several runs, seconds.
struct RunTimes {
    double median = 0, least = 0, greatest = 0;
    int runs = 0;
};

/// Of at least one run; of an even number the greater of the two in the middle, which is one that was seen.
inline RunTimes summarize_runs(std::vector<double> seconds) {
    PERTEV_CHECK(!seconds.empty());
    std::ranges::sort(seconds);
    return {seconds[seconds.size() / 2], seconds.front(), seconds.back(), static_cast<int>(seconds.size())};
}

/// Gives run() to the queue `warm_ups` times, then `runs` times, each timed on its own.
template <class Run>
RunTimes time_runs(Queue& queue, int warm_ups, int runs, const Run& run) {
    for (int i = 0; i < warm_ups; ++i) run();
    DeviceTimer timer(queue);
    std::vector<double> seconds;
    for (int i = 0; i < runs; ++i) {
        timer.start();
        run();
        timer.stop();
        seconds.push_back(timer.seconds());
    }
    return summarize_runs(std::move(seconds));
}

} // namespace pertev
