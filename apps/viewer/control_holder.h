#pragma once

// Decides who steers, one client at a time. The first client has control. It may hand it over. When it disconnects,
// control waits a while for it to return, recognised by its key, and then goes to the client that has waited
// longest.

#include <cstdint>
#include <string>
#include <vector>

namespace pertev {

class ControlHolder {
public:
    struct Seat {
        uint32_t client = 0;
        std::string key; // key of the page, kept over reconnects
        bool wants_control = false;
        std::string request; // recent attempt to steer while another client did; empty: none
        double requested_s = 0;
    };
    static constexpr double kRequestStays = 20; // seconds
    static constexpr double kHandingOver = 1;   // seconds in which the former holder may not have received the change
    static constexpr double kPatience = 10;     // seconds that control waits for a disconnected holder

    void join(uint32_t client, const std::string& key, double now_s);
    void leave(uint32_t client, double now_s);
    /// Requests control, which is granted if it is free.
    void request_control(uint32_t client);
    /// Returns false and does nothing unless `from` steers and `to` exists.
    bool hand(uint32_t from, uint32_t to, double now_s = 0);
    enum class Request : uint8_t { None, Known, New };
    /// Records the request of a client that does not steer. Returns None if it steered a moment ago and may not have
    /// received the change.
    Request request(uint32_t client, const std::string& what, double now_s);
    /// Must be called regularly, because control and requests expire. Returns whether anything has changed.
    bool tick(double now_s);

    bool steers(uint32_t client) const { return holder_ == client && client != 0; }
    uint32_t holder() const { return holder_; } // 0: no client
    const std::vector<Seat>& seats() const { return seats_; }

private:
    void give(uint32_t client);

    std::vector<Seat> seats_; // in the order of arrival
    uint32_t holder_ = 0;
    std::string kept_for_; // the key of the disconnected holder
    double gone_s_ = 0;
    uint32_t handed_by_ = 0; // the last one to hand it over
    double handed_s_ = 0;
};

} // namespace pertev
