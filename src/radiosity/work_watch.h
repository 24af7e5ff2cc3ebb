#pragma once

// Long work that many threads do, watched by somebody who is told how far it is and may end it. Threads ask as often as
// they like: all but one look at the clock and go on.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

namespace pertev {

/// What is being done, and the share of it that is done, [0, 1]. Never called twice at a time, from any thread. False
/// ends the work.
using SolveProgress = std::function<bool(const char* what, double share)>;

class WorkWatch {
public:
    explicit WorkWatch(SolveProgress progress) : progress_(std::move(progress)) {}
    WorkWatch(const WorkWatch&) = delete;
    WorkWatch& operator=(const WorkWatch&) = delete;

    /// `pieces` of `what` are to be done from now on, between `first` and `last` of the whole. Tells at once. No other
    /// thread is at work then.
    void begin(std::string what, uint64_t pieces, double first = 0, double last = 1);
    /// Follows what is done, from the next begin() on. No other thread is at work then.
    void set_note(std::string note) { note_ = std::move(note); }
    void done(uint64_t pieces = 1) { done_.fetch_add(pieces, std::memory_order_relaxed); }
    void set_share(double share) { share_.store(share, std::memory_order_relaxed); }

    /// Whether the work is to end: once true it stays so. Tells where the last telling is kInterval ago.
    bool is_over();

    static constexpr std::chrono::milliseconds kInterval{50};

private:
    using Clock = std::chrono::steady_clock;
    void tell();

    SolveProgress progress_;
    std::string what_, note_;
    uint64_t pieces_ = 0;
    double first_ = 0, last_ = 1;
    std::atomic<uint64_t> done_ = 0;
    std::atomic<double> share_ = 0; // where no pieces are counted
    std::atomic<Clock::rep> next_ = 0;
    std::atomic<bool> is_over_ = false;
    std::mutex telling_;
};

} // namespace pertev
