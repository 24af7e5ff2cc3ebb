#pragma once

// The devices that make frames together, as RowExchange shows them to each other: bands of rows, which follow the
// devices' speeds, a barrier of their threads, and copies of rows from one device to another.

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "device/queue.h"
#include "render/row_exchange.h"

namespace pertev {

/// Thrown on the other devices' threads when one of them fails in the middle of a frame.
struct FrameAbandoned {};

class RowTeam {
public:
    /// Makes a team; the queues outlive it. Opens the paths on which rows are copied.
    explicit RowTeam(std::span<Queue* const> queues);
    RowTeam(const RowTeam&) = delete;
    RowTeam& operator=(const RowTeam&) = delete;
    ~RowTeam();

    /// Begins a frame; no thread is in one.
    void begin();
    /// Lets all threads that are in the frame throw FrameAbandoned at their next call.
    void abandon();
    /// Ends a frame whose part took each device some seconds, its waiting not counted. Bands of the next one are those
    /// with which all would have taken as long.
    void end(std::span<const double> seconds);

    RowExchange& member(std::size_t number);
    /// Rows of a device in the present or last frame.
    RowBand rows_of(std::size_t number, uint32_t height) const { return rows_between(bounds_, number, height); }
    /// Seconds that a device has waited for the others in the frame.
    double waited(std::size_t number) const;
    /// Starts to copy the rows that device `owner` has made to device `to`, from arrays like those there.
    void copy(std::size_t to, const std::vector<RowArray>& into, std::size_t owner, const std::vector<RowArray>& from);

private:
    class Member;
    using Bounds = std::vector<uint32_t>; // where bands begin and end, in parts of a picture's height

    static RowBand rows_between(const Bounds& bounds, std::size_t number, uint32_t height);
    bool wait_at_barrier(bool here);

    std::vector<std::unique_ptr<Member>> members_;
    Bounds bounds_, bounds_before_; // bands of this frame and the last one
    std::vector<double> shares_;    // the devices' shares of the next frame's rows
    bool has_cpu_ = false;

    std::mutex mutex_;
    std::condition_variable changed_;
    std::size_t arrived_ = 0;
    uint64_t barriers_ = 0;
    bool any_ = false, result_ = false, is_abandoned_ = false;
};

} // namespace pertev
