#pragma once

// Estimates the capacity of a client's link from its acknowledgements: how many pictures may be in flight (at most
// two, so that no queue grows), when the second of them may leave, their quality and their size. It computes only
// with the given times. Latency is distinguished from bandwidth by how times depend on sizes (a running linear fit).

#include <cstdint>
#include <deque>

namespace pertev {

class LinkPace {
public:
    /// Maximum number of messages with pictures in flight to one client.
    static constexpr std::size_t kMaxInFlight = 2;

    /// Earliest time for the next picture; infinity: only after an acknowledgement.
    double may_send_at_s() const;
    bool may_send(double now_s) const { return now_s >= may_send_at_s(); }
    bool is_idle() const { return in_flight_.empty(); }

    /// Records that a frame was sent. `is_piece` means a piece of a still picture, whose time is not limited.
    void sent(uint32_t frame, std::size_t bytes, double now_s, bool is_piece = false);
    /// Records that the client has drawn a frame. `client_s` is the time that it reports for decoding and drawing.
    /// Returns false if this frame is not in flight.
    bool acknowledged(uint32_t frame, double now_s, double client_s);

    /// JPEG quality, 30 to 92.
    int quality() const { return quality_; }
    /// Scale relative to the frame's size: 1, 1/2 or 1/4.
    float scale() const { return scale_; }
    /// Measured bandwidth in bytes per second; 0 while unknown.
    double bytes_per_second() const { return rate_; }
    /// Seconds from sending to acknowledgement, for the last picture.
    double round_trip_s() const { return round_trip_s_; }
    /// Bytes that can be sent in `seconds`; for pieces of a large picture.
    std::size_t piece_bytes(double seconds) const;

private:
    struct Sent {
        uint32_t frame;
        std::size_t bytes;
        double at_s;
        bool is_piece;
    };
    void estimate_rate(double bytes, double seconds);
    void adapt(double bytes);
    void hold(double client_s);

    std::deque<Sent> in_flight_;
    double round_trip_s_ = 0, last_ack_s_ = 0, rate_ = 0;
    // Running means of the fit: sizes, times, and their products.
    double bytes_ = 0, seconds_ = 0, bytes_squared_ = 0, bytes_seconds_ = 0;
    double latency_s_ = 0.03; // seconds for a picture of zero bytes; a guess until sizes have varied
    int quality_ = 80;
    float scale_ = 1;
    int calm_ = 0; // consecutive acknowledgements without delay
    // Recent minima, which grow by a hundredth per picture until a smaller value comes.
    double min_round_trip_s_ = 0, min_client_s_ = 0;
    /// Seconds by which the second of two pictures is held back, because a picture that waits at the client for the
    /// previous one would be outdated when drawn. It grows while pictures take longer than with an idle client, and
    /// never exceeds the client's time per picture.
    double hold_s_ = 0;
};

} // namespace pertev
