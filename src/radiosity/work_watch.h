#pragma once

// Long work by many threads that reports to a sink. Threads may check as often as they like whether it goes on: all but
// one return at once.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

#include "base/sink.h"

namespace pertev {

class WorkWatch {
public:
    /// `sink` must outlive this object.
    explicit WorkWatch(Sink& sink) : sink_(sink), began_(Clock::now()), step_began_(began_) {}
    WorkWatch(const WorkWatch&) = delete;
    WorkWatch& operator=(const WorkWatch&) = delete;

    /// Starts a phase: `pieces` of `what` are to be done, between the fractions `first` and `last` of the whole.
    /// Reports at once. No other thread may be working.
    void begin(std::string what, uint64_t pieces, double first = 0, double last = 1);
    /// Text appended to the name of the work from the next begin() on. No other thread may be working.
    void set_note(std::string note) { note_ = std::move(note); }
    void done(uint64_t pieces = 1) { done_.fetch_add(pieces, std::memory_order_relaxed); }
    void set_share(double share) { share_.store(share, std::memory_order_relaxed); }

    /// Returns whether the work must end; once true it stays true. Reports if the last report is kInterval ago.
    bool is_over();

    static constexpr std::chrono::milliseconds kInterval{50};

private:
    using Clock = std::chrono::steady_clock;
    void report();

    Sink& sink_;
    Clock::time_point began_, step_began_;
    double step_first_ = 0; // share at which the step began
    std::string what_, note_;
    uint64_t pieces_ = 0;
    double first_ = 0, last_ = 1;
    std::atomic<uint64_t> done_ = 0;
    std::atomic<double> share_ = 0; // progress if no pieces are counted
    std::atomic<Clock::rep> next_ = 0;
    std::atomic<bool> is_over_ = false;
    std::mutex telling_;
};

} // namespace pertev
