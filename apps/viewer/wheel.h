#pragma once

// Who steers: one client at a time. The first that comes has the wheel. It may hand it over; when it goes away the
// wheel waits a while for it to come back, known by its key, and then goes to the client that has waited longest.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pertev {

class Wheel {
public:
    struct Seat {
        uint32_t client = 0;
        std::string key; // of the page, kept over reconnects
        bool asks = false;
    };
    static constexpr double kPatience = 10; // seconds that the wheel waits for whoever held it

    void join(uint32_t client, const std::string& key, double now_s);
    void leave(uint32_t client, double now_s);
    /// It asks for the wheel, and gets it where nobody holds it.
    void ask(uint32_t client);
    /// False, and nothing is done, unless `from` steers and `to` is there.
    bool hand(uint32_t from, uint32_t to);
    /// To be called now and then: the wheel does not wait for ever.
    void look(double now_s);

    bool steers(uint32_t client) const { return holder_ == client && client != 0; }
    uint32_t holder() const { return holder_; } // 0: nobody
    const std::vector<Seat>& seats() const { return seats_; }

private:
    void give(uint32_t client);

    std::vector<Seat> seats_; // in the order they came
    uint32_t holder_ = 0;
    std::string kept_for_; // the key of the holder that went away
    double gone_s_ = 0;
};

} // namespace pertev
