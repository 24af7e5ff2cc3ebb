#pragma once

// What one client's link can take, by its acknowledgements: how many pictures may be under way (two at most, so that no
// queue grows), when the second of them may leave, how well they are packed and how large they are. Pure arithmetic
// over the times it is told. A far link is not a slow one: seconds a byte are told from the way itself by how times go
// with sizes (a running linear fit).

#include <cstdint>
#include <deque>

namespace pertev {

class LinkPace {
public:
    /// The most messages with pictures that are under way to one client.
    static constexpr std::size_t kMostInFlight = 2;

    /// Not before which time a picture may leave; infinity: not before one is acknowledged.
    double may_send_at_s() const;
    bool may_send(double now_s) const { return now_s >= may_send_at_s(); }
    bool is_idle() const { return under_way_.empty(); }

    /// `is_piece`: of a still picture, which takes as long as it takes.
    void sent(uint32_t frame, std::size_t bytes, double now_s, bool is_piece = false);
    /// The client has drawn this frame. `client_s`: what it says that it took to decode and draw it. False: no such
    /// frame is under way.
    bool acknowledged(uint32_t frame, double now_s, double client_s);

    /// Of JPEG, 30 to 92.
    int quality() const { return quality_; }
    /// Of the frame's size; 1, 1/2 or 1/4.
    float scale() const { return scale_; }
    /// Bytes a second, by what came through; 0 while nothing is known.
    double bytes_per_second() const { return rate_; }
    /// From sending to acknowledgement, seconds, of the last.
    double round_trip_s() const { return round_trip_s_; }
    /// Bytes that go through in `seconds`; for pieces of a large picture.
    std::size_t piece_bytes(double seconds) const;
    /// How long the second of two pictures is held back, seconds: a picture that waits at the client for the one before
    /// it would be old when it is drawn. Grows while pictures take longer than they did with an idle client, and is
    /// never more than the client needs for one.
    double hold_s() const { return hold_s_; }

private:
    struct Sent {
        uint32_t frame;
        std::size_t bytes;
        double at_s;
        bool is_piece;
    };
    void learn(double bytes, double seconds);
    void adapt(double bytes);
    void hold(double client_s);

    std::deque<Sent> under_way_;
    double round_trip_s_ = 0, last_ack_s_ = 0, rate_ = 0;
    // Running means of the fit: sizes, times, and their products.
    double bytes_ = 0, seconds_ = 0, bytes_squared_ = 0, bytes_seconds_ = 0;
    double way_ = 0.03; // seconds that a picture without bytes would take; a guess until sizes have differed
    int quality_ = 80;
    float scale_ = 1;
    int calm_ = 0; // acknowledgements in a row without delay
    // The least of late, which grow by the hundredth a picture until a lesser one comes.
    double least_round_trip_s_ = 0, least_client_s_ = 0;
    double hold_s_ = 0;
};

} // namespace pertev
