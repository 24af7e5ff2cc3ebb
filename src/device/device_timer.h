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

/// Of at least one run; the median of an even number is the mean of the two in the middle.
inline RunTimes summarize_runs(std::vector<double> seconds) {
    PERTEV_CHECK(!seconds.empty());
    std::ranges::sort(seconds);
    const double median = 0.5 * (seconds[(seconds.size() - 1) / 2] + seconds[seconds.size() / 2]);
    return {median, seconds.front(), seconds.back(), static_cast<int>(seconds.size())};
}

// Runs that are given to the queue before the first is waited for, so that the device is never idle when one begins:
// else what the host does on the way to a launch would count.
inline constexpr int kRunsAtOnce = 5;

/// Gives run() to the queue `warm_ups` times, then `runs` times, each timed on its own. `between()` is asked after
/// every few runs, on a CPU after each, warm-ups included: it may throw to end them.
template <class Run, class Between>
RunTimes time_runs(Queue& queue, int warm_ups, int runs, const Run& run, const Between& between) {
    const int at_once = queue.is_cuda() ? kRunsAtOnce : 1; // a CPU's run is over when it returns
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
