#pragma once

// Device time of a section of a queue's work: CUDA's events, so that neither the latency of launches nor the wait
// counts; wall-clock time on the CPU.

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
    /// Seconds between start() and stop(), both called before. Waits for the work. Throws Error(DeviceFault).
    double seconds() const { return stop_->seconds_since(*start_); }

private:
    std::unique_ptr<TimeMark> start_, stop_;
};

/// Times of several runs, in seconds.
struct RunTimes {
    double median = 0, least = 0, greatest = 0;
    int runs = 0;
};

/// Summarizes at least one run; the median of an even number is the mean of the middle two.
inline RunTimes summarize_runs(std::vector<double> seconds) {
    PERTEV_CHECK(!seconds.empty());
    std::ranges::sort(seconds);
    const double median = 0.5 * (seconds[(seconds.size() - 1) / 2] + seconds[seconds.size() / 2]);
    return {median, seconds.front(), seconds.back(), static_cast<int>(seconds.size())};
}

// Number of runs that are queued before the first is waited for, so that the device is never idle when one begins;
// otherwise the latency of a launch on the host would count.
inline constexpr int kRunsAtOnce = 5;

/// Queues run() `warm_ups` times, then `runs` times, each timed separately. Calls `between()` after every few runs,
/// on a CPU after each, warm-ups included; it may throw to stop.
template <class Run, class Between>
RunTimes time_runs(Queue& queue, int warm_ups, int runs, const Run& run, const Between& between) {
    const int at_once = queue.is_cuda() ? kRunsAtOnce : 1; // on a CPU a run is over when it returns
    for (int i = 0; i < warm_ups; ++i) {
        run();
        if (!queue.is_cuda()) between();
    }
    std::vector<DeviceTimer> timers;
    for (int i = 0; i < at_once; ++i) timers.emplace_back(queue);
    std::vector<double> seconds;
    while (static_cast<int>(seconds.size()) < runs) {
        const auto now = std::min<std::size_t>(timers.size(), static_cast<std::size_t>(runs) - seconds.size());
        for (std::size_t i = 0; i < now; ++i) {
            timers[i].start();
            run();
            timers[i].stop();
        }
        for (std::size_t i = 0; i < now; ++i) seconds.push_back(timers[i].seconds());
        between();
    }
    return summarize_runs(std::move(seconds));
}

template <class Run>
RunTimes time_runs(Queue& queue, int warm_ups, int runs, const Run& run) {
    return time_runs(queue, warm_ups, runs, run, [] {});
}

} // namespace pertev
