#pragma once

// Who steers: one client at a time. The first that comes has the wheel. It may hand it over; when it goes away the
// wheel waits a while for it to come back, known by its key, and then goes to the client that has waited longest.

#include <cstdint>
#include <string>
#include <vector>

namespace pertev {

class Wheel {
public:
    struct Seat {
        uint32_t client = 0;
        std::string key; // of the page, kept over reconnects
        bool asks = false;
        std::string wish; // what it tried to do while another client steered; empty: nothing of late
        double wished_s = 0;
    };
    static constexpr double kWishStays = 20;  // seconds
    static constexpr double kHandingOver = 1; // seconds within which the former holder may not know it yet
    static constexpr double kPatience = 10;   // seconds that the wheel waits for whoever held it

    void join(uint32_t client, const std::string& key, double now_s);
    void leave(uint32_t client, double now_s);
    /// It asks for the wheel, and gets it where nobody holds it.
    void ask(uint32_t client);
    /// False, and nothing is done, unless `from` steers and `to` is there.
    bool hand(uint32_t from, uint32_t to, double now_s = 0);
    enum class Wish : uint8_t { None, Known, New };
    /// A client that does not steer has tried to. None: it steered a moment ago, and may not know better.
    Wish wish(uint32_t client, const std::string& what, double now_s);
    /// To be called now and then: the wheel does not wait for ever, nor does a wish stay. Returns whether anything is
    /// other than before.
    bool look(double now_s);

    bool steers(uint32_t client) const { return holder_ == client && client != 0; }
    uint32_t holder() const { return holder_; } // 0: nobody
    const std::vector<Seat>& seats() const { return seats_; }

private:
    void give(uint32_t client);

    std::vector<Seat> seats_; // in the order they came
    uint32_t holder_ = 0;
    std::string kept_for_; // the key of the holder that went away
    double gone_s_ = 0;
    uint32_t handed_by_ = 0; // who handed it over last
    double handed_s_ = 0;
};

} // namespace pertev
